"""check_bag as a user meets it: verdicts, several robots, the summary, errors."""
import re
import xml.etree.ElementTree as ET

import pytest
import rosbag
import rospy
from bags import copied, stamped_transform
from conftest import DEMO, DEMO_BAG, DEMO_ROBOT, rows_of, sliding_boxes, without_name
from sensor_msgs.msg import JointState
from tf2_msgs.msg import TFMessage

HEADER = ["bag", "state", "stamp", "in_collision", "pairs", "min_distance", "nb_pairs", "distances", "left_out",
          "verdict", "unknown_because"]


class OldMessage(TFMessage):
    """tf's message before tf2: the same on the wire."""
    _type = "tf/tfMessage"


def verdicts(rows):
    return [(row["stamp"], row["pairs"]) for row in rows]


def test_a_row_a_stamp_with_the_robot_that_the_bag_names(check_bag):
    rows, summary = check_bag(DEMO_BAG)
    assert list(rows[0]) == HEADER
    with rosbag.Bag(DEMO_BAG) as bag:
        stamps = [message.header.stamp for _, message, _ in bag.read_messages("/joint_states")]
    assert [row["stamp"] for row in rows] == ["%d.%09d" % (s.secs, s.nsecs) for s in stamps]
    assert [row["state"] for row in rows] == [str(i) for i in range(len(stamps))]
    assert {row["in_collision"] for row in rows} == {"0", "1"}
    assert not any(row["left_out"] for row in rows)
    assert "in contact" in summary and "closest" in summary and "no gap" in summary


@pytest.mark.parametrize("source", ["joints", "tf"])
def test_transforms_and_joint_states_give_what_check_states_gives(run_tool, check_bag, make_bag, tmp_path, source):
    bag = make_bag("one.bag", "--without", "tf" if source == "joints" else "joints")
    with rosbag.Bag(DEMO_BAG) as recorded:
        messages = [message for _, message, _ in recorded.read_messages("/joint_states")]
    states = tmp_path / "states.csv"
    states.write_text("\n".join([",".join(messages[0].name)] +
                                [",".join(map(repr, m.position)) for m in messages]) + "\n")
    out = tmp_path / "states_out.csv"
    done = run_tool("check_states", DEMO_ROBOT[1], *DEMO_ROBOT[2:], "--states", states, "--out", out, "--min-distance",
                    "--alarm-distance", "0.05")
    assert done.returncode == 0, done.stderr
    rows, _ = check_bag(bag, "--min-distance")
    expected = rows_of(out)
    assert len(rows) == len(expected)
    for found, truth in zip(rows, expected):
        assert found["pairs"] == truth["pairs"]
        assert abs(float(found["min_distance"]) - float(truth["min_distance"])) < 1e-9


def test_distances_name_every_pair_in_reach_and_agree_with_the_verdict(check_bag):
    rows, _ = check_bag(DEMO_BAG, "--alarm-distance", "0.2")
    for row in rows:
        distances = dict(pair.rsplit("=", 1) for pair in filter(None, row["distances"].split(";")))
        contacts = set(filter(None, row["pairs"].split(";")))
        assert contacts == {pair for pair, distance in distances.items() if float(distance) <= 0}
        assert row["in_collision"] == ("1" if contacts else "0")
        assert row["verdict"] == ("collision" if contacts else "free")
        assert min(map(float, distances.values())) == float(row["min_distance"])
        assert int(row["nb_pairs"]) >= len(distances)


def test_old_tf_messages_and_leading_slashes_are_read(check_bag, tmp_path, make_bag):
    def as_before_tf2(messages):
        fixed = []  # they were sent again and again
        for topic, message, stamp in messages:
            for transform in message.transforms if topic in ("/tf", "/tf_static") else ():
                transform.header.frame_id = "/" + transform.header.frame_id
                transform.child_frame_id = "/" + transform.child_frame_id
            if topic == "/tf_static":
                fixed += message.transforms
            elif topic == "/tf":
                for transform in fixed:
                    transform.header.stamp = stamp
                yield "/tf", OldMessage(message.transforms + fixed), stamp
    rows, _ = check_bag(copied(tmp_path / "old.bag", as_before_tf2), *DEMO_ROBOT)
    assert verdicts(rows) == verdicts(check_bag(DEMO_BAG)[0])


