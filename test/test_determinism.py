"""The same scene, poses and settings give the same report to the last bit, whatever the processor's instructions and
the number of threads. Compared among the kernels of one build: other compilers and flags may round otherwise."""
import csv
import json
import os
import subprocess
import sys

import numpy as np
import pytest
from conftest import DEMO, PROJECT, PYTHON, SYSTEM_PATH, TIMES_SLOWER, TOOLS

INSTRUCTIONS_AND_THREADS = [("base", "3"), ("avx2", "1"), ("all", "3")]
SETTINGS = [{"alarm_distance": 0.2, "min_distance": True}, {"alarm_distance": 0.2, "fidelity": "convex"},
            {"alarm_distance": 0.1, "fidelity": "obb"}, {"alarm_distance": 0.1, "fidelity": "aabb"},
            {"alarm_distance": 0.1, "fidelity": "spheres"},
            {"alarm_distance": 0.0, "verdict_only": True}, {"alarm_distance": 0.05, "gradient": True}]
PROGRAM = """
import json, sys
import numpy as np
import collision_pairs as cp
urdf, srdf, threads, settings, out = sys.argv[1:]
robot = cp.Robot(urdf, srdf)
for narrow_phase in ("native", "fcl"):
    detector = cp.Detector(cp.Scene(robot, settings={"narrow_phase": narrow_phase}), threads=int(threads))
    lower, upper = np.clip(robot.limits.T, -3, 3)
    states = np.random.RandomState(7).uniform(lower, upper, (200, len(lower)))
    found = {}
    for i, its_settings in enumerate(json.loads(settings)):
        if narrow_phase == "fcl" and its_settings.get("fidelity") == "spheres":
            continue  # no narrow phase takes part, and it takes long to make the spheres
        result = detector.check(states, **its_settings)
        fields = {name: result.pairs[name] for name in result.pairs.dtype.names}
        fields.update(verdict=result.verdict, min_distance=result.min_distance)
        if "gradient" in its_settings:
            fields["gradient"] = result.gradient
        found.update(("%d %s" % (i, name), values) for name, values in fields.items())
    if narrow_phase == "native":  # so many that they are checked several at once
        many = np.random.RandomState(8).uniform(lower, upper, (40000, len(lower)))
        for fidelity in ("mesh", "spheres"):
            found["many at " + fidelity] = detector.check(many, verdict_only=True, fidelity=fidelity).verdict
    np.savez(out + narrow_phase, **found)
np.savetxt(out + "states.csv", states, delimiter=",", header=",".join(detector.joints), comments="", fmt="%.17g")
"""


def run(command, instructions):
    packages = ":".join([PROJECT, os.environ.get("COLLISION_PAIRS_SHARED", "") + "/robots", "/usr/share"])
    environment = dict(os.environ, ROS_PACKAGE_PATH=packages, PATH=SYSTEM_PATH, PYTHONPATH=PYTHON,
                       COLLISION_PAIRS_INSTRUCTION_SET=instructions)
    subprocess.run(command, env=environment, check=True, timeout=300 * TIMES_SLOWER, stderr=subprocess.DEVNULL)


def rows_without_times(path):
    with open(path) as lines:
        rows = list(csv.DictReader(lines))
    return repr([{name: value for name, value in row.items() if name != "microseconds"} for row in rows])


def report(robot, instructions, threads, folder):
    """{what: bytes}: all that is said of some hundred states, and of motions between the first of them."""
    urdf, srdf = robot
    folder.mkdir()
    run([sys.executable, "-c", PROGRAM, urdf, srdf, threads, json.dumps(SETTINGS), str(folder) + "/"], instructions)
    found = {}
    for narrow_phase in ("native", "fcl"):
        with np.load(folder / (narrow_phase + ".npz")) as arrays:
            found.update((narrow_phase + " " + name, arrays[name].tobytes()) for name in arrays)
    states, waypoints, table = folder / "states.csv", folder / "waypoints.csv", folder / "table.csv"
    run([os.path.join(TOOLS, "check_states"), urdf, "--srdf", srdf, "--states", states, "--alarm-distance", "0.2",
         "--min-distance", "--threads", threads, "--out", table], instructions)
    found["states"] = rows_without_times(table)
    waypoints.write_text("".join(states.read_text().splitlines(True)[:20]))
    run([os.path.join(TOOLS, "check_motion"), urdf, "--srdf", srdf, "--waypoints", waypoints, "--threads", threads,
         "--out", table], instructions)
    found["motions"] = rows_without_times(table)
    return found


def assert_the_same(robot, folder, ways=INSTRUCTIONS_AND_THREADS):
    expected = report(robot, "base", "1", folder / "expected")
    distances = np.frombuffer(expected["native 0 distance"])
    assert np.sum(distances < 0) > 50 and np.sum(distances > 0) > 50
    assert expected["native many at mesh"] != expected["native many at spheres"]
    for instructions, threads in ways:
        found = report(robot, instructions, threads, folder / (instructions + threads))
        differ = [name for name in expected if found[name] != expected[name]]
        assert not differ, "%s with %s threads differs from base in %s" % (instructions, threads, differ)


def test_reports_of_the_demo_robot_are_the_same_to_the_last_bit(tmp_path):
    assert_the_same([os.path.join(DEMO, "demo_robot." + kind) for kind in ("urdf", "srdf")], tmp_path,
                    INSTRUCTIONS_AND_THREADS + [("all", "1")])


@pytest.mark.parametrize("model, robot", [("panda_model", "panda"), ("ur_model", "ur5"), ("pr2_model", "pr2")])
def test_reports_of_real_robots_are_the_same_to_the_last_bit(shared, tmp_path, model, robot):
    folder = os.path.join(shared, "robots", model)
    assert_the_same([os.path.join(folder, kind, robot + "." + kind) for kind in ("urdf", "srdf")], tmp_path)
