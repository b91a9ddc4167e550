#!/usr/bin/python3
"""Checks a million random joint states: check_million_states.py [ROBOT.urdf [ROBOT.srdf]]"""
import sys
import time

import numpy as np

import collision_pairs as cp

DEMO = "/../config/demo/demo_robot"
urdf = sys.argv[1] if len(sys.argv) > 1 else sys.path[0] + DEMO + ".urdf"
srdf = sys.argv[2] if len(sys.argv) > 2 else None if len(sys.argv) > 1 else sys.path[0] + DEMO + ".srdf"
robot = cp.Robot(urdf, srdf)
lower, upper = np.clip(robot.limits, -np.pi, np.pi).T
states = np.random.default_rng(1).uniform(lower, upper, (1000000, len(robot.joints)))

begin = time.perf_counter()
result = cp.Detector(cp.Scene(robot)).check(states, robot.joints, verdict_only=True)
seconds = time.perf_counter() - begin
print("%d of %d states collide; %.2f µs a state" % (result.in_collision.sum(), len(states), 1e6 * seconds / len(states)))
