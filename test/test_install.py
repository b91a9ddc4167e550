"""What is installed is whole: the tools run from there, and a stranger's program compiles against it."""
import os
import re
import subprocess

import pytest
from conftest import DEMO, PROJECT, TOOLS

BUILD = os.path.dirname(os.path.dirname(os.path.dirname(TOOLS)))

CLEAN = {"PATH": "/usr/bin:/bin", "ROS_PACKAGE_PATH": PROJECT + ":/usr/share", "PYTHONDONTWRITEBYTECODE": "1"}


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    prefix = tmp_path_factory.mktemp("installed")
    subprocess.run(["cmake", "--install", BUILD, "--prefix", str(prefix)], check=True,
                   stdout=subprocess.PIPE, env=dict(os.environ, DESTDIR=""))
    return prefix


def test_everything_a_user_needs_is_there(installed):
    share = installed / "share/collision_pairs"
    for path in ("package.xml", "launch/collision_pairs.launch", "launch/demo.launch",
                 "config/collision_pairs_node.yaml", "config/collision_pairs.rviz",
                 "config/demo/demo_robot.urdf", "config/demo/meshes/arch.obj", "srv/CheckCollisions.srv"):
        assert (share / path).is_file(), path
    for name in ("collision_pairs_node", "check_motion", "check_states", "generate_srdf", "move_demo_robot", "print_collision_pairs"):
        assert os.access(installed / "lib/collision_pairs" / name, os.X_OK), name


