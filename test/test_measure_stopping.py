"""measure_stopping: a bag in, the parameters of the velocity limiter out; drive_steps, which moves a robot for such a bag."""
import math
import os

import pytest
import yaml
from conftest import PROJECT
from step_recording import DEAD_TIME, JOINTS, SLOPES, as_trajectory, write_steps


@pytest.fixture
def record(tmp_path):
    return lambda **options: write_steps(tmp_path / "steps.bag", **options)


@pytest.fixture
def measure(run_tool, tmp_path):
    """The written parameters, and what was said."""
    def run(bag, *options):
        out = tmp_path / "limiter.yaml"
        done = run_tool("measure_stopping", bag, "--out", out, *options)
        assert done.returncode == 0, done.stderr
        return yaml.safe_load(out.read_text()), done.stderr
    return run


def keys_of_the_limiter():
    with open(os.path.join(PROJECT, "docs/data/public_names.txt")) as names:
        return {line.split("/")[1].strip() for line in names if line.startswith("parameter ~velocity_limiter/")}


def assert_on_the_safe_side(found):
    limiter = found["velocity_limiter"]
    assert list(found) == ["velocity_limiter"] and set(limiter) <= keys_of_the_limiter()
    assert {"command", "joints", "deceleration", "reaction_time"} <= set(limiter)
    assert limiter["joints"] == JOINTS and list(limiter["deceleration"]) == JOINTS
    assert DEAD_TIME <= limiter["reaction_time"] <= 1.15 * DEAD_TIME + 0.02
    for name, slope in zip(JOINTS, SLOPES):
        assert 0.85 * slope <= limiter["deceleration"][name] <= slope


def test_the_parameters_of_an_array_are_what_the_limiter_reads(record, measure):
    found, said = measure(record(), "--joints", *JOINTS)
    assert_on_the_safe_side(found)
    assert found["velocity_limiter"]["command_type"] == "std_msgs/Float64MultiArray"
    assert found["velocity_limiter"]["command"] == "/jog" and found["velocity_limiter"]["joint_states"] == "/joint_states"
    assert said == ""


def test_a_trajectory_names_its_joints(record, measure):
    bag = record(make=as_trajectory)
    found, _ = measure(bag, "--joints", *JOINTS)
    assert_on_the_safe_side(found)
    assert found["velocity_limiter"]["command_type"] == "trajectory_msgs/JointTrajectory"
    assert measure(bag)[0]["velocity_limiter"]["joints"] == JOINTS[::-1]


def test_no_trajectory_takes_longer_than_the_reaction_time_since_the_limiter_refuses_it(record, measure):
    bag = record(make=lambda names, velocities: as_trajectory(names, velocities, 0.2))
    assert measure(bag, "--joints", *JOINTS)[0]["velocity_limiter"]["reaction_time"] == 0.2


def test_stamps_that_are_ahead_count_when_they_arrive(record, measure):
    found, said = measure(record(ahead=0.1, latency=0.015), "--joints", *JOINTS)
    assert 0.075 <= found["velocity_limiter"]["reaction_time"] <= 1.15 * 0.075 + 0.02  # with the latency
    assert "stamped up to 85 ms after their arrival" in said


@pytest.mark.parametrize("options, says", [
    ({"change": lambda lift, tilt: setattr(lift, "most", 0.4)}, "'lift': at a command of 0.6 it moves at 0.4"),
    ({"change": lambda lift, tilt: setattr(tilt, "drift", -0.01)}, "'tilt': it drifts at 0.01 at zero command"),
    ({"latency": 0.09}, "'lift': joint states arrive up to 90 ms after their stamp"),
    ({"couple": 0.05}, "'tilt': it moves by 0.03 at zero command when joint 'lift' does"),
    ({"period": 0.05, "velocity": 0.1}, "'tilt': its slope is between")])
def test_what_the_limiter_does_not_assume_is_said_and_written(record, measure, tmp_path, options, says):
    _, said = measure(record(**options), "--joints", *JOINTS)
    assert says in said, said
    assert "# warning: " in (tmp_path / "limiter.yaml").read_text()


def test_joint_states_are_read_as_robot_state_publisher_does(record, measure, tmp_path):
    found, said = measure(record(uneven=50), "--joints", *JOINTS)
    assert_on_the_safe_side(found)
    lost = [line for line in (tmp_path / "limiter.yaml").read_text().splitlines() if line.startswith("# warning: ")]
    assert len(lost) == 1 and "positions" in lost[0] and lost[0][len("# warning: "):].strip('"') in said


def test_too_few_steps_are_said(record, measure):
    _, said = measure(record(shares=(1.0, 0.0)), "--joints", *JOINTS)
    assert said.count("too few steps: it slows down 1 times, at least 4 are needed") == 2
    assert said.count("all steps are of one size") == 2


@pytest.mark.parametrize("options, arguments, says", [
    ({"topics": (None, "/joint_states")}, JOINTS, "no velocity commands in it"),
    ({"topics": ("/jog", None)}, JOINTS, "no joint states"),
    ({}, ["lift", "tilted"], "no joint 'tilted'; did you mean 'tilt'?"),
    ({}, ["lift"], "a command has 2 numbers, but 1 joints are named"),
    ({}, [], "--joints must name the joints in the order of the command"),
    ({"make": as_trajectory}, ["lift"], "but 1 joints are limited"),
    ({}, JOINTS + ["--command", "jogged"], "--command jogged: the bag has /jog"),
    ({}, JOINTS + ["--joint-states", "states"], "--joint-states states: the bag has /joint_states"),
    ({"velocity": 0.0}, JOINTS, "joint 'lift' has no step of its command"),
    ({"velocity": math.nan}, JOINTS, "a command is not finite")])
def test_wrong_input_is_refused_in_one_line_without_a_file(run_tool, record, tmp_path, options, arguments, says):
    bag, out, plot = record(**options), tmp_path / "out.yaml", tmp_path / "out.png"
    words = ["--joints"] * bool(arguments) + arguments
    done = run_tool("measure_stopping", bag, "--out", out, "--plot", plot, *words)
    errors = done.stderr.splitlines()
    assert done.returncode == 2 and len(errors) == 1 and says in errors[0] and str(bag) in errors[0], done.stderr
    assert done.stdout == "" and [path.name for path in tmp_path.iterdir()] == [bag.name]


def test_a_bag_that_is_missing_or_none_is_refused(run_tool, tmp_path):
    none = tmp_path / "none.bag"
    for content, says in ((None, "there is no such file"), (b"text", "is not a ROS bag")):
        if content:
            none.write_bytes(content)
        done = run_tool("measure_stopping", none, "--joints", *JOINTS, "--out", tmp_path / "out.yaml")
        assert done.returncode == 2 and len(done.stderr.splitlines()) == 1 and str(none) in done.stderr, done.stderr
        assert not (tmp_path / "out.yaml").exists()


def test_names_of_joints_cannot_break_the_file(record, measure):
    strange = ['li"ft: [\n', "tilt # \\"]
    found, said = measure(record(names=strange, couple=0.05), "--joints", *strange)
    assert list(found["velocity_limiter"]["deceleration"]) == strange and "it moves by" in said


def test_the_picture_is_drawn_beside_the_parameters(record, measure, tmp_path):
    picture = tmp_path / "steps.png"
    measure(record(), "--joints", *JOINTS, "--plot", picture)
    assert picture.read_bytes().startswith(b"\x89PNG") and picture.stat().st_size > 20000
    assert sorted(path.name for path in tmp_path.iterdir()) == ["limiter.yaml", "steps.bag", "steps.png"]