def test_of_several_robots_the_prefix_chooses_one(run_tool, check_bag, make_bag, tmp_path):
    left, right = make_bag("left.bag", "--prefix", "left"), make_bag("right.bag", "--prefix", "right",
                                                                     "--seconds-per-posture", "0.3")
    both = tmp_path / "both.bag"
    with rosbag.Bag(str(both), "w") as target:
        for bag in (left, right):
            with rosbag.Bag(str(bag)) as source:
                for topic, message, stamp in source.read_messages():
                    if "description" not in topic:
                        target.write(topic, message, stamp)
    for name, alone in (("left", left), ("right", right)):
        rows, expected = (without_name(check_bag(bag, "--prefix", name, *DEMO_ROBOT)[0]) for bag in (both, alone))
        assert rows[:len(expected)] == expected
        assert {row["verdict"] for row in rows[len(expected):]} <= {"free", "unknown"}, "the other one goes on"
    done = run_tool("check_bag", both, *DEMO_ROBOT)
    assert done.returncode == 2 and "--prefix left or right" in done.stderr


def test_each_of_several_bags_is_checked_with_its_own_robot(check_bag, tmp_path):
    def with_thin_links(messages):
        for topic, message, stamp in messages:
            if topic.endswith("robot_description"):
                message.data = re.sub(r'size="[^"]*"', 'size="0.001 0.001 0.001"', message.data)
                message.data = re.sub(r'(radius|length)="[^"]*"', r'\1="0.001"', message.data)
            yield topic, message, stamp
    changed = copied(tmp_path / "changed.bag", with_thin_links)
    demo, thin = verdicts(check_bag(DEMO_BAG)[0]), verdicts(check_bag(changed)[0])
    assert demo != thin
    assert verdicts(check_bag(DEMO_BAG, changed)[0]) == demo + thin


def test_joints_of_a_namespace_are_found_by_prefix(check_bag, make_bag):
    rows, _ = check_bag(make_bag("p.bag", "--prefix", "left", "--without", "tf"), "--prefix", "left")
    assert verdicts(rows) == verdicts(check_bag(DEMO_BAG)[0])


def test_over_a_gap_nothing_is_assumed_and_it_is_said(check_bag, make_bag, tmp_path):
    further_out = [stamped_transform("wrist", "wrist_ball", 1003.02 + 0.04 * i) for i in range(50)]  # it goes on moving
    bag = copied(tmp_path / "gap.bag", lambda messages: [
        m for m in messages if not (m[0] == "/tf" and 1003.0 < m[2].to_sec() < 1005.0)] + [
            ("/tf", TFMessage([transform]), transform.header.stamp) for transform in further_out])
    rows, summary = check_bag(bag)
    inside = [row for row in rows if 1003.01 < float(row["stamp"]) < 1004.99]
    assert inside and all("forearm" in row["left_out"].split(";") for row in inside)
    assert {row["verdict"] for row in inside} <= {"unknown", "collision"}
    unknown = [row for row in rows if row["verdict"] == "unknown"]
    assert unknown and all(row["in_collision"] == "1" and row["left_out"] for row in unknown)
    assert "%d stamps" % len(unknown) in re.search("unknown .*", summary).group(0)
    rows, said = check_bag(bag, "--max-gap", "3")
    assert not any("forearm" in row["left_out"].split(";") for row in rows)
    assert "unknown" not in {row["verdict"] for row in rows}


def test_with_a_joint_that_the_bag_does_not_name_nothing_is_free(check_bag, tmp_path):
    def without_a_joint(messages):
        for topic, message, stamp in messages:
            if topic == "/joint_states":
                message.name, message.position = message.name[1:], message.position[1:]
            if topic not in ("/tf", "/tf_static"):
                yield topic, message, stamp
    recorded = tmp_path / "recorded.bag"
    rows, said = check_bag(copied(tmp_path / "part.bag", without_a_joint), "--record", recorded)
    assert "taken as zero" in said
    assert {row["verdict"] for row in rows} == {"unknown", "collision"}
    assert {row["in_collision"] for row in rows} == {"1"}
    with rosbag.Bag(str(recorded)) as bag:
        reports = [message for _, message, _ in bag.read_messages("/collision_pairs_node/collision_pairs")]
        assert all(message.data for _, message, _ in bag.read_messages("/collision_pairs_node/in_collision"))
    unknown = [report for report in reports if report.verdict == 2]
    assert unknown and all("taken as zero" in " ".join(report.unknown_because) for report in unknown)


