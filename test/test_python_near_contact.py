"""A hair before contact Python has one answer: batch or single, verdict or report, padded, tolerant or by FCL, as C++ has
(test_near_contact.cpp)."""
import random
import warnings

import numpy as np
from conftest import DEMO
from seed import given_seed

import collision_pairs as cp

NEAR, REACH = 1e-4, 1e-3  # m
# m; what two answers may differ by (docs/accuracy.md): cylinders of this size, and FCL
SLACK, SLACK_OF_FCL = 1e-9, 2e-7


def random_chain(draw):
    """The URDF of six links in a row, each a random primitive askew in its link, about random axes."""
    def three(low, high):
        return "%.9g %.9g %.9g" % tuple(draw.uniform(low, high) for _ in range(3))
    shapes = [lambda: '<box size="%s"/>' % three(0.05, 0.4),
              lambda: '<sphere radius="%.9g"/>' % draw.uniform(0.05, 0.2),
              lambda: '<cylinder radius="%.9g" length="%.9g"/>' % (draw.uniform(0.05, 0.2), draw.uniform(0.1, 0.5))]
    xml = '<robot name="chain">'
    for i in range(6):
        xml += ('<link name="link_%d"><collision><origin xyz="%s" rpy="%s"/><geometry>%s</geometry></collision></link>'
                % (i, three(-0.2, 0.2), three(-3, 3), draw.choice(shapes)()))
        if i:
            xml += ('<joint name="joint_%d" type="continuous"><parent link="link_%d"/><child link="link_%d"/>'
                    '<origin xyz="%s" rpy="%s"/><axis xyz="%s"/></joint>' % (i, i - 1, i, three(-0.3, 0.3), three(-3, 3), three(0.1, 1)))
    return xml + "</robot>"


def near_contact(detector, robot, draw, pairs):
    """States from free ones towards ones in contact, a hair before it."""
    numbers = np.random.default_rng(draw.randrange(2 ** 32))
    lower, upper = np.clip(np.array(robot.limits), -3.0, 3.0).T
    drawn = numbers.uniform(lower, upper, (20 * pairs, len(robot.joints)))
    hit = detector.check(drawn, robot.joints, verdict_only=True).in_collision
    count = min(pairs, hit.sum(), (~hit).sum())
    start, free, contact = drawn[~hit][:count], drawn[~hit][:count].copy(), drawn[hit][:count].copy()
    for _ in range(50):
        middle = 0.5 * (free + contact)
        hit = detector.check(middle, robot.joints, verdict_only=True).in_collision
        free[~hit], contact[hit] = middle[~hit], middle[hit]
    return np.concatenate([free, contact] + [free + (start - free) * 10 ** numbers.uniform(-9.0, -3.0, (count, 1)) for _ in range(3)])


def found_in(result):
    return {(int(p["row"]), str(result.models[p["first"]]), str(result.models[p["second"]])): p for p in result.pairs}


def expect_one_answer(robot, draw, pairs):
    def detector(threads=2, **settings):
        return cp.Detector(cp.Scene(robot, settings=settings), threads=threads)
    native = detector()
    states = near_contact(native, robot, draw, pairs)
    verdict = native.check(states, robot.joints, verdict_only=True).verdict
    report = native.check(states, robot.joints, alarm_distance=REACH)
    pairs_of_report = found_in(report)
    near = {key: pair for key, pair in pairs_of_report.items() if pair["distance"] < NEAR}
    np.testing.assert_array_equal(report.verdict, verdict)
    for state, expected in list(zip(states, verdict))[::7]:
        for way in ({"verdict_only": True}, {"alarm_distance": REACH}, {"alarm_distance": 0.0, "min_distance": True}):
            assert native.check(state, robot.joints, **way).verdict == expected, way
    least = native.check(states, robot.joints, alarm_distance=0.0, min_distance=True)
    np.testing.assert_array_equal(least.verdict, verdict)
    np.testing.assert_array_equal(least.min_distance <= 0.0, verdict == cp.Verdict.COLLISION)
    others = [(native, {"tolerance": 1e-9}, SLACK + 1e-9), (native, {"min_distance": True}, 0.0),
              (native, {"time_budget": 1e6}, 0.0), (detector(threads=1), {}, 0.0),
              (detector(narrow_phase="fcl"), {}, SLACK_OF_FCL)]
    for other, options, slack in others:
        pairs_of_other = found_in(other.check(states, robot.joints, alarm_distance=REACH, **options))
        for key, pair in near.items():
            assert key in pairs_of_other, (key, pair["distance"], options)
            if pair["distance"] > slack:
                assert abs(pairs_of_other[key]["distance"] - pair["distance"]) <= slack, (key, options)
                assert pairs_of_other[key]["state"] == pair["state"]
    for method in ("native", "fcl"):
        padded = detector(padding=0.005, narrow_phase=method)
        found = found_in(padded.check(states, robot.joints, alarm_distance=REACH))
        only = padded.check(states, robot.joints, verdict_only=True).verdict
        for key in pairs_of_report:
            assert found[key]["state"] == cp.PairState.CONTACT and only[key[0]] == cp.Verdict.COLLISION, (key, method)
    return len(near)


def test_a_hair_before_contact_every_way_to_ask_python_has_one_answer():
    draw = random.Random(given_seed())
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        count = expect_one_answer(cp.Robot(DEMO + "/demo_robot.urdf", srdf=DEMO + "/demo_robot.srdf"), draw, 60)
        for _ in range(5):
            count += expect_one_answer(cp.Robot(random_chain(draw)), draw, 60)
    print(count, "near pairs")
    assert count > 500
