"""A full disk, a device, a folder where a file should be: no tool says that all is well, or leaves half a file."""
import os
import resource
import signal
import subprocess

import pytest
from conftest import DEMO, PROJECT, SYSTEM_PATH, TOOLS
from step_recording import JOINTS, write_steps

URDF, SRDF, BAG = (os.path.join(DEMO, name) for name in ("demo_robot.urdf", "demo_robot.srdf", "demo.bag"))
MOST_BYTES = 200  # of a file, as if the disk were full then


@pytest.fixture
def command(run_tool, tmp_path):
    """By tool: arguments with which it has something to write."""
    states, table = tmp_path / "states.csv", tmp_path / "table.csv"
    with open(os.path.join(DEMO, "motion.csv")) as lines:
        states.write_text("".join(lines.readlines()[:12]))
    assert run_tool("check_bag", BAG, "--out", table).returncode == 0
    return {"check_states": [URDF, "--srdf", SRDF, "--states", states],
            "check_motion": [URDF, "--srdf", SRDF, "--waypoints", states],
            "generate_srdf": [URDF, "--samples", "10", "--searches", "0"],
            "check_bag": [BAG],
            "measure_stopping": [write_steps(tmp_path / "steps.bag", shares=(1.0, 0.0)), "--joints", *JOINTS],
            "merge_bag_checks": [table]}


def run(name, arguments, **options):
    return subprocess.run([os.path.join(TOOLS, name), *map(str, arguments)], timeout=120, text=True,
                          env=dict(os.environ, ROS_PACKAGE_PATH=PROJECT + ":/usr/share", PATH=SYSTEM_PATH),
                          stderr=subprocess.PIPE, **options)


def assert_refused(done, *words):
    errors = [line for line in done.stderr.splitlines() if line.startswith("error: ")]
    assert done.returncode == 2 and len(errors) == 1, done.stderr
    assert "Traceback" not in done.stderr
    for word in words:
        assert word in errors[0]


ALL_TOOLS = ["check_states", "check_motion", "generate_srdf", "check_bag", "measure_stopping", "merge_bag_checks"]
OUTPUTS = [(name, "--out") for name in ALL_TOOLS] + [("generate_srdf", "--report"), ("check_bag", "--record"),
                                                      ("check_bag", "--report"), ("merge_bag_checks", "--report"), ("measure_stopping", "--plot")]


@pytest.mark.parametrize("name", ALL_TOOLS)
def test_standard_output_on_a_full_disk_is_an_error(command, name):
    with open("/dev/full", "w") as full:
        assert_refused(run(name, command[name], stdout=full), "standard output", "disk full?")


def test_a_summary_that_cannot_be_printed_is_an_error(command, tmp_path):
    with open("/dev/full", "w") as full:
        done = run("check_bag", command["check_bag"] + ["--out", tmp_path / "out.csv"], stdout=full)
    assert_refused(done, "standard output")


@pytest.mark.parametrize("name, option", OUTPUTS)
def test_a_disk_that_gets_full_leaves_no_file_behind(command, tmp_path, name, option):
    def little_room():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (MOST_BYTES, MOST_BYTES))
    folder = tmp_path / "out"
    folder.mkdir()
    done = run(name, command[name] + [option, folder / "target"], stdout=subprocess.DEVNULL, preexec_fn=little_room)
    assert_refused(done, "target")
    assert list(folder.iterdir()) == []


@pytest.mark.parametrize("name, option", OUTPUTS)
def test_a_folder_or_a_device_is_not_replaced(command, tmp_path, name, option):
    folder = tmp_path / "folder"
    folder.mkdir()
    target = folder if option != "--report" or name == "generate_srdf" else folder / "index.html"
    target.mkdir(exist_ok=True)
    at = folder if option == "--report" and name != "generate_srdf" else target
    assert_refused(run(name, command[name] + [option, at], stdout=subprocess.DEVNULL))
    assert target.is_dir() and [path.name for path in folder.iterdir()] in ([], ["index.html"])
    device = tmp_path / "device"  # a pipe would do for a device, but for who waits at its other end
    device.symlink_to("/dev/full")
    assert_refused(run(name, command[name] + [option, device], stdout=subprocess.DEVNULL), "device")
    assert device.is_symlink() and os.readlink(device) == "/dev/full" and not os.path.isfile("/dev/full")
    assert sorted(path.name for path in tmp_path.iterdir() if "part" in path.name) == []