def test_verdict_only_gives_the_verdicts_and_at_most_one_pair(check_bag):
    whole, quick = check_bag(DEMO_BAG)[0], check_bag(DEMO_BAG, "--verdict-only")[0]
    assert [row["verdict"] for row in quick] == [row["verdict"] for row in whole]
    for one, all_pairs in zip(quick, whole):
        assert "" not in one["pairs"].split(";")[1:]
        assert set(one["pairs"].split(";")) <= set(all_pairs["pairs"].split(";")) and ";" not in one["pairs"]
        assert not (one["pairs"] and one["min_distance"]), "a distance that was not measured"


def test_a_clock_that_goes_back_within_a_bag_is_said(check_bag, tmp_path):
    bag = copied(tmp_path / "twice.bag", lambda messages: messages + [
        (topic, message, stamp + rospy.Duration(100)) for topic, message, stamp in messages])
    rows, said = check_bag(bag)
    assert "1 times its clock goes back" in said
    assert "clock" not in check_bag(DEMO_BAG)[1]


def test_the_summary_tells_when_each_pair_was_closest(check_bag):
    rows, summary = check_bag(DEMO_BAG, "--alarm-distance", "0.2")
    closest = {}
    for row in rows:
        seconds = float(row["stamp"]) - float(rows[0]["stamp"])
        for pair in filter(None, row["distances"].split(";")):
            name, distance = pair.rsplit("=", 1)
            closest[name] = min(closest.get(name, (9.0, 0.0)), (float(distance), seconds))
    listed = re.findall(r"^ +([-+][0-9.]+) m at \+([0-9.]+) s  ([^ \n]+)", summary, re.MULTILINE)
    assert len(listed) == min(20, len(closest)) and len({seconds for _, seconds, _ in listed}) > 2
    for distance, seconds, name in listed:
        assert float(distance) == pytest.approx(closest[name][0], abs=1e-4)
        assert float(seconds) == pytest.approx(closest[name][1], abs=1e-3)


@pytest.mark.parametrize("count, rest", [(10, None), (11, None), (20, None), (23, "and 3 more")])
def test_of_links_without_a_pose_twenty_are_listed_and_the_rest_is_counted(check_bag, tmp_path, count, rest):
    urdf, bag = tmp_path / "many.urdf", tmp_path / "few.bag"
    ball = "<link name='%s'><collision><geometry><sphere radius='0.01'/></geometry></collision></link>"
    tie = "<joint name='to_%s' type='floating'><parent link='root'/><child link='%s'/></joint>"
    links = ["l%02d" % i for i in range(count)] + ["seen", "known"]
    urdf.write_text("<robot name='many'><link name='root'/>%s</robot>" %
                    "".join(ball % link + tie % (link, link) for link in links))
    with rosbag.Bag(str(bag), "w") as target:
        for second in (1, 2):
            transforms = [stamped_transform("root", link, second, (float(link == "known"), 0.0, 0.0)) for link in links[count:]]
            target.write("/tf", TFMessage(transforms), rospy.Time(second))
    rows, summary = check_bag(bag, "--urdf", urdf, "--max-gap", "5")
    assert len(re.findall(r"^    l\d+  at 2 stamps$", summary, re.MULTILINE)) == min(20, count)
    more = " and %d more" % (count - 10) if count > 10 else ""
    reasons = ["no usable pose: " + ", ".join(links[:min(10, count)]) + more]
    reasons += ["link '%s': TF has no frame of that name" % link for link in links[:count]]
    assert rows[0]["unknown_because"].split("; ") == reasons[:10] + ["and more"]
    assert re.search(r"^    (and .*)$", summary, re.MULTILINE) is None if rest is None else rest in summary


