"""The velocity limiter on robots with mass, in MuJoCo (test/dynamics). Some seconds of the demo robot; with COLLISION_PAIRS_LONG
(scripts/test --long) minutes of all robots, sound and broken."""
import csv
import os
import subprocess

import pytest
import yaml
from conftest import PROJECT, TIMES_SLOWER, TOOLS

PROGRAM = os.path.join(TOOLS, "limiter_dynamics")
LONG = "COLLISION_PAIRS_LONG" in os.environ
ROBOTS = os.path.join(os.environ.get("COLLISION_PAIRS_SHARED", ""), "robots")
SLOPES = [5.0, 4.0, 6.0]  # rad/s^2, of the joints of a ramp in turn: mujoco_robot.cpp
LONGEST_DEAD_TIME = 0.02
LEAST_SHARE = 0.85  # of a slope
STOP_DISTANCE, SELF_STOP_DISTANCE, SLACK = 0.01, 0.002, 1e-4
pytestmark = pytest.mark.skipif(not os.path.exists(PROGRAM), reason="skipped: no MuJoCo (libmujoco-dev) when it was built")


def dynamics(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], timeout=(1500 if LONG else 300) * TIMES_SLOWER, text=True, check=True,
                          env=dict(os.environ, ROS_PACKAGE_PATH=ROBOTS + ":" + PROJECT + ":/usr/share"),
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    return list(csv.DictReader(line for line in done.stdout.splitlines() if not line.startswith("seed ")))


def assert_nothing_was_touched(rows):
    assert rows
    for row in rows:
        assert int(row["contacts"]) == 0, row
        assert float(row["nearest"]) >= STOP_DISTANCE - SLACK, row
        assert float(row["nearest_links"]) >= SELF_STOP_DISTANCE - SLACK, row


def test_a_robot_with_mass_touches_nothing():
    rows = dynamics("runs", 200) if LONG else dynamics("runs", 20, "demo")
    assert {row["servo"] for row in rows} == {"ramp", "PI"}
    assert_nothing_was_touched(rows)
    for row in rows:
        assert float(row["passed"]) > 0.05, row
        assert row["servo"] == "PI" or int(row["alarms"]) == 0, row


def test_its_servo_is_measured_on_the_safe_side_and_what_is_measured_keeps_it_from_contact(tmp_path):
    bag, out = tmp_path / "steps.bag", tmp_path / "limiter.yaml"
    dynamics("steps", bag, "demo", "ramp")
    joints = ["shoulder_pan", "shoulder_lift", "upper_arm_roll", "elbow_flex", "forearm_roll", "wrist_flex", "wrist_roll"]
    subprocess.run([os.path.join(TOOLS, "measure_stopping"), bag, "--joints", *joints, "--out", out], check=True,
                   stderr=subprocess.DEVNULL)
    limiter = yaml.safe_load(out.read_text())["velocity_limiter"]
    for i, joint in enumerate(joints):
        assert LEAST_SHARE * SLOPES[i % 3] <= limiter["deceleration"][joint] <= SLOPES[i % 3]
    assert LONGEST_DEAD_TIME <= limiter["reaction_time"] <= 1.15 * LONGEST_DEAD_TIME + 0.02
    assert_nothing_was_touched(dynamics("runs", 200 if LONG else 20, "demo", "ramp", out))


def test_goals_that_a_free_straight_way_leads_to_are_reached_in_little_more_time_than_without_limiter():
    rows = dynamics("goals", 40, "", "ramp") if LONG else dynamics("goals", 4, "demo", "ramp")
    assert_nothing_was_touched(rows)
    for row in rows:
        assert row["reached"] == row["goals"], row
        assert float(row["median"]) <= 1.15, row


@pytest.mark.skipif(not LONG, reason="skipped: minutes of broken robots (scripts/test --long)")
def test_what_is_wrong_is_noticed_before_contact():
    rows = dynamics("broken", 5)
    for row in rows:
        assert int(row["contacts_before"]) == 0, row
        if row["wrong"] == "nothing" and row["servo"] == "ramp":
            assert int(row["noticed"]) == 0, row
        if row["servo"] == "ramp" and (row["wrong"] in ("sags", "pushed") or (row["where"] == "free" and row["wrong"] != "nothing")):
            assert int(row["noticed"]) >= int(row["runs"]) - 1, row
