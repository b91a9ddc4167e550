"""check_bag --clouds: recorded point clouds as obstacles of the demo robot."""
import math
import struct

import pytest
import rosbag
import rospy
from bags import copied, in_order, stamped_transform
from sensor_msgs.msg import Image, PointCloud2, PointField
from tf2_msgs.msg import TFMessage

TOPIC, CAMERA = "/camera/points", (1.0, -0.5, 1.5)  # in world, where it looks along world's axes
START = 1000.0
FAR = (0.4, -0.9, 1.6)  # from all links, in world
FAR_SEEN = [tuple(f - c for f, c in zip(FAR, CAMERA))]
UTM_X = 5e6  # of world's origin, in the frame utm
TIMEOUT = 1.0  # the default of source_timeout


def cloud_of(points, seconds, frame="camera"):
    cloud = PointCloud2(height=1, width=len(points), point_step=12, row_step=12 * len(points))
    cloud.header.stamp, cloud.header.frame_id = rospy.Time.from_sec(seconds), frame
    cloud.fields = [PointField("xyz"[i], 4 * i, PointField.FLOAT32, 1) for i in range(3)]
    cloud.data = b"".join(struct.pack("<3f", *point) for point in points)
    return cloud


def block(center, origin=CAMERA):
    """Points of a block of 8 cm about a point of the world, as the camera sees them."""
    steps = [0.01 * i for i in range(-4, 5)]
    return [tuple(c + s - o for c, s, o in zip(center, (x, y, z), origin)) for x in steps for y in steps for z in steps]


