"""check_bag with the scenes that a node has published: what was there, what was gripped, and what is missing."""
import random
import re

import pytest
import rosbag
import rospy
from collision_pairs.msg import RobotDescription, Scene, SceneObject
from bags import copied, in_order
from conftest import DEMO_BAG, DEMO_ROBOT, records_of, rows_of
from geometry_msgs.msg import Pose
from seed import given_seed
from sensor_msgs.msg import PointCloud2
from shape_msgs.msg import SolidPrimitive

TOPIC = "/collision_pairs_node/scene"
START = 1000.0
BALL = 0.05  # m, radius


def text_of(path):
    with open(path) as file:
        return file.read()


def ball(name, link="", x=0.0, touch=()):
    made = SceneObject(name=name, attached_link=link, touch_links=list(touch))
    made.header.frame_id = link or "world"
    made.primitives = [SolidPrimitive(type=SolidPrimitive.SPHERE, dimensions=[BALL])]
    made.pose = Pose()
    made.pose.position.x, made.pose.orientation.w = x, 1.0
    return made


def scene_at(seconds, revision, objects=(), settings="{}", since=None):
    scene = Scene(revision=revision, settings=settings, objects=list(objects))
    scene.header.frame_id, scene.header.stamp = "world", rospy.Time.from_sec(START + (seconds if since is None else since))
    scene.robots = [RobotDescription(urdf=text_of(DEMO_ROBOT[1]), srdf=text_of(DEMO_ROBOT[3]))]
    return seconds, scene


def of_topics(messages, *topics):
    return [message for message in messages if message[0] in topics]


@pytest.fixture
def bag_with(tmp_path):
    """The demo's bag without its descriptions, and scenes."""
    def make(*scenes, topics=(TOPIC,)):
        first = [(topic, scene, rospy.Time.from_sec(START + seconds)) for topic in topics for seconds, scene in scenes]
        return copied(tmp_path / "scenes.bag", lambda messages: first + of_topics(messages, "/tf", "/tf_static", "/joint_states"))
    return make


def seconds_of(row):
    return float(row["stamp"]) - START


def names_in(row):
    return {name for pair in row["distances"].split(";") if pair for name in pair.rsplit("=", 1)[0].split("|")}


def test_a_scene_without_objects_is_what_the_robots_description_gives(check_bag, bag_with):
    rows, _ = check_bag(bag_with(scene_at(0, 1)))
    expected, _ = check_bag(DEMO_BAG)
    shown = ("state", "stamp", "pairs", "verdict", "distances", "unknown_because")
    assert [[row[key] for key in shown] for row in rows] == [[row[key] for key in shown] for row in expected]


def test_what_is_added_attached_and_removed_is_checked_from_then_on(check_bag, bag_with):
    free = "{pair_rules: [{allow: [ball, world]}]}"
    rows, _ = check_bag(bag_with(scene_at(0, 1), scene_at(2, 2, [ball("held", "palm", 0.06, ["wrist"])], free),
                                 scene_at(4, 3, [ball("there", x=5.0)]), scene_at(6, 4)), "--alarm-distance", "9")
    for row in rows:
        seconds = seconds_of(row)
        if min(abs(seconds - t) for t in (2, 4, 6)) < 0.05:
            continue
        names = names_in(row)
        assert ("held" in names) == (2 < seconds < 4), row
        assert ("there" in names) == (4 < seconds < 6), row


def test_where_scenes_are_missing_nothing_is_free_and_it_is_said(check_bag, bag_with):
    rows, _ = check_bag(bag_with(scene_at(0, 1), scene_at(3, 4), scene_at(5, 5), scene_at(7, 1)))
    for row in rows:
        if seconds_of(row) < 2.95:
            assert row["verdict"] != "free"
            assert "2 scenes after revision 1 on %s are not in the bag" % TOPIC in row["unknown_because"] or row["pairs"]
    assert any(row["verdict"] == "free" for row in rows if 3.05 < seconds_of(row) < 4.95)
    assert any(row["verdict"] == "free" for row in rows if seconds_of(row) > 5.05), "a node that was started anew"


@pytest.mark.parametrize("last", [5, 4])
def test_a_node_that_was_started_anew_counts_from_1_and_what_is_missing_of_it_is_said(check_bag, bag_with, last):
    rows, _ = check_bag(bag_with(scene_at(0, last), scene_at(3, 4)))
    for row in rows:
        if seconds_of(row) < 2.95:
            assert row["verdict"] != "free"
            assert "3 scenes before revision 4 on %s are not in the bag" % TOPIC in row["unknown_because"] or row["pairs"]
    assert any(row["verdict"] == "free" for row in rows if seconds_of(row) > 3.05)


@pytest.mark.parametrize("since, is_known", [(-100, True), (2, False)])
def test_before_the_first_scene_arrived_it_counts_if_it_was_checked_already(check_bag, bag_with, since, is_known):
    rows, _ = check_bag(bag_with(scene_at(2, 7, since=since)))
    before = [row for row in rows if seconds_of(row) < 1.95 and not row["pairs"]]
    assert before and {row["verdict"] for row in before} == {"free" if is_known else "unknown"}
    if not is_known:
        assert all("the first scene on %s is of a later time" % TOPIC in row["unknown_because"] for row in before)


