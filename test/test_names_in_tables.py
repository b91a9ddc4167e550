"""Whatever links, joints and bags are called, the tables of all tools say it so that Python's csv reads it back."""
import csv
import itertools
import random
from urllib.parse import unquote
from xml.sax.saxutils import quoteattr

import pytest
import rosbag
import rospy
from seed import given_seed
from sensor_msgs.msg import JointState

HOSTILE = ["|", ";", ",", "=", "%", '"', "'", "#", "\n", "\t", " ", "$", "_", "%7C", "&", "<", "é", "a", "b", "0"]
NB_LINKS = 6
BOX = '<collision><geometry><box size="1 1 1"/></geometry></collision>'


def hostile_names(count, seed):
    rng = random.Random(seed)
    names = set()
    while len(names) < count:
        names.add("".join(rng.choice(HOSTILE) for _ in range(rng.randint(1, 8))))
    return rng.sample(sorted(names), count)


class Robot:
    """A chain of boxes in one place: all but neighbours are always in contact."""

    def __init__(self, links, joints, folder):
        attribute = lambda text: quoteattr(text, {"\n": "&#10;", "\t": "&#9;"})
        parts = ["<link name=%s>%s</link>" % (attribute(link), BOX) for link in links]
        for i, joint in enumerate(joints):
            parts.append('<joint name=%s type="revolute"><parent link=%s/><child link=%s/>'
                         '<limit lower="-1" upper="1"/></joint>' %
                         (attribute(joint), attribute(links[i]), attribute(links[i + 1])))
        self.path = folder / "robot.urdf"
        self.path.write_text('<robot name="r">%s</robot>' % "".join(parts), encoding="utf-8")
        self.joints = joints
        ordered = lambda a, b: (a, b) if a.encode() < b.encode() else (b, a)
        self.contacts = {ordered(links[i], links[j]) for i, j in itertools.combinations(range(len(links)), 2)
                         if j > i + 1}
        self.all_pairs = {ordered(a, b) for a, b in itertools.combinations(links, 2)}

    def write_states(self, path):
        with open(path, "w", encoding="utf-8", newline="") as out:
            nb_joints = len(self.joints)
            csv.writer(out, quoting=csv.QUOTE_NONNUMERIC).writerows([self.joints, [0.1] * nb_joints, [-0.2] * nb_joints])
        return path


def rows_of(path):
    with open(path, encoding="utf-8", newline="") as lines:
        return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def pairs_in(field):
    return [tuple(map(unquote, pair.split("|"))) for pair in field.split(";")]


@pytest.fixture(params=range(1, 9), ids=lambda seed: "seed%d" % seed)
def robot(request, tmp_path):
    names = hostile_names(2 * NB_LINKS - 1, given_seed() + request.param)
    return Robot(names[:NB_LINKS], names[NB_LINKS:], tmp_path)


def ran(run_tool, *arguments):
    done = run_tool(*arguments)
    assert done.returncode == 0, done.stderr
    return done


def test_of_states_and_motions(run_tool, robot, tmp_path):
    states, out = robot.write_states(tmp_path / "states.csv"), tmp_path / "out.csv"
    ran(run_tool, "check_states", robot.path, "--states", states, "--out", out)
    rows = rows_of(out)
    assert len(rows) == 2
    for row in rows:
        assert set(pairs_in(row["pairs"])) == robot.contacts
    ran(run_tool, "check_motion", robot.path, "--waypoints", states, "--out", out)
    (row,) = rows_of(out)
    assert row["verdict"] == "collision" and set(pairs_in(row["pairs"])) == robot.contacts


def test_of_pairs(run_tool, robot, tmp_path):
    out = tmp_path / "pairs.csv"
    ran(run_tool, "generate_srdf", robot.path, "--samples", "20", "--searches", "0", "--report", out, "--out",
        tmp_path / "out.srdf")
    rows = rows_of(out)
    assert {(unquote(row["link1"]), unquote(row["link2"])) for row in rows} == robot.all_pairs
    for row in rows:
        state = dict(entry.split("=") for entry in row["contact_state"].split(";"))
        assert set(map(unquote, state)) <= set(robot.joints) and all(map(float, state.values()))


def test_of_bags_merged_and_as_a_page(run_tool, robot, tmp_path):
    bags = [str(tmp_path / name) for name in ('a, "b".bag', "c;d=e|f%7C.bag")]
    for path in bags:
        with rosbag.Bag(path, "w") as bag:
            for i in range(4):
                message = JointState(name=robot.joints, position=[0.1 * i] * len(robot.joints))
                message.header.stamp = rospy.Time(10, 1000 * i)
                bag.write("/joint_states", message, message.header.stamp)
    tables = [tmp_path / ("part%d.csv" % i) for i in (1, 2, 3)]
    for i, table in enumerate(tables, 1):
        ran(run_tool, "check_bag", *bags, "--urdf", robot.path, "--shard", "%d/3" % i, "--out", table)
    merged, whole = tmp_path / "merged.csv", tmp_path / "whole.csv"
    ran(run_tool, "merge_bag_checks", *tables, "--out", merged)
    ran(run_tool, "check_bag", *bags, "--urdf", robot.path, "--out", whole, "--report", tmp_path / "page")
    assert merged.read_bytes() == whole.read_bytes()
    rows = rows_of(whole)
    assert [row["bag"] for row in rows] == [bag for bag in bags for _ in range(4)]
    for row in rows:
        assert set(pairs_in(row["pairs"])) == robot.contacts
        distances = dict(entry.rsplit("=", 1) for entry in row["distances"].split(";"))
        assert {pairs_in(pair)[0] for pair in distances} == robot.contacts
        assert all(float(distance) <= 0 for distance in distances.values())


def test_a_bag_whose_name_looks_like_a_comment_is_no_comment(run_tool, make_bag, tmp_path, monkeypatch):
    make_bag("#1.bag", "--rate", "2")
    monkeypatch.chdir(tmp_path)
    ran(run_tool, "check_bag", "#1.bag", "--out", "whole.csv")
    ran(run_tool, "merge_bag_checks", "whole.csv", "--out", "merged.csv")
    assert {row["bag"] for row in rows_of("merged.csv")} == {"#1.bag"}
