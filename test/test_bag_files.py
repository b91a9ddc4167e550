"""Bag files as check_bag meets them: compressed, in any order, truncated, damaged, of another format."""
import bz2
import random
import re

import pytest
import rosbag
import rospy
from conftest import DEMO_BAG, DEMO_ROBOT, without_name
from seed import given_seed
from sensor_msgs.msg import JointState
from std_msgs.msg import Header

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


def test_the_order_of_joint_states_in_the_file_does_not_matter(check_bag, make_bag, tmp_path):
    straight, shuffled = make_bag("straight.bag", "--without", "tf"), tmp_path / "shuffled.bag"
    with rosbag.Bag(str(straight)) as source, rosbag.Bag(str(shuffled), "w") as target:
        messages = list(source.read_messages())
        random.seed(given_seed())
        random.shuffle(messages)
        for topic, message, recorded in messages:
            target.write(topic, message, recorded)
    assert without_name(check_bag(shuffled)[0]) == without_name(check_bag(straight)[0])


def test_of_many_topics_each_is_read_whatever_byte_its_number_is(check_bag, make_bag, tmp_path):
    few, many = make_bag("few.bag", "--without", "tf"), tmp_path / "many.bag"
    with rosbag.Bag(str(few)) as source, rosbag.Bag(str(many), "w") as target:
        first, *rest = sorted(source.read_messages(), key=lambda m: m[0] != "/joint_states")
        target.write(*first)
        for number in range(1, ord("=") + 1):  # the last one's field in the headers of records is "conn=="
            target.write("/topic%d" % number, JointState(), first[2])
        for message in rest:
            target.write(*message)
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


def records_of(content):
    """Each with its header's size, header, and size of its data; then its data."""
    place = 0
    while place < len(content):
        begin = place
        place += 4 + int.from_bytes(content[place:place + 4], "little")
        size = int.from_bytes(content[place:place + 4], "little")
        place += 4
        yield content[begin:place], content[place:place + size]
        place += size


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
                         (content[1:], "is not a bag"), (b"", "is not a bag"), (b"#ROS", "rosbag record")]:
        bag.write_bytes(broken)
        done = run_tool("check_bag", bag, "--out", tmp_path / "out.csv")
        assert done.returncode == 2 and says in done.stderr and str(bag) in done.stderr, (says, done.stderr)
        assert not (tmp_path / "out.csv").exists()