def test_where_a_node_has_lost_its_objects_nothing_is_free_until_they_are_cleared(check_bag, bag_with):
    lost, cleared = scene_at(2, 1, since=-100), scene_at(5, 2)
    lost[1].objects_are_lost = True
    rows, _ = check_bag(bag_with(lost, cleared))
    for row in rows:
        if seconds_of(row) < 4.95:  # also before it arrived: it was checked already
            assert row["verdict"] != "free"
            assert "are lost: send CLEAR" in row["unknown_because"] or row["pairs"]
    assert any(row["verdict"] == "free" for row in rows if seconds_of(row) > 5.05)


def test_scenes_of_another_version_are_refused(run_tool, tmp_path):
    bag, (_, scene) = tmp_path / "other.bag", scene_at(0, 1)
    header = {"topic": TOPIC, "type": scene._type, "md5sum": 32 * "0", "message_definition": scene._full_text}
    with rosbag.Bag(DEMO_BAG) as source, rosbag.Bag(str(bag), "w") as target:
        target.write(TOPIC, scene, rospy.Time.from_sec(START), connection_header=header)
        for topic, message, stamp in source.read_messages():
            target.write(topic, message, stamp)
    done = run_tool("check_bag", bag)
    assert done.returncode == 2 and "the scenes on topic '%s' are of another version" % TOPIC in done.stderr, done.stderr


def test_of_several_topics_one_is_to_be_chosen(run_tool, check_bag, bag_with):
    bag = bag_with(scene_at(0, 1), topics=("/left/scene", "/right/scene"))
    done = run_tool("check_bag", bag)
    assert done.returncode == 2 and "several scenes in it (/left/scene, /right/scene); choose one with --scene" in done.stderr
    assert check_bag(bag, "--scene", "/right/scene")[0]
    done = run_tool("check_bag", bag, "--scene", "/none")
    assert done.returncode == 2 and "no scenes on topic '/none'; topics with scenes: /left/scene, /right/scene" in done.stderr


def test_with_a_robot_that_is_given_the_scenes_are_not_checked_and_that_is_said(check_bag, bag_with):
    bag = bag_with(scene_at(0, 1, [ball("there")]))
    rows, said = check_bag(bag, *DEMO_ROBOT)
    assert "the scenes on %s are not checked, since a robot or settings are given" % TOPIC in said
    assert not any("there" in names_in(row) for row in rows)


def test_a_cloud_of_the_scene_that_was_not_recorded_leaves_nothing_free(check_bag, bag_with):
    seconds, scene = scene_at(0, 1, settings="{clouds: [{topic: eye}]}")
    scene.cloud_topics = ["/eye"]
    rows, said = check_bag(bag_with((seconds, scene)))
    assert "it has no clouds on /eye, so nothing is free" in said
    assert {row["verdict"] for row in rows} == {"unknown", "collision"}
    assert "none has arrived yet on /eye" in rows[0]["unknown_because"]


def test_clouds_are_chosen_among_those_of_the_scene(run_tool, check_bag, bag_with):
    seconds, scene = scene_at(0, 1, settings="{clouds: [{topic: eye}, {topic: ear}]}")
    scene.cloud_topics = ["/eye", "/ear"]
    bag = bag_with((seconds, scene))
    with rosbag.Bag(str(bag), "a") as more:
        for topic in ("/ear", "/nose"):
            more.write(topic, PointCloud2(), rospy.Time.from_sec(START))
    assert "ignored, so a state may be free only without them: cloud 'eye'" in check_bag(bag, "--clouds", "ear")[1]
    done = run_tool("check_bag", bag, "--clouds", "nose")
    assert done.returncode == 2 and "topic 'nose' is no cloud of the recorded scene; its are: /eye, /ear" in done.stderr


@pytest.mark.parametrize("spoil, says", [
    (lambda s: s.robots.clear(), "it has no robot"),
    (lambda s: setattr(s.robots[0], "urdf", "<robot"), "robots[0]/urdf"),
    (lambda s: setattr(s, "settings", "{padings: 1}"), "did you mean 'padding'?"),
    (lambda s: s.objects.append(ball("b", "nowhere")), "nowhere"),
])
def test_a_scene_that_cannot_be_built_is_refused(run_tool, bag_with, spoil, says):
    seconds, scene = scene_at(3, 2)
    spoil(scene)
    done = run_tool("check_bag", bag_with(scene_at(0, 1), (seconds, scene)))
    assert done.returncode == 2 and says in done.stderr, done.stderr


def raw(seconds, data):
    return seconds, (Scene._type, data, Scene._md5sum, Scene)


