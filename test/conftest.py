"""What the Python tests share: where the tools and the module are, a small robot, the reference data."""
import csv
import os
import subprocess
import sys

import pytest

PROJECT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
TOOLS = os.environ.get("COLLISION_PAIRS_TOOLS", os.path.join(PROJECT, "build/devel/lib/collision_pairs"))
PYTHON = os.path.normpath(os.path.join(TOOLS, "../python3/dist-packages"))  # the module and the messages
TIMES_SLOWER = 10 if "TSAN_OPTIONS" in os.environ else 1  # scripts/test --sanitize
DEMO = os.path.join(PROJECT, "config/demo")
DEMO_BAG = os.path.join(DEMO, "demo.bag")
URDF, SRDF = os.path.join(DEMO, "demo_robot.urdf"), os.path.join(DEMO, "demo_robot.srdf")
DEMO_ROBOT = ["--urdf", URDF, "--srdf", SRDF]
SYSTEM_PATH = "/usr/bin:/bin:" + os.environ.get("PATH", "")  # another Python may come first in PATH
sys.path.insert(0, PYTHON)


@pytest.fixture
def run_tool():
    """Runs a tool of the package; returns the finished process."""
    def run(name, *arguments, packages=PROJECT):
        return subprocess.run([os.path.join(TOOLS, name), *map(str, arguments)], timeout=120 * TIMES_SLOWER,
                              env=dict(os.environ, ROS_PACKAGE_PATH=packages + ":/usr/share",
                                       PATH=SYSTEM_PATH),
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    return run


@pytest.fixture(scope="session")
def made_bags():
    return {}


@pytest.fixture
def make_bag(tmp_path, made_bags):
    """Makes a bag of the demo robot, by the script that makes the demo's, once for each options; returns its path."""
    def make(name, *options):
        path = tmp_path / name
        if options not in made_bags:
            subprocess.run([os.path.join(DEMO, "make_bag"), str(path), *options], check=True, timeout=120)
            made_bags[options] = path.read_bytes()
        path.write_bytes(made_bags[options])
        return path
    return make


def sliding_boxes(names="ab", shape="<box size='1 1 1'/>", more=""):
    """A URDF: links of these names, unit boxes or of this shape, that slide along x on joints slide_<name>; and more."""
    link = "<link name='%s'><collision><geometry>" + shape + "</geometry></collision></link>"
    slide = ("<joint name='slide_%s' type='prismatic'><parent link='root'/><child link='%s'/><axis xyz='1 0 0'/>"
             "<limit lower='-9' upper='9' effort='1' velocity='1'/></joint>")
    boxes = "".join(link % name + slide % (name, name) for name in names)
    return "<robot name='boxes'><link name='root'/>" + boxes + more + "</robot>"


def rows_of(path):
    """Of a table with a header: a dict each."""
    with open(path) as lines:
        return list(csv.DictReader(lines))


def records_of(content):
    """Of a bag behind its first line, or of a chunk: each with its header's size, header, and size of its data; then its data."""
    place = 0
    while place < len(content):
        begin = place
        place += 4 + int.from_bytes(content[place:place + 4], "little")
        size = int.from_bytes(content[place:place + 4], "little")
        place += 4
        yield content[begin:place], content[place:place + size]
        place += size


def without_name(rows):
    """Rows of check_bag but for the path of the bag."""
    return [{key: value for key, value in row.items() if key != "bag"} for row in rows]


@pytest.fixture
def check_bag(run_tool, tmp_path):
    """Runs check_bag; the rows it wrote and what it said."""
    def run(*arguments):
        out = tmp_path / "out.csv"
        done = run_tool("check_bag", *arguments, "--out", out)
        assert done.returncode == 0, done.stderr
        return rows_of(out), done.stdout + done.stderr
    return run


@pytest.fixture
def states(tmp_path):
    """States of the demo robot: a free one, and one in collision."""
    path = tmp_path / "states.csv"
    path.write_text("shoulder_pan,shoulder_lift,elbow_flex,wrist_flex,wrist_roll\n"
                    "0,-0.3,1.2,0.9,0\n0.3,1.1,0.6,-0.1,1.35\n")
    return path


@pytest.fixture
def shared():
    """The folder with real robots and true verdicts; the test is skipped where it is absent."""
    folder = os.environ.get("COLLISION_PAIRS_SHARED", "")
    if not os.path.isdir(os.path.join(folder, "reference")):
        pytest.skip("no reference data; COLLISION_PAIRS_SHARED names its folder")
    return folder
