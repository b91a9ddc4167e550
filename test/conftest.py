"""What the Python tests share: where the tools are, a small robot, the reference data."""
import os
import subprocess

import pytest

PROJECT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
TOOLS = os.environ.get("COLLISION_PAIRS_TOOLS", os.path.join(PROJECT, "build/devel/lib/collision_pairs"))
DEMO = os.path.join(PROJECT, "config/demo")


@pytest.fixture
def run_tool():
    """Runs a tool of the package; returns the finished process."""
    def run(name, *arguments, packages=PROJECT):
        return subprocess.run([os.path.join(TOOLS, name), *map(str, arguments)], timeout=120,
                              env=dict(os.environ, ROS_PACKAGE_PATH=packages + ":/usr/share"),
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    return run


@pytest.fixture
def shared():
    """The folder with real robots and true verdicts; the test is skipped where it is absent."""
    folder = os.environ.get("COLLISION_PAIRS_SHARED", "")
    if not os.path.isdir(os.path.join(folder, "reference")):
        pytest.skip("no reference data; COLLISION_PAIRS_SHARED names its folder")
    return folder