def test_of_joint_states_without_a_stamp_nothing_is_used_as_by_robot_state_publisher(check_bag, tmp_path):
    def unstamped(messages):
        for topic, message, stamp in messages:
            if topic == "/joint_states":
                message.header.stamp = rospy.Time()
            if topic not in ("/tf", "/tf_static"):
                yield topic, message, stamp + rospy.Duration(0, 7)
    rows, summary = check_bag(copied(tmp_path / "unstamped.bag", unstamped))
    assert rows and {row["verdict"] for row in rows} == {"unknown"}
    assert "wrist" in rows[0]["left_out"]


def test_transforms_that_are_no_rotations_are_counted_and_said(check_bag, tmp_path):
    bent = stamped_transform("world", "bent", 1001)
    bent.transform.rotation.w = 2.0
    bag = copied(tmp_path / "bent.bag", lambda messages: messages + [("/tf", TFMessage([bent, bent]), bent.header.stamp)])
    assert "2 transforms and joint positions that are not finite, not a rotation, or not one for each name" in check_bag(bag)[1]


def test_time_in_contact_is_counted_from_stamp_to_stamp(check_bag, tmp_path):
    bag = tmp_path / "boxes.bag"
    urdf = tmp_path / "boxes.urdf"
    urdf.write_text(sliding_boxes())
    #            s:  0    1    2     3      4    7
    seen = [(0, 3), (1, 0.9), (2, 0.9), (3, 1.02), (4, 3), (7, 0.5), (8, 0.25)]
    with rosbag.Bag(str(bag), "w") as target:
        for seconds, x in seen:
            message = JointState(name=["slide_a", "slide_b"], position=[0, x])
            message.header.stamp = rospy.Time(100 + seconds)
            target.write("/joint_states", message, message.header.stamp)
    rows, summary = check_bag(bag, "--urdf", urdf)
    assert [row["pairs"] for row in rows] == ["", "a|b", "a|b", "", "", "a|b", "a|b"]
    assert "in contact        3.000 s, 4 stamps" in summary
    assert "near only         1.000 s" in summary
    assert "-0.7500 m at +8.000 s  a|b" in summary
    assert "3.000 s after +4.000 s" in summary


@pytest.mark.parametrize("arguments, says", [
    (["none.bag"], "none.bag"), ([DEMO], "demo"), ([DEMO_ROBOT[1]], "demo_robot.urdf"), ([], "bags"),
    ([DEMO_BAG, "--urdf", "none.urdf"], "none.urdf"), ([DEMO_BAG, "--srdf", "none.srdf"], "none.srdf"),
    ([DEMO_BAG, "--fidelity", "exact"], "exact"), ([DEMO_BAG, "--alarm-distance", "-1"], "alarm"),
    ([DEMO_BAG, "--alarm-distance", "nan"], "alarm"), ([DEMO_BAG, "--max-gap", "0"], "max-gap"),
    ([DEMO_BAG, "--alarm-distance", "inf"], "error: --alarm-distance must be a finite number of metres, 0 or more"),
    ([DEMO_BAG, "--tolerance", "-0.1"], "error: --tolerance must be a finite number of metres, 0 or more"),
    ([DEMO_BAG, "--tolerance", "inf"], "error: --tolerance must be a finite number of metres, 0 or more"),
    ([DEMO_BAG, "--max-gap", "inf"], "error: --max-gap must be a finite number, above 0"),
    ([DEMO_BAG, "--max-gap", "long"], "error: --max-gap must be a finite number, above 0"),
    *(([DEMO_BAG, "--shard", shard], "error: --shard %s: must be I/N with I from 1 to N, such as 2/4" % shard)
      for shard in ("0/2", "3/2", "1", "-1/2", "1/-2", "1/2x", "x/2")), ([DEMO_BAG, "--shard", "1/2", "--record", "x.bag"], "--record"),
    ([DEMO_BAG, "--prefix", "left"], "robot"), ([DEMO_BAG, "--speed", "3"], "--speed"),
    ([DEMO_BAG, "--record", "/none/x.bag"], "/none/x.bag"), ([DEMO_BAG, "--report", "/dev/null/x"], "/dev/null/x"),
])
def test_wrong_input_is_one_line_exit_code_2_and_no_file(run_tool, tmp_path, arguments, says):
    done = run_tool("check_bag", *arguments, "--out", tmp_path / "out.csv")
    errors = [line for line in done.stderr.splitlines() if not line.startswith("warning: ")]
    assert done.returncode == 2 and len(errors) == 1 and says in errors[0], done.stderr
    assert not list(tmp_path.iterdir())


