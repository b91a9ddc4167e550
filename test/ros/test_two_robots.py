#!/usr/bin/python3
"""Two robots of one kind in one scene: names with prefixes, an SRDF each, checked against each other."""
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import rostest
from sensor_msgs.msg import JointState
from tf2_msgs.msg import TFMessage

from node_client import JointPublisher, NodeClient, publish_transform
from scene_client import SceneClient, add_box, attach, clear, xyz_of

JOINTS = ["slide_a", "slide_b", "slide_c"]
APART = [0, 3, 6]
ALL_LINKS = sorted(robot + "/" + link for robot in ("left", "right") for link in "abc")


def pairs(report):
    return [(pair.first_link, pair.second_link) for pair in report.pairs]


class TwoRobotsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robots = [JointPublisher(JOINTS, topic=side + "/joint_states") for side in ("left", "right")]
        cls.offset = 20.0  # of the right robot, along y
        publisher = rospy.Publisher("/tf", TFMessage, queue_size=10)

        def place(_):
            publish_transform(publisher, "world", "left/root")
            publish_transform(publisher, "world", "right/root", (0, cls.offset, 0))
        cls.timer = rospy.Timer(rospy.Duration(0.02), place)
        cls.node = NodeClient("/node")
        cls.scene = SceneClient("/node")

    def setUp(self):
        self.scene.apply(clear())

    def report_at(self, left, right, offset):
        type(self).offset = offset
        self.robots[0].hold(left)
        since = self.robots[1].hold(right)
        report = self.node.report_since(since, lambda r: not r.left_out)
        self.assertIsNotNone(report)
        return report

    def test_every_link_of_both_robots_is_checked_by_its_prefixed_name(self):
        report = self.report_at(APART, APART, 20.0)
        self.assertEqual((report.nb_boxes, report.pairs, report.header.frame_id), (6, [], "world"))
        wide = self.node.check(alarm_distance=100.0).result
        self.assertEqual(sorted({name for pair in pairs(wide) for name in pair}), ALL_LINKS)

    def test_they_are_checked_against_each_other_and_an_srdf_never_speaks_of_the_other(self):
        # a of one at b of the other, and a at a: the SRDF of left names the links "a" and "b".
        report = self.report_at(APART, APART, 0.5)
        self.assertEqual(pairs(report), [("left/" + link, "right/" + link) for link in "abc"])
        report = self.report_at(APART, [3, -6, 9], 0.5)
        self.assertEqual(pairs(report), [("left/b", "right/a")])

    def test_a_hypothetical_state_names_the_joints_with_their_prefix(self):
        self.report_at(APART, APART, 20.0)
        reply = self.node.check(joint_state=JointState(name=["right/slide_a", "left/slide_c"], position=[3.0, 3.0]))
        self.assertTrue(reply.success, reply.message)
        self.assertEqual(pairs(reply.result), [("left/b", "left/c"), ("right/a", "right/b")])
        self.assertEqual(sorted(reply.joints_from_tf),
                         ["left/slide_a", "left/slide_b", "right/slide_b", "right/slide_c"])
        self.assertEqual(reply.joints_at_zero, [])
        refused = self.node.check(joint_state=JointState(name=["slide_a"], position=[3.0]))
        self.assertFalse(refused.success)
        self.assertIn("'slide_a'", refused.message)

    def test_a_request_is_restricted_to_a_robot_or_a_group_of_one(self):
        self.report_at([0, 0, 0], [0, 0, 0], 20.0)
        self.assertEqual(len(self.node.check(links=["right/*"]).result.pairs), 3)
        self.assertEqual(pairs(self.node.check(group="left/first").result), [("left/a", "left/c")])
        for group, says in (("first", "no robot"), ("right/first", "no SRDF"), ("left/frist", "did you mean 'first'?")):
            refused = self.node.check(group=group)
            self.assertFalse(refused.success)
            self.assertIn(says, refused.message)

    def test_one_robot_carries_what_the_other_may_meet(self):
        self.report_at(APART, APART, 20.0)
        self.scene.apply(add_box("tool", (0, 1.0, 0)))
        tool = self.scene.apply(attach("tool", "left/a"))["tool"]
        self.assertEqual((tool.attached_link, xyz_of(tool)), ("left/a", (0, 1.0, 0)))
        self.assertEqual(pairs(self.report_at(APART, APART, 1.55)), [("right/a", "tool")])
        self.assertEqual(pairs(self.report_at([20, 3, 6], APART, 1.55)), [])

    def test_an_object_may_be_given_in_any_frame_of_tf_though_the_fixed_frame_is_no_link(self):
        self.report_at(APART, APART, 20.0)
        held = self.scene.apply(add_box("post", (0.5, 0, 0), frame="right/root"))["post"]
        self.assertEqual((held.header.frame_id, xyz_of(held)), ("world", (0.5, 20.0, 0)))
        refused = self.scene.send(add_box("lost", frame="nowhere"))
        self.assertFalse(refused.success)
        self.assertIn("TF does not know 'nowhere' in 'world'", refused.message)


if __name__ == "__main__":
    rospy.init_node("test_two_robots")
    rostest.rosrun("collision_pairs", "two_robots", TwoRobotsTest)