def palm_at(bag, seconds):
    """Where TF has a point of the palm in the world, one rotation after the other."""
    placed = {}
    for _, message, stamp in bag.read_messages(["/tf", "/tf_static"]):
        for t in message.transforms:
            if t.header.stamp.to_sec() <= seconds + 1e-6:
                placed[t.child_frame_id] = (t.header.frame_id, t.transform)
    point, frame = (0.0, 0.0, 0.03), "palm"
    while frame in placed:
        frame, transform = placed[frame]
        x, y, z, w = (getattr(transform.rotation, c) for c in "xyzw")
        u = (x, y, z)
        cross = lambda a, b: (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
        once = cross(u, point)
        twice = cross(u, once)
        point = tuple(p + 2 * w * a + 2 * b + getattr(transform.translation, c)
                      for p, a, b, c in zip(point, once, twice, "xyz"))
    return point


@pytest.fixture
def with_clouds(make_bag, tmp_path):
    """The demo's bag with a camera fixed in the world, and messages of a topic at their own stamps."""
    def make(clouds, topic=TOPIC, *options):
        camera = stamped_transform("world", "camera", START, CAMERA)
        utm = stamped_transform("world", "utm", START, (-UTM_X, 0.0, 0.0))

        def change(messages):
            recorded = rospy.Time()
            for cloud in clouds:  # at its stamp, and one after the other
                recorded = max(recorded + rospy.Duration(0, 1000), cloud.header.stamp)
                messages.append((topic, cloud, recorded))
            return [("/tf_static", TFMessage([camera, utm]), camera.header.stamp)] + in_order(messages)
        return copied(tmp_path / "clouds.bag", change, make_bag("source.bag", *options))
    return make


@pytest.fixture
def check(check_bag):
    def run(bag, *arguments, topics=("camera/points",)):
        return check_bag(bag, *arguments, "--clouds", *topics)
    return run


def every(period, end, points):
    return [cloud_of(points, START + period * i) for i in range(int(end / period))]


def seconds_of(row):
    return float(row["stamp"]) - START


def cloud_pairs(row):
    return {pair for pair in row["pairs"].split(";") if "camera/points" in pair.split("|")}


@pytest.fixture
def write(tmp_path):
    def settings(cloud):
        path = tmp_path / "settings.yaml"
        path.write_text("clouds: [%s]" % cloud)
        return path
    return settings


def test_what_is_far_changes_no_verdict_and_no_pair(check, check_bag, with_clouds):
    bag = with_clouds(every(0.2, 30, FAR_SEEN))
    rows, _ = check(bag)
    without, _ = check_bag(bag)
    assert {row["verdict"] for row in without} == {"free", "collision"}
    assert [(r["stamp"], r["verdict"], r["pairs"], r["left_out"]) for r in rows][1:] == \
        [(r["stamp"], r["verdict"], r["pairs"], r["left_out"]) for r in without][1:]
    assert rows[0]["left_out"] == "camera/points", "the first cloud comes right after the first transforms"


def test_a_cloud_of_the_settings_that_is_not_chosen_is_warned_of(check, check_bag, with_clouds, write):
    bag, settings = with_clouds(every(0.2, 30, FAR_SEEN)), write("{topic: camera/points}, {topic: lidar/points}")
    warned = "ignored, so a state may be free only without them: cloud "
    assert warned + "'lidar/points'\n" in check(bag, "--settings", settings)[1]
    assert warned + "'camera/points', cloud 'lidar/points'\n" in check_bag(bag, "--settings", settings)[1]
    said = check(bag, "--settings", write("{topic: lidar/points}"))[1]
    assert "warning: %s: no entry of clouds has topic 'camera/points': using the defaults\n" % settings in said
    assert "using the defaults" not in check(bag)[1]


def test_a_block_that_a_link_comes_into_is_a_collision_with_the_cloud_and_the_link_named(check, make_bag, with_clouds, write):
    with rosbag.Bag(str(make_bag("demo.bag"))) as bag:
        there = palm_at(bag, START + 2.0)
        assert math.dist(there, palm_at(bag, START + 0.2)) > 0.2
    # The camera sees the block before the arm is there, so it is not the robot's; then it remembers.
    settings = "{topic: /camera/points, decay: 60, source_timeout: 60}"
    rows, _ = check(with_clouds([cloud_of(block(there), START + 0.2)]), "--settings", write(settings))
    at_2 = next(row for row in rows if seconds_of(row) >= 2.0)
    assert at_2["verdict"] == "collision" and "camera/points|palm" in cloud_pairs(at_2)
    early = [row for row in rows if 0.2 <= seconds_of(row) < 0.3]
    assert early and not any(cloud_pairs(row) for row in early)


def test_points_that_are_doubles_far_from_their_frame_are_not_moved(check, make_bag, with_clouds, write):
    """As in UTM: as float32 they would be moved by up to 0.25 m."""
    with rosbag.Bag(str(make_bag("demo.bag"))) as bag:
        points = block(palm_at(bag, START + 2.0), (0.0, 0.0, 0.0))
    settings = write("{topic: camera/points, max_range: 1.0e+7, decay: 60, source_timeout: 60}")
    far, near = cloud_of([], START + 0.2, "utm"), cloud_of(points, START + 0.2, "world")
    far.fields = [PointField("xyz"[i], 8 * i, PointField.FLOAT64, 1) for i in range(3)]
    far.point_step, far.width, far.row_step = 24, len(points), 24 * len(points)
    far.data = b"".join(struct.pack("<3d", UTM_X + x, y, z) for x, y, z in points)
    rows, expected = ([(row["verdict"], row["pairs"]) for row in check(with_clouds([cloud]), "--settings", settings)[0]]
                      for cloud in (far, near))
    assert rows == expected and any("camera/points|palm" in pairs for _, pairs in rows)


def test_what_vanished_against_a_link_is_not_free_until_it_is_seen_to_go(check, check_bag, with_clouds):
    heights = [1.0, 0.92, 0.85, 0.78, 0.74] + 20 * [0.71] + [0.75, 0.82, 0.9, 0.98, 1.05] + 40 * [1.05]  # the table's top is 0.7
    clouds = [cloud_of([tuple(p - c for p, c in zip((0.75, -0.38, z), CAMERA))], START + 0.1 * i)
              for i, z in enumerate(heights)]
    bag = with_clouds(clouds)
    rows, _ = check(bag)
    free = {row["stamp"] for row in check_bag(bag)[0] if row["verdict"] == "free"}
    held = [row for row in rows if 1.1 < seconds_of(row) < 2.5]  # what was seen before has decayed
    assert held and all("camera/points" in row["left_out"] and row["verdict"] != "free" for row in held)
    after = [row for row in rows if 4.0 < seconds_of(row) < 6.5]
    assert after and [row for row in after if row["stamp"] in free] == [row for row in after if row["verdict"] == "free"]


def test_before_the_first_cloud_and_after_the_timeout_nothing_is_free(check, with_clouds):
    rows, _ = check(with_clouds([cloud_of(FAR_SEEN, START + 1.0), cloud_of(FAR_SEEN, START + 1.5)]))
    for row in rows:
        seconds = seconds_of(row)
        fresh = 1.0 + 1e-6 < seconds <= 1.5 + TIMEOUT + 1e-6
        assert ("camera/points" in row["left_out"].split(";")) == (not fresh), row
        if not fresh:
            assert row["verdict"] != "free"
    assert any(row["verdict"] == "free" for row in rows) and any(row["verdict"] == "unknown" for row in rows)


def test_of_two_cameras_on_one_topic_nothing_is_free_until_one_is_silent(check, with_clouds):
    clouds = [cloud_of(FAR_SEEN, START + 0.1 * i, ("camera", "/beside")[i % 2]) for i in range(60)]
    last = 3.5  # of the second: from then on every message is of the first, or of none
    left = [cloud for i, cloud in enumerate(clouds) if i % 2 == 0 or 0.1 * i < last]
    rows, said = check(with_clouds(left))
    assert "each camera needs a topic of its own" in said, said
    assert not any(row["verdict"] == "free" and 0.2 < seconds_of(row) < last for row in rows)
    assert any(row["verdict"] == "free" and seconds_of(row) < 0.1 for row in rows)


def test_points_of_no_return_do_not_show_that_what_touches_is_gone(check, make_bag, with_clouds, write):
    """Beside the palm is a camera, and an obstacle that it sees no more; drivers write nothing seen as NaN, or as (0, 0, 0)."""
    with rosbag.Bag(str(make_bag("demo.bag"))) as bag:
        palm = palm_at(bag, START)
    seen = tuple(p - c + d for p, c, d in zip(palm, CAMERA, (0.0, 0.0, 0.0)))
    def run(nothing):
        clouds = [cloud_of([seen] if i < 3 else [nothing] + FAR_SEEN, START + 0.1 * i) for i in range(30)]
        settings = write("{topic: camera/points, self_filter_padding: 0, decay: 0.3}")
        return [(row["verdict"], row["pairs"], row["left_out"]) for row in check(with_clouds(clouds), "--settings", settings)[0]]
    assert run((0.0, 0.0, 0.0)) == run(3 * (float("nan"),))


def test_the_robots_own_points_are_no_obstacles(check, make_bag, with_clouds, write):
    with rosbag.Bag(str(make_bag("demo.bag"))) as bag:
        stamps = [START + 0.2 * i for i in range(20)]
        palms = [palm_at(bag, stamp) for stamp in stamps]
    own = [cloud_of([tuple(p - o for p, o in zip(palm, CAMERA))], stamp) for palm, stamp in zip(palms, stamps)]
    settings = "{topic: camera/points, replace: true}"
    rows, _ = check(with_clouds(own), "--settings", write(settings))
    assert not any(cloud_pairs(row) for row in rows)
    assert any(row["verdict"] == "free" for row in rows)
    # Without the filter's pose of that instant they would be: a second late, the same points are.
    late = [cloud_of([tuple(p - o for p, o in zip(palm, CAMERA))], stamp + 1.0) for palm, stamp in zip(palms, stamps)]
    rows, _ = check(with_clouds(late), "--settings", write("{topic: camera/points, decay: 60}"))
    assert any(cloud_pairs(row) for row in rows)


@pytest.mark.parametrize("options", [(), ("--without", "tf")], ids=["by TF", "by forward kinematics"])
def test_a_camera_on_a_link_is_placed_where_that_link_was(check, with_clouds, write, options):
    """A wall of points below the table, in the frame of the table: it stands 0.7 m above the world's origin."""
    box = [(0.02 * x, 0.02 * y, 0.35) for x in range(-5, 6) for y in range(-5, 6)]
    clouds = [cloud_of([(x, y, z + 0.1) for x, y, z in box], START + 0.2 * i, "table") for i in range(30)]
    # Where they are in the world, z = 1.15, is inside this box, and nowhere else.
    for low, expected in ((1.1, True), (1.3, False)):
        crop = "{topic: camera/points, self_filter_padding: 0, box: [-1, -1, %s, 1, 1, %s]}" % (low, low + 0.1)
        rows, said = check(with_clouds(clouds, TOPIC, *options), "--settings", write(crop))
        assert "refused" not in said
        assert any(cloud_pairs(row) for row in rows) == expected


@pytest.mark.parametrize("spoil, says", [
    (lambda c: setattr(c, "data", c.data[:-1]), "too few"),
    (lambda c: setattr(c, "row_step", 4), "row_step"),
    (lambda c: setattr(c, "fields", c.fields[:2]), "no field 'z'"),
    (lambda c: setattr(c.header, "frame_id", "nowhere"), "'nowhere'"),
    (lambda c: setattr(c.header, "stamp", rospy.Time()), "stamp is zero"),
    (lambda c: setattr(c.header, "stamp", rospy.Time.from_sec(START + 0.5)), "not later"),
    (lambda c: setattr(c, "height", 0), "its height 0"),
    (lambda c: setattr(c, "width", 0), "its width is 0"),
    (lambda c: setattr(c, "data", struct.pack("<3f", 0, 0, 1500)), "within max_range (5 m), and min_valid_points is 1"),
    (lambda c: setattr(c, "data", bytes(12)), "nothing returned"),
    (lambda c: setattr(c, "data", b"\xff" * 12), "nothing returned: it has no point that is finite and further than 1 mm from the sensor, and min_valid_points is 1"),
])
def test_a_cloud_that_cannot_be_used_is_said_and_nothing_is_free_until_the_next(check, with_clouds, spoil, says):
    clouds = every(0.5, 3, FAR_SEEN)
    bad = clouds[2]  # at 1.0
    spoil(bad)
    rows, said = check(with_clouds(clouds))
    assert "1 of 6" in said, said
    suspect = [row for row in rows if 1.01 < seconds_of(row) < 1.49]
    assert suspect and all(row["verdict"] != "free" and "camera/points" in row["left_out"] for row in suspect)
    assert any(says in row["unknown_because"] for row in suspect)
    assert any(row["verdict"] == "free" for row in rows if 1.5 <= seconds_of(row) < 3)


def test_clouds_that_show_nothing_are_free_with_a_warning_where_they_are_allowed(check, with_clouds, write):
    clouds = every(0.5, 3, FAR_SEEN)
    clouds[2] = cloud_of([], START + 1.0)
    settings = write("{topic: camera/points, min_valid_points: 0}")
    rows, said = check(with_clouds(clouds), "--settings", settings)
    assert "1 of 6 messages show nothing; the first: nothing returned" in said, said
    assert any(row["verdict"] == "free" for row in rows if 1.01 < seconds_of(row) < 1.49)


@pytest.mark.parametrize("ahead, is_used", [(0.4, True), (0.6, False)])
def test_a_cloud_from_the_future_is_refused_beyond_half_a_second(check, with_clouds, tmp_path, ahead, is_used):
    def change(messages):
        for topic, message, recorded in messages:
            if topic == TOPIC:
                message.header.stamp = recorded + rospy.Duration.from_sec(ahead)
            yield topic, message, recorded
    rows, said = check(copied(tmp_path / "ahead.bag", change, with_clouds([cloud_of(FAR_SEEN, START + 1.0)])))
    assert ("0.60 s ahead of the clock" in said) != is_used, said
    assert any(row["verdict"] == "free" for row in rows) == is_used


def test_a_cloud_counts_once_it_was_recorded(check, with_clouds, tmp_path):
    found = []
    for late in (0.0, 0.5):
        second = [("/lidar/points", cloud, cloud.header.stamp + rospy.Duration.from_sec(late)) for cloud in every(0.4, 4, FAR_SEEN)]
        bag = copied(tmp_path / "two.bag", lambda messages, second=second: in_order(messages + second),
                     with_clouds(every(0.2, 4, FAR_SEEN)))
        found.append(check(bag, topics=("camera/points", "lidar/points"))[0])
    on_time, late = ([(row["stamp"], row["verdict"]) for row in rows] for rows in found)
    arrived = sum(float(stamp) < START + 0.5 for stamp, _ in late)
    assert ("free" in {v for _, v in on_time[:arrived]}) and {v for _, v in late[:arrived]} == {"unknown"}
    assert "free" in {v for _, v in late[arrived:]} and late[arrived:] == on_time[arrived:]


def test_a_cloud_whose_lengths_lie_is_refused_and_ends_nothing(check, with_clouds):
    bag = with_clouds([cloud_of(block(FAR), START + 0.5)], TOPIC, "--compression", "none")
    content = bytearray(bag.read_bytes())
    place = content.index(b"camera", content.index(struct.pack("<I", 12 * 729) * 2)  - 200) + len(b"camera") + 8
    for lie in (b"\xff\xff\xff\xff", b"\xff\xff\xff\x07"):
        content[place:place + 4] = lie  # how many fields there are
        bag.write_bytes(content)
        rows, said = check(bag)
        assert "it is truncated" in said, said
        assert all(row["verdict"] != "free" for row in rows)


@pytest.mark.parametrize("topics, says", [
    (["lidar/points"], "the bag has no messages on topic 'lidar/points'; topics with clouds: /camera/points"),
    (["camera/points", "/lidar/points"], "the bag has no messages on topic '/lidar/points'; topics with clouds: /camera/points"),
    (["/image"], "topic '/image' is not of type sensor_msgs/PointCloud2"),
    (["camera/points", "image"], "topic 'image' is not of type sensor_msgs/PointCloud2"),
    (["camera/points", "/camera/points"], "topic '/camera/points' is listed twice"), (["/"], "'/' is not a valid topic name"),
    (["camera/points", ""], "'' is not a valid topic name")])
def test_a_topic_that_is_no_cloud_of_the_bag_is_one_line_and_exit_code_2(run_tool, with_clouds, tmp_path, topics, says):
    bag = with_clouds(every(1.0, 2, FAR_SEEN))
    with rosbag.Bag(str(bag), "a") as target:
        target.write("/image", Image(), rospy.Time.from_sec(START + 1))
    done = run_tool("check_bag", bag, "--out", tmp_path / "out.csv", "--clouds", *topics)
    errors = [line for line in done.stderr.splitlines() if not line.startswith("warning: ")]
    of_bag = "%s: " % bag if says.startswith(("the bag", "topic")) and "twice" not in says else ""
    assert done.returncode == 2 and errors in (["error: %s--clouds: %s" % (of_bag, says)], ["error: %s: --clouds: %s" % (bag, says)])
    assert not (tmp_path / "out.csv").exists()


def test_of_a_bag_without_any_cloud_that_is_said(run_tool, make_bag):
    done = run_tool("check_bag", make_bag("none.bag"), "--clouds", "camera/points")
    assert done.returncode == 2 and done.stderr.splitlines()[-1].endswith(
        "--clouds: the bag has no messages on topic 'camera/points'; topics with clouds: none")


def with_clouds_later(path, seconds, source):
    """The same but for when the clouds were recorded."""
    return copied(path, lambda messages: [(topic, message, recorded + rospy.Duration.from_sec(seconds if topic == TOPIC else 0))
                                          for topic, message, recorded in messages], source)


def test_clouds_that_were_recorded_too_late_are_refused(check, with_clouds, tmp_path):
    on_time = with_clouds(every(0.2, 9, FAR_SEEN))
    late = with_clouds_later(tmp_path / "late.bag", 1.5, on_time)
    assert "free" in {row["verdict"] for row in check(on_time)[0]}
    rows, _ = check(late)
    assert {row["verdict"] for row in rows} == {"unknown", "collision"}
    assert any("1.50 s old when it arrived" in row["unknown_because"] for row in rows)


def test_a_cloud_of_a_camera_whose_clock_is_ahead_ages_from_its_arrival_on(check, with_clouds, tmp_path):
    at_stamp = with_clouds([cloud_of(FAR_SEEN, START + 0.9)])
    ahead = with_clouds_later(tmp_path / "ahead.bag", -0.4, at_stamp)
    for bag in (at_stamp, ahead):
        rows, _ = check(bag)
        inside = [row for row in rows if START + 1.55 < float(row["stamp"]) < START + 1.85]
        assert inside
        assert all(("source_timeout" in row["unknown_because"]) == (bag == ahead) or row["verdict"] == "collision"
                   for row in inside), inside