def test_a_scene_in_which_nothing_moves_is_refused_for_that_reason(run_tool, tmp_path):
    settings = tmp_path / "settings.yaml"
    settings.write_text("links: [%s]\n" % ET.parse(DEMO_ROBOT[1]).find("link").get("name"))
    done = run_tool("check_bag", DEMO_BAG, "--settings", settings, "--out", tmp_path / "out.csv")
    assert done.returncode == 2 and not (tmp_path / "out.csv").exists()
    assert "there is nothing to check: no link of robot 'demo_robot' that moves is in a pair" in done.stderr


def test_a_bag_without_a_robot_asks_for_one(run_tool, make_bag):
    done = run_tool("check_bag", make_bag("r.bag", "--without", "robot"))
    assert done.returncode == 2 and "--urdf" in done.stderr


def test_without_out_the_table_is_on_standard_output_and_nothing_else(run_tool):
    done = run_tool("check_bag", DEMO_BAG)
    lines = done.stdout.splitlines()
    assert lines[0].split(",") == HEADER and all(line.startswith(DEMO_BAG) for line in lines[1:])
    assert "closest" in done.stderr


def test_reports_and_markers_are_recorded_at_the_stamps_of_the_table(check_bag, tmp_path):
    recorded = tmp_path / "recorded.bag"
    rows, _ = check_bag(DEMO_BAG, "--record", recorded)
    with rosbag.Bag(str(recorded)) as bag:
        reports = [message for _, message, _ in bag.read_messages("/collision_pairs_node/collision_pairs")]
        markers = [message for _, message, _ in bag.read_messages("/collision_pairs_node/markers")]
    assert len(reports) == len(markers) == len(rows)
    for row, report, array in zip(rows, reports, markers):
        assert row["stamp"] == "%d.%09d" % (report.header.stamp.secs, report.header.stamp.nsecs)
        assert report.header.frame_id == "world"
        assert report.in_collision == (row["in_collision"] == "1")
        assert row["distances"].count("=") == len(report.pairs)
        assert ("boxes_in_contact" in {marker.ns for marker in array.markers}) == report.in_collision
    assert not list(tmp_path.glob("*.part*"))


def distances_of(rows):
    return {(row["state"], pair.rsplit("=", 1)[0]): float(pair.rsplit("=", 1)[1])
            for row in rows for pair in filter(None, row["distances"].split(";"))}


def test_fidelity_and_tolerance_are_those_of_the_options(check_bag):
    (exact, found), (of_boxes, _), (rough, listed) = (
        (distances_of(rows), verdicts(rows)) for rows in (
            check_bag(DEMO_BAG, "--alarm-distance", "0.3", *options)[0]
            for options in ([], ["--fidelity", "aabb"], ["--tolerance", "0.05"])))
    for cheap, least in ((of_boxes, -9.0), (rough, -0.05)):
        less = [cheap[key] - exact[key] for key in exact]
        assert least - 1e-9 <= min(less) < -1e-6 and max(less) < 1e-9
    assert listed == found


def test_one_part_of_one_is_the_whole_and_can_be_recorded(run_tool, tmp_path):
    out, recorded = tmp_path / "out.csv", tmp_path / "recorded.bag"
    done = run_tool("check_bag", DEMO_BAG, "--shard", "1/1", "--out", out, "--record", recorded)
    assert done.returncode == 0 and "#" not in out.read_text() and recorded.exists()


def test_what_is_said_of_a_robot_is_said_once_for_consecutive_bags_with_it(run_tool, tmp_path):
    srdf = tmp_path / "demo.srdf"
    srdf.write_text("<robot name='demo'><disable_collisions link1='nobody' link2='table'/></robot>")
    done = run_tool("check_bag", DEMO_BAG, DEMO_BAG, "--srdf", srdf)
    assert done.returncode == 0 and done.stderr.count("not links of the robot, ignored: nobody") == 1
