#!/usr/bin/python3
"""What parameters say of the scene: which are refused, and where that is said. (What they do: test_reset.py.)"""
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticStatus
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger

from node_client import JointPublisher, NodeClient, diagnosis_of
from scene_client import SceneClient, add_box

LINKS = ["slide_a", "slide_b", "slide_c"]

WRONG_WORLD = ("<robot name='world'><link name='a'><collision><geometry><sphere radius='1'/></geometry></collision>"
               "</link></robot>")
REFUSED = (
    ("node/pair_rules", "deny", ("pair_rules is deny", "a list of")),
    ("node/pair_padding", [{"pair": ["a", "cc"], "padding": 0.1}], ("pair_padding", "'cc'", "did you mean 'c'?")),
    ("node/paddding", 0.1, ("/ignored/node/paddding", "did you mean 'padding'?")),
    ("node/link_padding", {"cc": 0.1}, ("link_padding", "'cc'", "did you mean 'c'?")),
    ("node/ignored_links", ["bb"], ("ignored_links", "'bb'", "did you mean 'b'?")),
    ("node/cylinder_as_capsule", ["bb"], ("cylinder_as_capsule", "'bb'", "did you mean 'b'?")),
    ("node/floor", {"height": 0.0, "touch_links": ["bb"]}, ("'floor'", "touch_links", "'bb'", "did you mean 'b'?")),
    ("node/group", "first", ("'first'", "no SRDF")),
    ("node/links", ["bb"], ("'bb'", "did you mean 'b'?")),
    ("node/robots", 5, ("/ignored/node/robots", "is not a list")),
    ("node/robots", [{"urdf": "robot_description"}], ("/ignored/node/robots", "is not a list of {description")),
    ("node/robots", [{"description": "nowhere", "prefix": "left"}], ("no parameter nowhere",)),
    ("node/robots", [{"description": "robot_description", "semantic": "nowhere"}],
     ("no parameter nowhere", "/ignored/node/robots names it as the SRDF")),
    ("node/robots", [{"description": "robot_description"}] * 2, ("same name", "different prefix")),
    ("environment_description", "<robot name='world'>", ("/ignored/environment_description",)),
    ("environment_description", 5, ("/ignored/environment_description is not text",)),
    ("robot_description_semantic", {"robot": 1}, ("/ignored/robot_description_semantic is not text",)),
    ("environment_description", WRONG_WORLD, ("'a'", "in the robot and in the world")),
)


def names_of(pairs):
    return [(pair.first_link, pair.second_link) for pair in pairs]


class SceneParametersTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = JointPublisher(LINKS)
        cls.since = cls.robot.hold([0, 0, 0])

    def client(self, namespace):
        node = NodeClient("/" + namespace + "/node")
        report = node.report_since(self.since, lambda r: not r.left_out)
        self.assertIsNotNone(report)
        return node

    def distances(self, node, positions, **fields):
        """{pair: distance} in a hypothetical state."""
        reply = node.check(joint_state=JointState(name=LINKS, position=positions), **fields)
        self.assertTrue(reply.success, reply.message)
        return {(p.first_link, p.second_link): round(p.distance, 9) for p in reply.result.pairs}

    def test_a_link_of_the_environment_has_its_name_for_itself(self):
        node = self.client("cell")
        scene = SceneClient("/cell/node")
        for name in ("table", "floor"):
            reply = scene.send(add_box(name))
            self.assertFalse(reply.success)
            self.assertIn("'%s'" % name, reply.message)
        self.assertNotIn(("floor", "table"), self.distances(node, [0, 3, 6], alarm_distance=9.0))

    def test_a_misspelt_parameter_that_leaves_no_pair_out_is_named_by_diagnostics(self):
        self.client("restricted")
        status = diagnosis_of("restricted/node")
        self.assertEqual(status.level, DiagnosticStatus.WARN)
        self.assertIn("/restricted/node/max_pos_age", status.message)
        self.assertIn("did you mean 'max_pose_age'?", status.message)

    def test_a_node_that_is_restricted_to_a_group_answers_other_requests_all_the_same(self):
        node = self.client("restricted")
        self.assertEqual(names_of(node.next(node.reports).pairs), [("a", "b"), ("a", "c")])
        self.assertEqual(list(self.distances(node, [0, 0, 0])), [("a", "b"), ("a", "c")])
        self.assertEqual(list(self.distances(node, [0, 0, 0], links=["c"])), [("a", "c"), ("b", "c")])

    def assert_diagnosed(self, namespace, *says):
        status = diagnosis_of(namespace + "/node")
        self.assertEqual(status.level, 2)
        for words in says:
            self.assertIn(words, status.message)
        self.assertFalse(NodeClient("/" + namespace + "/node").check().success)

    def test_a_rule_that_cannot_be_read_is_in_the_diagnostics_of_a_node_that_stays_up(self):
        self.assert_diagnosed("wrong_rule", "/wrong_rule/node", "pair_rules", "forbid", "deny: [first, second]")

    def test_a_rule_about_no_link_is_diagnosed_and_once_mended_taken(self):
        self.assert_diagnosed("wrong_link", "pair_rules", "'aa'", "did you mean 'a'?")
        node = NodeClient("/wrong_link/node")
        rospy.set_param("/wrong_link/node/pair_rules", [{"deny": ["a", "*"]}])
        self.assertIsNotNone(node.next(node.reports, lambda r: r.left_out or r.nb_boxes))
        self.assertEqual(list(self.distances(node, [0, 0, 0])), [("b", "c")])

    def test_parameters_that_are_refused_at_a_reset_leave_the_old_scene(self):
        node = self.client("ignored")
        reset = rospy.ServiceProxy("/ignored/node/reset", Trigger)
        for name, value, says in REFUSED:
            name = "/ignored/" + name
            before = rospy.get_param(name, None)
            rospy.set_param(name, value)
            reply = reset()
            rospy.delete_param(name)
            if before is not None:
                rospy.set_param(name, before)
            self.assertFalse(reply.success, (name, value))
            for words in ("old scene is kept",) + says:
                self.assertIn(words, reply.message)
            self.assertEqual(list(self.distances(node, [0, 0, 0])), [("a", "c")])
        reply = reset()
        self.assertTrue(reply.success, reply.message)


if __name__ == "__main__":
    rospy.init_node("test_scene_parameters")
    rostest.rosrun("collision_pairs", "scene_parameters", SceneParametersTest)
