"""Bag files as check_bag meets them: compressed, in any order, truncated, damaged, of another format."""
import bz2
import random
import re

import pytest
import rosbag
import rospy
from bags import copied
from conftest import DEMO_BAG, DEMO_ROBOT, records_of, rows_of, sliding_boxes, without_name
from seed import given_seed
from sensor_msgs.msg import JointState
from std_msgs.msg import Header, String

MAGIC = b"#ROSBAG V2.0\n"


@pytest.mark.parametrize("compression", ["none", "bz2", "lz4"])
def test_compressed_bags_are_read(check_bag, make_bag, compression):
    rows, said = check_bag(make_bag("c.bag", "--compression", compression))
    assert without_name(rows) == without_name(check_bag(DEMO_BAG)[0])
    assert "truncated" not in said


@pytest.mark.parametrize("compression", ["none", "bz2", "lz4"])
def test_of_a_truncated_bag_the_front_is_read_and_the_loss_is_said(check_bag, make_bag, compression):
    bag = make_bag("t.bag", "--compression", compression, "--rate", "200")
    whole, _ = check_bag(bag)
    content = bag.read_bytes()
    # Within the messages, long before the index.
    bag.write_bytes(content[:len(content) * 2 // 3])
    rows, said = check_bag(bag)
    assert 0 < len(rows) < len(whole)
    assert rows[:-1] == whole[:len(rows) - 1]  # the last may lack what was recorded after it
    assert "truncated" in said


@pytest.mark.parametrize("options", [(), ("--without", "tf")], ids=["transforms", "joint states"])
def test_the_order_of_messages_in_the_file_does_not_matter(check_bag, make_bag, tmp_path, options):
    straight, draw = make_bag("straight.bag", *options), random.Random(given_seed())
    shuffled = copied(tmp_path / "shuffled.bag", lambda messages: draw.sample(messages, len(messages)), straight)
    assert without_name(check_bag(shuffled)[0]) == without_name(check_bag(straight)[0])


def test_of_many_topics_each_is_read_whatever_byte_its_number_is(check_bag, make_bag, tmp_path):
    few = make_bag("few.bag", "--without", "tf")

    def with_others(messages):  # the last one's field in the headers of records is "conn=="
        first, *rest = sorted(messages, key=lambda m: m[0] != "/joint_states")
        return [first] + [("/topic%d" % number, JointState(), first[2]) for number in range(1, ord("=") + 1)] + rest
    many = copied(tmp_path / "many.bag", with_others, few)
    assert without_name(check_bag(many)[0]) == without_name(check_bag(few)[0])


def test_an_unindexed_bag_is_read_whole_and_said_to_be_unindexed(check_bag, make_bag):
    bag = make_bag("u.bag")
    whole, _ = check_bag(bag)
    content = bytearray(bag.read_bytes())
    place = content.index(b"index_pos=") + len(b"index_pos=")
    content[place:place + 8] = bytes(8)  # as in the file of a recorder that was killed
    bag.write_bytes(content)
    rows, said = check_bag(bag)
    assert rows == whole and "it has no index" in said


def test_a_damaged_chunk_loses_its_own_messages_only(check_bag, make_bag):
    bag = make_bag("d.bag", "--compression", "bz2", "--rate", "800")
    whole, _ = check_bag(bag)
    content = bytearray(bag.read_bytes())
    chunk = content.index(b"op=\x05", content.index(b"op=\x05") + 1)  # the second chunk
    content[chunk + 4000:chunk + 4200] = bytes(200)
    bag.write_bytes(content)
    rows, said = check_bag(bag)
    assert "the end of the chunk" in said
    assert len(whole) // 4 < len(rows) < len(whole)
    assert rows[0] == whole[0] and rows[-1]["stamp"] == whole[-1]["stamp"]


def test_where_a_record_is_not_known_as_a_chunk_only_its_messages_are_lost(check_bag, make_bag):
    bag = make_bag("o.bag", "--compression", "bz2", "--rate", "800")
    whole, _ = check_bag(bag)
    content = bytearray(bag.read_bytes())
    chunk = content.index(b"op=\x05", content.index(b"op=\x05") + 1)  # the second chunk
    for op in (b"\x09", b"\x04", b"\x06"):  # unknown, an index, what is known of a chunk
        content[chunk + 3:chunk + 4] = op
        bag.write_bytes(content)
        rows, said = check_bag(bag)
        assert said.count("is not understood") == 1 and "are not in it" not in said, said
        assert len(whole) // 4 < len(rows) < len(whole)
        assert rows[0] == whole[0] and rows[-1]["stamp"] == whole[-1]["stamp"]


def test_a_chunk_that_ends_between_two_records_too_early_is_a_loss(check_bag, make_bag):
    bag = make_bag("e.bag", "--compression", "bz2")
    damaged, cut = [MAGIC], 0
    for header, data in records_of(bag.read_bytes()[len(MAGIC):]):
        if b"op=\x05" in header and not cut:
            inside = [head + rest for head, rest in records_of(bz2.decompress(data))]
            cut = len(inside[-1])
            data = bz2.compress(b"".join(inside[:-1]))
            header = header[:-4] + len(data).to_bytes(4, "little")
        damaged += [header, data]
    assert cut > 0 and "the end of the chunk" not in check_bag(bag)[1]
    bag.write_bytes(b"".join(damaged))
    assert "the end of the chunk" in check_bag(bag)[1]


@pytest.mark.parametrize("compression", ["none", "bz2", "lz4"])
def test_of_a_chunk_that_the_file_ends_in_no_more_is_read_than_there_is(check_bag, make_bag, compression):
    bag = make_bag("m.bag", "--compression", compression, "--rate", "200")
    content, place, middles = bag.read_bytes(), len(MAGIC), []
    for header, data in records_of(content[len(MAGIC):]):
        if b"op=\x05" in header:
            middles.append(place + len(header) + len(data) // 2)
        place += len(header) + len(data)
    bag.write_bytes(content[:middles[-1]])
    chunk = re.search(r"of its (\d+) bytes (\d+) were read", check_bag(bag)[1])
    assert chunk and int(chunk.group(2)) < int(chunk.group(1))


def test_garbage_is_survived_at_any_place(run_tool, make_bag, tmp_path):
    """Whatever is overwritten, the tool ends with 0 or 2 and never hangs or crashes."""
    bag = make_bag("g.bag", "--compression", "none", "--rate", "5")
    content = bag.read_bytes()
    random.seed(given_seed())
    for _ in range(60):
        broken = bytearray(content)
        for _ in range(random.randint(1, 4)):
            place = random.randrange(len(broken))
            broken[place:place + 8] = bytes(random.randrange(256) for _ in range(8))
        bag.write_bytes(broken[:random.choice([len(broken), random.randrange(len(broken))])])
        done = run_tool("check_bag", bag, *DEMO_ROBOT, "--out", tmp_path / "out.csv")
        assert done.returncode in (0, 2), done


def test_a_message_that_claims_more_than_it_has_is_passed_over_and_said(check_bag, make_bag):
    bag = make_bag("c.bag", "--compression", "none", "--without", "tf")
    whole, _ = check_bag(bag)
    content = bytearray(bag.read_bytes())
    names = (8).to_bytes(4, "little") + len("shoulder_pan").to_bytes(4, "little") + b"shoulder_pan"
    place = content.index(names, content.index(names) + 1)  # the second joint state
    content[place:place + 4] = b"\xff\xff\xff\x7f"
    bag.write_bytes(content)
    rows, said = check_bag(bag)
    assert len(rows) == len(whole) - 1 and "1 messages that do not match their type" in said


def test_of_a_bag_without_a_pose_it_is_said_whether_something_was_lost(run_tool, make_bag, tmp_path):
    empty = tmp_path / "empty.bag"
    with rosbag.Bag(str(empty), "w") as target:
        target.write("/chatter", Header(), rospy.Time(1))
    cut = make_bag("cut.bag")
    cut.write_bytes(cut.read_bytes()[:5000])  # behind the header, before the first chunk ends
    for bag, says in ((empty, "in it"), (cut, "in what could be read: the file is truncated within the record")):
        done = run_tool("check_bag", bag, *DEMO_ROBOT, "--out", tmp_path / "out.csv")
        assert done.returncode == 2
        assert "%s: no transforms and no joint states %s" % (bag, says) in done.stderr, done.stderr


def test_what_is_not_a_plain_bag_of_format_2_is_refused_with_the_way_out(run_tool, make_bag, tmp_path):
    bag = make_bag("r.bag")
    content = bag.read_bytes()
    size = int.from_bytes(content[13:17], "little")
    field = b"encryptor=rosbag/AesCbcEncryptor"
    fields = content[17:17 + size].replace(len(b"encryptor=").to_bytes(4, "little") + b"encryptor=", b"")
    header = fields + len(field).to_bytes(4, "little") + field
    encrypted = content[:13] + len(header).to_bytes(4, "little") + header + content[17 + size:]
    for broken, says in [(b"#ROSRECORD V1.2\n" + content[13:], "rosbag record"), (encrypted, "rosbag decrypt"),
                         (content[1:], "is not a bag\n"), (b"", "is not a bag"), (b"#ROS", "rosbag record")]:
        bag.write_bytes(broken)
        done = run_tool("check_bag", bag, "--out", tmp_path / "out.csv")
        assert done.returncode == 2 and says in done.stderr and str(bag) in done.stderr, (says, done.stderr)
        assert not (tmp_path / "out.csv").exists()


BOXES = sliding_boxes()


def at(stamp, b=3.0, a=0.0, names=("slide_a", "slide_b")):
    message = JointState(name=names, position=[a, b])
    message.header.stamp = rospy.Time.from_sec(stamp)
    return message


@pytest.fixture
def run_bag(run_tool, tmp_path):
    """Of a bag of (topic, recorded, message): the process, and what it warned of without the bag's name."""
    def run(messages, *arguments, name="boxes.bag", change=lambda content: content):
        bag, out = tmp_path / name, tmp_path / "out.csv"
        with rosbag.Bag(str(bag), "w") as target:
            for topic, recorded, message in messages:
                target.write(topic, message, rospy.Time.from_sec(recorded))
        bag.write_bytes(change(bag.read_bytes()))
        done = run_tool("check_bag", bag, "--out", out, *arguments)
        return done, [line.replace("warning: %s: " % bag, "") for line in done.stderr.splitlines()]
    return run


def described(text, topic="/robot_description"):
    return (topic, 99.0, String(data=text))


def states(*of, topic="/joint_states"):
    """Recorded at their stamps, or of (recorded, message)."""
    return [(topic, *each) if isinstance(each, tuple) else (topic, each.header.stamp.to_sec(), each) for each in of]


@pytest.mark.parametrize("ending", ("db3", "mcap"))
def test_a_bag_of_ros_2_is_refused_with_what_converts_it(run_tool, tmp_path, ending):
    bag = tmp_path / ("recording." + ending)
    bag.write_bytes(b"SQLite format 3\0")
    done = run_tool("check_bag", bag)
    assert done.returncode == 2 and "is not a bag of ROS 1; convert it with rosbags-convert" in done.stderr


def test_what_is_not_used_is_counted_and_the_first_of_it_is_said(run_bag):
    odd = ("slide_a", "slide_b", "of_no_position")
    messages = [described(BOXES)] + states(
        at(100.0), at(100.5), at(101.0, b=float("nan")), (101.5, at(100.375)), at(102.0, names=odd), (102.5, at(101.25)), at(102.5))
    done, said = run_bag(messages)
    assert done.returncode == 0 and said == [
        "3 transforms and joint positions that are not finite, not a rotation, or not one for each name",
        "4 transforms are not used, or are suspect; the first: transform of 'a': it was 1.12 s old when it "
        "arrived, and max_pose_age is 1.00 s"]
    assert run_bag(messages[:3])[1] == []


def test_joint_states_are_read_as_robot_state_publisher_reads_them(run_tool, tmp_path, run_bag):
    """Not if positions and names differ in number, and the first of a name that comes twice."""
    again, without = at(101.0, names=("slide_a", "slide_b", "slide_a")), at(101.5)
    again.position += [3.0]
    without.position = []
    done, said = run_bag([described(BOXES)] + states(
        at(100.0), at(100.5, b=0.0, names=("slide_a", "slide_b", "of_no_position")), again, without))
    assert done.returncode == 0 and said == [
        "3 transforms and joint positions that are not finite, not a rotation, or not one for each name"]
    assert [row["pairs"] for row in rows_of(tmp_path / "out.csv")] == ["", ""]


@pytest.mark.parametrize("topic, option", [("/robot_description", "--urdf"), ("/robot_description_semantic", "--srdf")])
def test_a_description_that_changes_within_a_bag_is_refused_unless_one_is_given(run_bag, tmp_path, topic, option):
    srdf = "<robot name='boxes'/>"
    texts = {"/robot_description": BOXES, "/robot_description_semantic": srdf}
    messages = states(at(100.0), at(101.0)) + [(name, 99.0, String(data=text)) for name, text in texts.items()]
    assert run_bag(messages + [(topic, 102.0, String(data=texts[topic]))])[0].returncode == 0, "the same again"
    messages += [(topic, 102.0, String(data=texts[topic] + "<!-- another -->"))]
    done, said = run_bag(messages)
    assert done.returncode == 2 and "the text on %s changes within it; give %s, or split the bag" % (topic, option) in said[0]
    (tmp_path / "given").write_text(texts[topic])
    assert run_bag(messages, option, tmp_path / "given")[0].returncode == 0


@pytest.mark.parametrize("nanoseconds, count", [(0, 0), (1, 2)])
def test_a_clock_goes_back_by_more_than_five_seconds(run_bag, nanoseconds, count):
    """Of the stamps, whenever they were recorded; for every time that it does."""
    forward = states(*(at(100.0 + 0.5 * i) for i in range(12)))
    for newest in (105.5, 106.0):
        back = at(newest)
        back.header.stamp -= rospy.Duration(5, nanoseconds)
        forward += states(at(newest), (newest, back))
    said = [line for line in run_bag([described(BOXES)] + forward)[1] if "clock" in line]
    assert said == ["%d times its clock goes back; what is then too old is not used, so split the bag there" % count] * (count > 0)


def test_topics_are_known_by_the_end_of_their_name_and_their_type(run_bag):
    good = [described(BOXES, "/left/robot_description")] + states(at(100.0), at(100.5), topic="/left/joint_states")
    others = [described("no robot", "/robot_description_2"), ("/tf", 99.0, String(data="x")), ("/joint_states", 99.0, String(data="y")),
              ("/tf_static", 99.0, at(1.0)), ("/robot_description", 99.0, at(1.0)), ("/states", 99.0, at(1.0))]
    for messages in (good, others + good):
        done, said = run_bag(messages, "--prefix", "left")
        assert done.returncode == 0 and said == [], said
    assert done.stdout.split(":")[1].startswith(" 2 stamps")


def test_of_robots_in_the_bag_two_topics_are_too_many(run_bag):
    of = states(at(100.0), at(100.5))
    off = "<robot name='boxes'><disable_collisions link1='a' link2='b'/><disable_collisions link1='a' link2='x'/></robot>"
    semantic = "/robot_description_semantic"
    done, said = run_bag([described(BOXES), described(off, semantic)] + of)
    assert said[0] == "warning: topic /robot_description_semantic: not links of the robot, ignored: x"
    for topic, option in (("robot_description", "--urdf"), ("robot_description_semantic", "--srdf")):
        two = [described(BOXES)] + [described(BOXES, "/%s/%s" % (name, topic)) for name in ("one", "two")]
        done, said = run_bag(two[option == "--urdf":] + of, name="two.bag")
        assert done.returncode == 2 and said[0].endswith(
            "two.bag: several robots in it (/one/%s, /two/%s); choose one with %s" % (topic, topic, option)), said
    done, said = run_bag([described("broken")] + of)
    assert done.returncode == 2 and "boxes.bag: topic /robot_description: " in said[0]


def test_an_srdf_further_up_than_the_urdf_is_not_used(run_bag):
    of = states(at(100.0), at(100.5), topic="/left/joint_states")
    off = "<robot name='boxes'><disable_collisions link1='a' link2='x'/></robot>"
    for namespace, is_used in (("/left", True), ("", False), ("/right", False)):
        messages = [described(BOXES, "/left/robot_description"), described(off, namespace + "/robot_description_semantic")] + of
        _, said = run_bag(messages, "--prefix", "left")
        assert any("not links of the robot" in line for line in said) == is_used, said
        assert any("may be of another robot than /left/robot_description" in line for line in said) != is_used, said


def test_an_srdf_beside_a_urdf_that_is_replaced_is_not_used(run_bag, tmp_path):
    urdf = tmp_path / "boxes.urdf"
    urdf.write_text(BOXES)
    off = "<robot name='boxes'><disable_collisions link1='a' link2='x'/></robot>"
    for namespace in ("", "/left"):
        messages = [described(off, namespace + "/robot_description_semantic")] + states(at(100.0), at(100.5))
        _, said = run_bag(messages, "--urdf", urdf)
        assert any("semantic is not used: it may be of another robot than %s; --srdf gives one" % urdf in line for line in said)
        assert not any("not links of the robot" in line for line in said), said


def test_a_path_that_is_no_bag_is_said_to_be_none(run_tool, tmp_path):
    for path, why in ((tmp_path / "none.bag", "there is no such file"), (tmp_path, "is not a file")):
        done = run_tool("check_bag", path, "--urdf", DEMO_ROBOT[1])
        assert (done.returncode, done.stdout, done.stderr) == (2, "", "error: %s: %s\n" % (path, why))


@pytest.mark.parametrize("index", [bytes(8), b"\1" + bytes(7), bytes(4) + b"\1" + bytes(3)])
def test_a_bag_has_an_index_wherever_that_is(run_bag, index):
    def change(content):
        place = content.index(b"index_pos=") + len(b"index_pos=")
        return content[:place] + index + content[place + 8:]
    done, said = run_bag([described(BOXES)] + states(at(100.0), at(100.5)), change=change)
    assert said == ([] if any(index) else ["it has no index: its recording was not closed"])


def test_where_a_bag_ends_too_early_is_said_by_the_byte(run_bag):
    whole = []
    messages = [described(BOXES)] + states(*(at(100.0 + 0.25 * i) for i in range(8)))
    assert run_bag(messages, change=lambda content: whole.append(content) or content)[1] == []
    place, nb_chunks = len(MAGIC), 0
    for header, data in records_of(whole[0][len(MAGIC):]):
        is_chunk = b"op=\x05" in header
        cut = place + len(header) + len(data) // 2
        said = run_bag(messages, "--urdf", DEMO_ROBOT[1], change=lambda content: content[:place + 2])[1]
        assert "nothing could be read after byte %d" % place in "".join(said)
        said = run_bag(messages, change=lambda content: content[:cut])[1]
        assert "the file is truncated within the record that begins at byte %d" % place in "".join(said)
        if is_chunk:
            nb_chunks += 1
            assert said[0] == "the end of the chunk at byte %d (of its %d bytes %d were read)" % (
                place, len(data), len(data) // 2), said
        place += len(header) + len(data)
    assert nb_chunks == 1 and place == len(whole[0])
