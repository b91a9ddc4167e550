#!/usr/bin/python3
"""The problems of a benchmark of motion planners: every scene through update_scene, every configuration
through check_collisions, against verdicts that FCL gave.

The data are not part of this package: COLLISION_PAIRS_SHARED names their folder.
"""
import json
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
from sensor_msgs.msg import JointState
from shape_msgs.msg import SolidPrimitive
from std_srvs.srv import Trigger

from collision_pairs.msg import CollisionPair, SceneChange
from collision_pairs.srv import CheckCollisions, UpdateScene
from node_client import PATIENCE
from skipping_runner import run_or_skip

SHARED = os.environ.get("COLLISION_PAIRS_SHARED", "")
NODE = "/panda"


def text_of(*path):
    with open(os.path.join(SHARED, *path)) as file:
        return file.read()


def added(given):
    """The change that adds an object as the problem file describes it."""
    change = SceneChange(operation=SceneChange.ADD)
    change.object.name = given["id"]
    position, orientation = change.object.pose.position, change.object.pose.orientation
    position.x, position.y, position.z = given["xyz"]
    orientation.x, orientation.y, orientation.z, orientation.w = given["quat_xyzw"]
    if given["type"] == "box":
        primitive = SolidPrimitive(type=SolidPrimitive.BOX, dimensions=given["size"])
    else:
        primitive = SolidPrimitive(type=SolidPrimitive.CYLINDER, dimensions=[given["height"], given["radius"]])
    change.object.primitives = [primitive]
    return change


def on_the_line(start, goal, nb_steps):
    for k in range(nb_steps + 1):
        yield [a + (b - a) * k / nb_steps for a, b in zip(start, goal)]


def pairs_in(lists):
    return {tuple(sorted(pair)) for pair in lists}


class Answer:
    """What one configuration gave, and what it should."""

    def __init__(self, key, result, expected):
        self.key, self.result = key, result
        by_state = {CollisionPair.NEAR: {}, CollisionPair.CONTACT: {}, CollisionPair.UNRESOLVED: {}}
        for pair in result.pairs:
            by_state[pair.state][pair.first_link, pair.second_link] = pair.distance
        self.near, self.contacts, self.unresolved = by_state.values()
        self.expected_contacts = pairs_in(expected.get("env", []) + expected.get("self", []))
        self.borderline = pairs_in(expected.get("borderline", []))


class PandaProblemsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.problems = json.loads(text_of("problems", "panda.json"))
        cls.reference = json.loads(text_of("problems", "panda_reference.json"))
        rospy.set_param("/robot_description", text_of("robots", "panda_model", "urdf", "panda.urdf"))
        for service in ("reset", "update_scene", "check_collisions"):
            rospy.wait_for_service(NODE + "/" + service, PATIENCE)
        cls.reset = rospy.ServiceProxy(NODE + "/reset", Trigger)
        cls.update = rospy.ServiceProxy(NODE + "/update_scene", UpdateScene, persistent=True)
        cls.check = rospy.ServiceProxy(NODE + "/check_collisions", CheckCollisions, persistent=True)

    def load(self, srdf, pair_rules):
        rospy.set_param("/robot_description_semantic", srdf)
        rospy.set_param(NODE + "/pair_rules", pair_rules)
        reply = self.reset()
        self.assertTrue(reply.success, reply.message)

    def answers(self, alarm_distance):
        others = self.problems["other_joints"]
        names = self.problems["joints"] + list(others)
        for i, problem in enumerate(self.problems["problems"]):
            changes = [SceneChange(operation=SceneChange.CLEAR)] + [added(given) for given in problem["objects"]]
            reply = self.update(changes=changes)
            self.assertTrue(reply.success, reply.message)
            self.assertEqual([o.name for o in reply.objects], sorted(given["id"] for given in problem["objects"]))
            line = on_the_line(problem["start"], problem["goal"], self.reference["steps"])
            for k, positions in enumerate(line):
                state = JointState(name=names, position=positions + list(others.values()))
                reply = self.check(joint_state=state, alarm_distance=alarm_distance)
                self.assertTrue(reply.success, reply.message)
                key = "%d:%d" % (i, k)
                yield Answer(key, reply.result, self.reference["results"].get(key, {}))

    def assert_verdicts_are_the_references(self):
        nb_configurations = nb_colliding = nb_pairs = 0
        differences = []
        for answer in self.answers(alarm_distance=-1.0):
            nb_configurations += 1
            nb_colliding += answer.result.in_collision
            nb_pairs += len(answer.contacts)
            self.assertEqual((answer.near, answer.unresolved, answer.result.left_out), ({}, {}, []), answer.key)
            self.assertEqual(answer.result.in_collision, bool(answer.contacts), answer.key)
            differences += [(answer.key, pair) for pair in set(answer.contacts) ^ answer.expected_contacts]
        # Borderline pairs included: none is within 5 µm of touching, and no object is inside a link.
        self.assertEqual(differences, [])
        totals = self.reference["totals"]
        self.assertEqual((nb_configurations, nb_colliding, nb_pairs),
                         (totals["configs"], totals["colliding"], totals["env_pairs"] + totals["self_pairs"]))

    def test_verdicts_and_pairs_with_the_srdf_are_the_references(self):
        self.load(text_of("robots", "panda_model", "srdf", "panda.srdf"), [])
        self.assert_verdicts_are_the_references()

    def test_the_problems_allowed_pairs_as_pair_rules_do_the_same_as_the_srdf(self):
        rules = [{"allow": ["panda_*", "panda_*"]}]  # also links that hang together, which always meet
        self.load("", rules + [{"deny": pair} for pair in self.problems["allowed_pairs"]])
        self.assert_verdicts_are_the_references()

    def test_distances_agree_with_which_pairs_meet_when_the_objects_grow_by_a_millimetre(self):
        """Borderline pairs do. The corner of an object grows by no more than the square root of three of them."""
        self.load(text_of("robots", "panda_model", "srdf", "panda.srdf"), [])
        grown = 0.001
        nb_seen = {True: 0, False: 0}
        for answer in self.answers(alarm_distance=3 * grown):
            self.assertEqual(answer.borderline - set(answer.near) - set(answer.contacts), set(), answer.key)
            for pair, distance in answer.near.items():
                is_borderline = pair in answer.borderline
                nb_seen[is_borderline] += 1
                if is_borderline:
                    self.assertLessEqual(distance, 3 ** 0.5 * grown, (answer.key, pair))
                else:
                    self.assertGreater(distance, grown, (answer.key, pair))
        self.assertTrue(all(nb_seen.values()), nb_seen)


if __name__ == "__main__":
    rospy.init_node("test_panda_problems")
    has_data = os.path.isdir(os.path.join(SHARED, "problems"))
    run_or_skip("collision_pairs", "panda_problems", PandaProblemsTest,
                "" if has_data else "no problems; COLLISION_PAIRS_SHARED names the folder with them")
