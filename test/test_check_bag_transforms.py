"""check_bag follows the node's rules for transforms: liars, frames of both kinds, what came too late."""
import csv

import pytest
import rosbag
import rospy
from bags import stamped_transform
from conftest import sliding_boxes
from tf2_msgs.msg import TFMessage

START = 1000.0
NODES = {"/tf": "/honest", "tf": "/liar", "/tf_static": "/static"}  # by topic: a connection each
TIP = "<link name='tip'/><joint name='to_tip' type='fixed'><parent link='b'/><child link='tip'/></joint>"


def link_at(link, seconds, x, parent="root"):
    return TFMessage([stamped_transform(parent, link, seconds, (x, 0.0, 0.0))])


@pytest.fixture
def check(run_tool, tmp_path):
    """Boxes a (still) and b, which has a tip; `messages` are (topic, recorded, message). The finished process and the rows."""
    def run(messages, *arguments):
        urdf, bag, out = tmp_path / "boxes.urdf", tmp_path / "boxes.bag", tmp_path / "out.csv"
        urdf.write_text(sliding_boxes(more=TIP))
        with rosbag.Bag(str(bag), "w") as target:
            for topic, recorded, message in sorted(messages, key=lambda m: m[1]):
                header = {"topic": topic, "callerid": NODES[topic], "type": message._type, "md5sum": message._md5sum,
                          "message_definition": message._full_text}
                target.write(topic, message, rospy.Time.from_sec(recorded), connection_header=header)
        done = run_tool("check_bag", bag, "--urdf", urdf, "--out", out, *arguments)
        return done, rows_of(out) if out.exists() else []
    return run


def rows_of(path):
    with open(path) as lines:
        return list(csv.reader(lines))[1:]


def stream(link, x, topic="/tf", begin=START, end=START + 3.0, ahead=0.0, late=0.0, parent="root"):
    count = int((end - begin) / 0.05)
    return [(topic, begin + 0.05 * i + late, link_at(link, begin + 0.05 * i + ahead, x, parent)) for i in range(count)]


def static(link, x, recorded=START):
    return ("/tf_static", recorded, link_at(link, recorded, x))


def verdicts(rows, begin=START, end=START + 9.0):
    return {row[9] for row in rows if begin - 1e-6 < float(row[2]) < end + 1e-6}


def test_what_is_well_is_free(check):
    done, rows = check(stream("a", 0.0) + stream("b", 3.0))
    assert done.returncode == 0 and verdicts(rows) == {"free"}


@pytest.mark.parametrize("ahead", (0.0, 0.01, 0.45))
@pytest.mark.parametrize("topic, says", (("tf", "'/honest' and '/liar' both publish it, and contradict each other"),
                                         ("/tf", "'/honest' publishes it in two sequences")))
def test_a_frame_with_two_values_is_unknown_and_the_publishers_are_named(check, topic, says, ahead):
    if topic == "/tf" and ahead == 0.01:
        pytest.skip("one publisher that jumps to and fro is not found, unless its stamps do, too")
    done, rows = check(stream("a", 0.0) + stream("b", 0.9) + stream("b", 5.0, topic=topic, ahead=ahead))
    assert verdicts(rows, START + 0.5, START + 2.9) == {"unknown"}
    assert says in rows[30][10]


def test_transforms_of_other_namespaces_are_not_used_beside_those_that_a_node_hears(check):
    NODES.update({"/one/tf": "/one", "/two/tf": "/two"})
    touching, apart = stream("a", 0.0) + stream("b", 0.9), stream("b", 5.0, topic="/two/tf")
    done, rows = check(touching + apart)
    assert verdicts(rows) == {"collision"} and "transforms on /two/tf are not used" in done.stderr
    done, rows = check(stream("a", 0.0, topic="/two/tf") + stream("b", 3.0, topic="/two/tf"))
    assert verdicts(rows) == {"free"}, "of one namespace alone"
    done, _ = check(stream("a", 0.0, topic="/one/tf") + stream("b", 3.0, topic="/two/tf"))
    assert done.returncode == 2 and "transforms on several topics (/one/tf, /two/tf), and none on /tf" in done.stderr


def test_two_publishers_that_agree_are_believed(check):
    assert verdicts(check(stream("a", 0.0) + stream("b", 3.0) + stream("b", 3.0, topic="tf", ahead=0.01))[1],
                    START + 0.1, START + 2.9) == {"free"}


def test_a_frame_on_both_topics_is_unknown_until_one_is_silent(check):
    done, rows = check(stream("a", 0.0) + stream("b", 3.0) + [static("b", 5.0, START + 1.0)])
    assert verdicts(rows, START, START + 0.9) == {"free"}, "as the node says then"
    assert verdicts(rows, START + 1.05, START + 1.9) == {"unknown"}
    assert verdicts(rows, START + 2.1) == {"free"}
    assert "both on /tf and on /tf_static" in rows[25][10]


def test_a_moving_joint_on_tf_static_is_unknown_unless_it_is_said_to_stand(check, tmp_path):
    messages = stream("a", 0.0) + [static("b", 3.0)]
    done, rows = check(messages)
    assert verdicts(rows) == {"unknown"} and "slide_b" in rows[0][10] and rows[0][8] == "b"
    settings = tmp_path / "settings.yaml"
    settings.write_text("static_joints: [slide_b]")
    assert verdicts(check(messages, "--settings", settings)[1]) == {"free"}
    settings.write_text("static_joints: [slide_c]")
    done, _ = check(messages, "--settings", settings)
    assert done.returncode == 2 and "slide_a" in done.stderr


def test_without_any_row_it_fails_and_says_why(check):
    done, rows = check([static("a", 0.0), static("b", 3.0)])
    assert done.returncode == 2 and not rows and "there is no stamp to check" in done.stderr
    assert "link 'a': only /tf_static places it, but joint 'slide_a' is not fixed" in done.stderr


def test_a_robot_of_which_only_a_fixed_joint_is_on_tf_is_not_said_to_be_another(check):
    messages = [static("a", 0.0), static("b", 3.0)] + stream("tip", 0.0, parent="b")
    done, rows = check(messages)
    assert done.returncode == 2 and not rows
    assert "of its 2 links on moving joints that TF names none is placed, and no joint states move them" in done.stderr
    assert "mention" not in done.stderr


def test_transforms_that_came_too_late_make_unknown_rows(check, tmp_path):
    messages = stream("a", 0.0, end=START + 5.0) + stream("b", 3.0, late=1.5)
    done, rows = check(messages)
    assert verdicts(rows) == {"unknown"} and "old when it arrived" in done.stdout + done.stderr
    settings = tmp_path / "settings.yaml"
    settings.write_text("max_pose_age: 5.0")
    assert verdicts(check(messages, "--settings", settings)[1]) == {"unknown"}, "b lags behind a by more than a second"
    settings.write_text("{max_pose_age: 5.0, max_transform_age: 2.0}")
    assert verdicts(check(messages, "--settings", settings)[1], START + 1.6, START + 2.9) == {"free"}


def test_each_stamp_has_its_row_though_the_clocks_of_sender_and_recorder_differ(check):
    messages, stamps = [], []
    for i in range(40):
        stamps.append(START + 0.05 * i + (0.01 if i % 2 else -0.01))
        messages += [("/tf", START + 0.05 * i, link_at(link, stamps[-1], x)) for link, x in (("a", 0.0), ("b", 3.0))]
    done, rows = check(messages)
    assert [round(float(row[2]), 3) for row in rows] == [round(stamp, 3) for stamp in stamps]
    assert verdicts(rows) == {"free"}
