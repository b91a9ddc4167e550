"""Panda, UR5 and PR2 against verdicts that were made by exact means, 500 states each, and the Panda in the scenes of a
benchmark of motion planners against verdicts that FCL gave.

The data are not part of this package: COLLISION_PAIRS_SHARED names their folder.
"""
import json
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


def turned(quaternion_xyzw, translation):
    x, y, z, w = quaternion_xyzw / np.linalg.norm(quaternion_xyzw)
    pose = np.eye(4)
    pose[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                    [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                    [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    pose[:3, 3] = translation
    return pose


def object_of(given):
    is_box = given["type"] == "box"
    shape = cp.Box(given["size"]) if is_box else cp.Cylinder(given["radius"], given["height"])
    return cp.RigidObject(given["id"], [shape], pose=turned(np.array(given["quat_xyzw"]), given["xyz"]))


@pytest.mark.parametrize("rules_in", ["srdf", "settings"])
def test_pairs_in_the_scenes_of_a_planning_benchmark_are_the_references(monkeypatch, shared, rules_in):
    """Borderline pairs are those that meet if the objects grow by a millimetre, a corner by the root of three of them."""
    monkeypatch.setenv("ROS_PACKAGE_PATH", os.path.join(shared, "robots") + ":/usr/share")
    problems, reference = (json.load(open("%s/problems/panda%s.json" % (shared, end))) for end in ("", "_reference"))
    model = os.path.join(shared, "robots/panda_model")
    srdf = "%s/srdf/panda.srdf" % model if rules_in == "srdf" else None
    allowed = [{"allow": ["panda_*", "panda_*"]}]  # also links that hang together, which always meet
    settings = {} if srdf else {"pair_rules": allowed + [{"deny": pair} for pair in problems["allowed_pairs"]]}
    robot = cp.Robot("%s/urdf/panda.urdf" % model, srdf=srdf)
    others = problems["other_joints"]
    names, grown = problems["joints"] + list(others), 0.001
    scene = cp.Scene(robot, settings=settings)
    totals, nb_near = np.zeros(3, int), {True: 0, False: 0}
    for i, problem in enumerate(problems["problems"]):
        detector = cp.Detector(scene.with_objects([object_of(given) for given in problem["objects"]]))
        line = np.linspace(problem["start"], problem["goal"], reference["steps"] + 1)
        states = np.hstack([line, np.tile(list(others.values()), (len(line), 1))])
        result = detector.check(states, names, alarm_distance=3 * grown)
        contacts, near = ([{} for _ in line] for _ in range(2))
        for pair in result.pairs:
            of_state = contacts if pair["state"] == cp.PairState.CONTACT else near
            name = tuple(sorted((result.models[pair["first"]], result.models[pair["second"]])))
            of_state[pair["row"]][name] = pair["distance"]
        for k in range(len(line)):
            expected = {kind: {tuple(sorted(pair)) for pair in pairs}
                        for kind, pairs in reference["results"].get("%d:%d" % (i, k), {}).items()}
            meeting = expected.get("env", set()) | expected.get("self", set())
            assert set(contacts[k]) == meeting, (i, k)  # borderline pairs included: none is within 5 um of touching
            assert result.verdict[k] == (cp.Verdict.COLLISION if meeting else cp.Verdict.FREE), (i, k)
            totals += (1, bool(meeting), len(meeting))
            borderline = expected.get("borderline", set())
            assert borderline <= set(near[k]) | set(contacts[k]), (i, k)
            for pair, distance in near[k].items():
                nb_near[pair in borderline] += 1
                assert distance <= 3 ** 0.5 * grown if pair in borderline else distance > grown, (i, k, pair)
    of_reference = reference["totals"]
    assert tuple(totals) == (of_reference["configs"], of_reference["colliding"],
                             of_reference["env_pairs"] + of_reference["self_pairs"])
    assert all(nb_near.values()), nb_near