def test_after_a_scene_that_cannot_be_read_nothing_is_free_until_the_next(check_bag, run_tool, tmp_path):
    path = tmp_path / "garbled.bag"
    for good in (True, False):
        with rosbag.Bag(DEMO_BAG) as source, rosbag.Bag(str(path), "w") as target:
            for seconds, scene in (scene_at(0, 1), scene_at(6, 3)) if good else ():
                target.write(TOPIC, scene, rospy.Time.from_sec(START + seconds))
            target.write(TOPIC, raw(3, b"\xff" * 200)[1], rospy.Time.from_sec(START + 3), raw=True)
            for topic, message, stamp in source.read_messages(["/tf", "/tf_static"]):
                target.write(topic, message, stamp)
        if good:
            rows, _ = check_bag(path)
            for row in rows:
                suspect = 3.05 < seconds_of(row) < 5.95
                assert not (suspect and row["verdict"] == "free")
                if suspect and not row["pairs"]:
                    assert "the last scene on %s cannot be read" % TOPIC in row["unknown_because"]
            assert any(row["verdict"] == "free" for row in rows if seconds_of(row) > 6.05)
        else:
            done = run_tool("check_bag", path)
            assert done.returncode == 2 and "none of the scenes on %s can be read" % TOPIC in done.stderr


def test_after_a_part_of_the_bag_that_is_lost_nothing_is_free_until_the_next_scene(check_bag, tmp_path):
    scenes = [(TOPIC, scene, rospy.Time.from_sec(START + seconds)) for seconds, scene in (scene_at(0, 1), scene_at(7, 2))]
    path = copied(tmp_path / "hole.bag", lambda messages: in_order(of_topics(messages, "/tf", "/tf_static") + scenes),
                  compression="bz2", chunk_threshold=20000)
    content = bytearray(path.read_bytes())
    places = [i for i in range(len(content)) if content[i:i + 4] == b"BZh9"]
    middle = places[len(places) // 2]
    content[middle + 30:middle + 60] = bytes(30)
    path.write_bytes(content)
    rows, said = check_bag(path, "--max-gap", "5")
    assert "the end of the chunk" in said
    lost = max(rows[i + 1:i + 2] and seconds_of(rows[i + 1]) - seconds_of(rows[i]) or 0.0 for i in range(len(rows) - 1))
    assert lost > 0.2, "of the chunk"
    after = next(seconds_of(rows[i + 1]) for i in range(len(rows) - 1) if seconds_of(rows[i + 1]) - seconds_of(rows[i]) > 0.2)
    assert after < 6.5
    for row in rows:
        if after < seconds_of(row) < 6.95:
            assert row["verdict"] != "free", row
    assert any(row["verdict"] == "free" for row in rows if seconds_of(row) < after)
    assert any(row["verdict"] == "free" for row in rows if seconds_of(row) > 7.05)


def headers(content, begin):
    """Of each record, also of those in chunks: the header, and where it begins."""
    for header, data in records_of(content):
        yield begin, header
        if b"op=\x05" in header:
            yield from headers(data, begin + len(header))
        begin += len(header) + len(data)


def test_where_a_bit_of_a_record_header_is_wrong_no_scene_is_left_out_in_silence(run_tool, tmp_path):
    damaged, table = tmp_path / "damaged.bag", tmp_path / "table.csv"
    scenes = scene_at(0.005, 1), scene_at(0.01, 2, [ball("held", "palm")])  # the wrist touches it
    scenes = [(TOPIC, scene, rospy.Time.from_sec(START + seconds)) for seconds, scene in scenes]
    content = copied(tmp_path / "sound.bag", lambda messages: in_order(messages + scenes), chunk_threshold=20000).read_bytes()
    magic = len("#ROSBAG V2.0\n")
    all_headers = list(headers(content[magic:], magic))
    number = next(re.search(b"conn=....", header, re.DOTALL)[0] for _, header in all_headers if TOPIC.encode() in header)
    places = [byte for begin, header in all_headers if number in header for byte in range(begin, begin + len(header))]
    assert len(places) > 200
    generator = random.Random(given_seed())
    verdicts = []
    for byte in [None] + generator.sample(places, 40):
        wrong = bytearray(content)
        if byte is not None:
            wrong[byte] ^= 1 << generator.randrange(8)
        damaged.write_bytes(wrong)
        result = run_tool("check_bag", damaged, "--verdict-only", "--out", table)
        rows = rows_of(table) if result.returncode == 0 else []
        free = [row for row in rows if row["verdict"] == "free" and seconds_of(row) > 0.02]
        assert not free, (byte, result.stderr)
        verdicts.append({row["verdict"] for row in rows})
    assert "collision" in verdicts[0], "nothing is wrong with the first"
    assert {"unknown"} in verdicts or set() in verdicts or any("unknown" in each for each in verdicts)


def test_a_robot_that_changes_while_joint_states_place_it_is_refused(run_tool, tmp_path):
    seconds, other = scene_at(3, 2)
    other.robots[0].urdf = other.robots[0].urdf.replace("<robot ", "<robot version='1.0' ")
    scenes = [(TOPIC, scene, rospy.Time.from_sec(START + at)) for at, scene in (scene_at(0, 1), (seconds, other))]
    path = copied(tmp_path / "other.bag", lambda messages: scenes + of_topics(messages, "/joint_states"))
    done = run_tool("check_bag", path)
    assert done.returncode == 2 and "a robot changes in revision 2, but joint states place it" in done.stderr