def test_installed_programs_find_their_libraries_by_themselves(installed, tmp_path):
    states = tmp_path / "states.csv"
    states.write_text("shoulder_pan\n0\n")
    done = subprocess.run(
        [installed / "lib/collision_pairs/check_states", DEMO + "/demo_robot.urdf", "--srdf",
         DEMO + "/demo_robot.srdf", "--states", states],
        env=CLEAN, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[1].startswith("0,0,")
    for name in sorted(os.listdir(installed / "lib/collision_pairs")):
        program = installed / "lib/collision_pairs" / name
        if program.read_bytes()[:4] == b"\x7fELF":
            needed = subprocess.run(["ldd", program], env=CLEAN, stdout=subprocess.PIPE, text=True, check=True).stdout
            assert "not found" not in needed, name
            assert BUILD not in needed, name


@pytest.fixture
def build_example(installed, tmp_path):
    def build(name, space="install"):
        prefix = os.path.join(BUILD, "devel") if space == "devel" else str(installed)
        subprocess.run(["cmake", "-S", PROJECT + "/examples/" + name, "-B", tmp_path, "-DCMAKE_PREFIX_PATH=" + prefix,
                        "-DCMAKE_CXX_FLAGS=-Wall -Werror", "-DPYTHON_EXECUTABLE=/usr/bin/python3"],
                       env=CLEAN, check=True, stdout=subprocess.PIPE)
        subprocess.run(["cmake", "--build", tmp_path], env=CLEAN, check=True, stdout=subprocess.PIPE)
    return build


@pytest.mark.parametrize("space", ("devel", "install"))
def test_the_example_package_is_built_by_find_package(build_example, tmp_path, space):
    build_example("check_robot", space)
    done = subprocess.run([tmp_path / "check_robot", DEMO + "/demo_robot.urdf", DEMO + "/demo_robot.srdf"],
                          env=CLEAN, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 0, done.stderr
    states = tmp_path / "states.csv"
    states.write_text("shoulder_pan\n0\n")
    table = subprocess.run([os.path.join(TOOLS, "check_states"), DEMO + "/demo_robot.urdf", "--srdf",
                            DEMO + "/demo_robot.srdf", "--states", states, "--min-distance"],
                           env=CLEAN, stdout=subprocess.PIPE, text=True, check=True).stdout
    min_distance = float(table.splitlines()[1].split(",")[3])
    assert done.stdout.startswith("free, ")
    assert float(done.stdout.split()[1]) == pytest.approx(min_distance, rel=1e-4)


def test_the_example_of_a_planner_plans(build_example, tmp_path):
    build_example("plan_with_ompl")
    robot = (DEMO + "/demo_robot.urdf", DEMO + "/demo_robot.srdf")
    pan, lift, elbow = "shoulder_pan=%s:0.75", "shoulder_lift=-0.3:0.35", "elbow_flex=1.2:0.9"
    done = subprocess.run([tmp_path / "plan_with_ompl", *robot, pan % 0, lift, elbow], env=CLEAN, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert done.returncode == 0, done.stderr
    path = [[float(q) for q in line.split()] for line in done.stdout.splitlines() if re.match(r"[-\d. e]+$", line)]
    assert path[0] == pytest.approx([0, -0.3, 1.2]) and path[-1] == pytest.approx([0.75, 0.35, 0.9])
    waypoints = tmp_path / "waypoints.csv"
    waypoints.write_text("shoulder_pan,shoulder_lift,elbow_flex\n" + "".join("%.17g,%.17g,%.17g\n" % tuple(q) for q in path))
    certified = subprocess.run([os.path.join(TOOLS, "check_motion"), robot[0], "--srdf", robot[1], "--waypoints", waypoints],
                               env=CLEAN, stdout=subprocess.PIPE, text=True, check=True).stdout
    assert [row.split(",")[1] for row in certified.splitlines()[1:]] == ["free"] * (len(path) - 1)
    refused = subprocess.run([tmp_path / "plan_with_ompl", *robot, "shoulder_pam=0:1"], env=CLEAN, text=True,
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert refused.returncode == 2 and "shoulder_pam" in refused.stderr


PYTHON_PROGRAM = """
import collision_pairs, collision_pairs.msg
from collision_pairs.srv import CheckCollisionsRequest
assert collision_pairs.__file__.startswith({place!r}), collision_pairs.__file__
assert "_native" not in str(vars(collision_pairs)), "loaded before it was asked for"
assert CheckCollisionsRequest().gradient is False and collision_pairs.msg.CollisionPair.NEAR == 0
robot = collision_pairs.Robot({urdf!r}, srdf={srdf!r})
detector = collision_pairs.Detector(collision_pairs.Scene(robot))
print(collision_pairs.Verdict(detector.check([0.0] * len(robot.joints)).verdict).name)
"""


@pytest.mark.parametrize("space", ("devel", "install"))
def test_python_imports_module_and_messages(installed, space):
    """After `source devel/setup.bash`; of what is installed by Python's path, which a setup.bash there would say."""
    prefix = os.path.join(BUILD, "devel") if space == "devel" else str(installed)
    path = "source %s/setup.bash" % prefix if space == "devel" else "PYTHONPATH=%s/lib/python3/dist-packages" % prefix
    program = PYTHON_PROGRAM.format(place=prefix, urdf=DEMO + "/demo_robot.urdf", srdf=DEMO + "/demo_robot.srdf")
    done = subprocess.run(
        ["bash", "-c", path + "; export PYTHONPATH ROS_PACKAGE_PATH=%s:/usr/share; exec python3 -" % PROJECT],
        input=program, env={"PATH": "/usr/bin:/bin", "PYTHONDONTWRITEBYTECODE": "1"}, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert (done.stdout, done.returncode) == ("FREE\n", 0), done.stderr
    assert os.path.isfile(prefix + "/lib/python3/dist-packages/collision_pairs/__init__.pyi")


@pytest.mark.skipif("COLLISION_PAIRS_TOOLS" not in os.environ, reason="needs the build folder of scripts/test")
def test_a_copied_build_folder_is_recognised(tmp_path):
    copied = tmp_path / "build"
    copied.mkdir()
    with open(os.path.join(BUILD, "CMakeCache.txt")) as cache:
        (copied / "CMakeCache.txt").write_text(cache.read())
    (copied / "devel").mkdir()
    script = '. scripts/common.sh; BUILD=%s; build --target nothing || true' % copied
    done = subprocess.run(["bash", "-c", script], cwd=PROJECT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    assert "%s was built as %s and then copied" % (copied, BUILD) in done.stdout
    assert "is different than the directory" not in done.stdout, "what cmake says of a copied cache"


@pytest.mark.parametrize("name", sorted(n for n in os.listdir(os.path.join(PROJECT, "launch")) if n.endswith(".launch")))
def test_launch_files_are_sound(tmp_path, name):
    checker = "/usr/share/roslaunch/scripts/roslaunch-check"
    done = subprocess.run(["/usr/bin/python3", checker, "-i", os.path.join(PROJECT, "launch", name)],
                          env=dict(os.environ, ROS_TEST_RESULTS_DIR=str(tmp_path)), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    assert done.returncode == 0, done.stdout
