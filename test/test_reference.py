"""Panda, UR5 and PR2 against verdicts that were made by exact means, 500 states each.

The data are not part of this package: COLLISION_PAIRS_SHARED names their folder.
"""
import os

import numpy as np
import pytest
from conftest import rows_of

import collision_pairs as cp

MODELS = {"panda": "panda_model", "ur5": "ur_model", "pr2": "pr2_model"}
# This one pair stands within 1e-7 m of touching: no verdict of it is wrong.
UNDECIDED = {("pr2", "55"): {"l_wrist_flex_link|r_gripper_motor_accelerometer_link"}}


def pair_set(text):
    return set(filter(None, text.split(";")))


def check(run_tool, shared, tmp_path, robot, *options):
    model = os.path.join(shared, "robots", MODELS[robot])
    out = tmp_path / "out.csv"
    done = run_tool("check_states", "%s/urdf/%s.urdf" % (model, robot), "--srdf",
                    "%s/srdf/%s.srdf" % (model, robot), "--states",
                    "%s/reference/joints_%s.csv" % (shared, robot), "--out", out, *options,
                    packages=os.path.join(shared, "robots"))
    assert done.returncode == 0, done.stderr
    reference = rows_of("%s/reference/reference_%s.csv" % (shared, robot))
    found = rows_of(out)
    assert len(found) == len(reference) == 500
    return zip(found, reference)


def differing(robot, state, found, expected):
    return (found ^ expected) - UNDECIDED.get((robot, state), set())


@pytest.mark.parametrize("narrow_phase", ["native", "fcl"])
@pytest.mark.parametrize("robot", MODELS)
def test_self_pairs_and_distances_are_the_references(run_tool, shared, tmp_path, robot, narrow_phase):
    for found, expected in check(run_tool, shared, tmp_path, robot, "--min-distance", "--narrow-phase", narrow_phase):
        state = expected["state"]
        assert not differing(robot, state, pair_set(found["pairs"]), pair_set(expected["self_pairs"])), state
        if not expected["self_pairs"]:
            assert abs(float(found["min_distance"]) - float(expected["self_distance"])) < 1e-6, state


@pytest.mark.parametrize("narrow_phase", ["native", "fcl"])
@pytest.mark.parametrize("robot", MODELS)
def test_world_pairs_and_distances_are_the_references(run_tool, shared, tmp_path, robot, narrow_phase):
    world = "%s/robots/world_model/urdf/world_%s.urdf" % (shared, robot)
    options = ("--world", world, "--min-distance", "--narrow-phase", narrow_phase)
    for found, expected in check(run_tool, shared, tmp_path, robot, *options):
        pairs = pair_set(expected["self_pairs"]) | pair_set(expected["world_pairs"])
        if not pairs:
            distance = min(float(expected["self_distance"]), float(expected["world_distance"]))
            assert abs(float(found["min_distance"]) - distance) < 1e-6, expected["state"]
        assert not differing(robot, expected["state"], pair_set(found["pairs"]), pairs), expected["state"]


@pytest.mark.parametrize("robot", MODELS)
def test_python_gives_the_references(monkeypatch, shared, robot):
    monkeypatch.setenv("ROS_PACKAGE_PATH", os.path.join(shared, "robots") + ":/usr/share")
    model = os.path.join(shared, "robots", MODELS[robot])
    checked = cp.Robot("%s/urdf/%s.urdf" % (model, robot), srdf="%s/srdf/%s.srdf" % (model, robot))
    world = cp.Robot("%s/robots/world_model/urdf/world_%s.urdf" % (shared, robot))
    rows = rows_of("%s/reference/joints_%s.csv" % (shared, robot))
    states = np.array([list(row.values()) for row in rows], float)
    reference = rows_of("%s/reference/reference_%s.csv" % (shared, robot))
    assert len(states) == len(reference) == 500
    for scene, columns in ((cp.Scene(checked), ["self_pairs"]),
                           (cp.Scene(checked, world=world), ["self_pairs", "world_pairs"])):
        result = cp.Detector(scene).check(states, list(rows[0]), min_distance=True)
        found = [set() for _ in states]
        for pair in result.pairs[result.pairs["state"] == cp.PairState.CONTACT]:
            found[pair["row"]].add("%s|%s" % (result.models[pair["first"]], result.models[pair["second"]]))
        for i, expected in enumerate(reference):
            pairs = set().union(*(pair_set(expected[column]) for column in columns))
            assert not differing(robot, expected["state"], found[i], pairs), expected["state"]
            assert result.verdict[i] == (cp.Verdict.COLLISION if found[i] else cp.Verdict.FREE), expected["state"]
            if not pairs and columns == ["self_pairs"]:
                assert abs(result.min_distance[i] - float(expected["self_distance"])) < 1e-6, expected["state"]
