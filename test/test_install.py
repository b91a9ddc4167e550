"""What is installed is whole: the tools run from there, and a stranger's program compiles against it."""
import os
import subprocess

import pytest
from conftest import DEMO, PROJECT, TOOLS

BUILD = os.path.dirname(os.path.dirname(os.path.dirname(TOOLS)))

CONSUMER = r"""
#include <collision_pairs/collision_detector.h>
#include <collision_pairs/input_error.h>
#include <iostream>

int main() {
  using namespace collision_pairs;
  const auto robot = RobotModel::fromUrdf(
      "<robot name='r'><link name='a'><collision><geometry><sphere radius='1'/></geometry></collision></link>"
      "<link name='b'><collision><geometry><box size='1 1 1'/></geometry></collision></link>"
      "<link name='frame'/>"
      "<joint name='j1' type='fixed'><parent link='frame'/><child link='a'/></joint>"
      "<joint name='j2' type='fixed'><parent link='frame'/><child link='b'/><origin xyz='3 0 0'/></joint></robot>",
      [](const std::string&, const Eigen::Vector3d&) -> std::shared_ptr<const TriangleMesh> { throw InputError("none"); });
  const auto scene = CollisionScene::build(robot, std::nullopt, nullptr);
  CollisionDetector detector(scene);
  std::vector<Eigen::Isometry3d> X_RB;
  robot->forwardKinematics(robot->zeroPositions(), X_RB);
  BodyPoses poses;
  scene->gatherPoses(X_RB, poses);
  CheckSettings settings;
  settings.min_distance = true;
  std::cout << detector.detect(poses, settings).min_distance << "\n";
}
"""


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


def test_the_installed_tool_runs(installed, tmp_path):
    states = tmp_path / "states.csv"
    states.write_text("shoulder_pan\n0\n")
    done = subprocess.run(
        [installed / "lib/collision_pairs/check_states", DEMO + "/demo_robot.urdf", "--srdf",
         DEMO + "/demo_robot.srdf", "--states", states],
        env=dict(os.environ, LD_LIBRARY_PATH=str(installed / "lib"), ROS_PACKAGE_PATH=PROJECT + ":/usr/share"),
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[1].startswith("0,0,")


def test_a_program_compiles_against_the_installed_headers_without_ros(installed, tmp_path):
    (tmp_path / "consumer.cpp").write_text(CONSUMER)
    subprocess.run(["g++", "-std=c++17", "-Wall", "-Werror", "-I", installed / "include", "-isystem",
                    "/usr/include/eigen3", tmp_path / "consumer.cpp", "-o", tmp_path / "consumer", "-L",
                    installed / "lib", "-lcollision_pairs"], check=True)
    done = subprocess.run([tmp_path / "consumer"], check=True, stdout=subprocess.PIPE, text=True,
                          env=dict(os.environ, LD_LIBRARY_PATH=str(installed / "lib")))
    assert float(done.stdout) == pytest.approx(1.5, abs=1e-12)


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


@pytest.mark.parametrize("name", sorted(n for n in os.listdir(os.path.join(PROJECT, "launch")) if n.endswith(".launch")))
def test_launch_files_are_sound(tmp_path, name):
    checker = "/usr/share/roslaunch/scripts/roslaunch-check"
    done = subprocess.run(["/usr/bin/python3", checker, "-i", os.path.join(PROJECT, "launch", name)],
                          env=dict(os.environ, ROS_TEST_RESULTS_DIR=str(tmp_path)), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    assert done.returncode == 0, done.stdout
