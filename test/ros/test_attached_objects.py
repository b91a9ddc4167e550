#!/usr/bin/python3
"""Objects that hang on links: they move with TF and with hypothetical states, and are let go where they are."""
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import rostest
from sensor_msgs.msg import JointState

from node_client import JointPublisher, NodeClient
from program import NODE, Program
from scene_client import SceneClient, add_box, attach, clear, detach, xyz_of

ARM = 2.0  # from a link to what it carries


def pairs(report):
    return [(pair.first_link, pair.second_link) for pair in report.pairs]


class AttachedObjectsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = JointPublisher(["slide_a", "slide_b", "slide_c"])
        cls.node = NodeClient("/node")
        cls.scene = SceneClient("/node")

    def setUp(self):
        self.scene.apply(clear())
        self.report_at(0, 4, 8)

    def report_at(self, *positions):
        since = self.robot.hold(positions)
        report = self.node.report_since(since, lambda r: not r.left_out)
        self.assertIsNotNone(report)
        return report

    def attach_above(self, link, x, name="held", **fields):
        """A box that hangs in the air, ARM above the link that stands at x."""
        self.scene.apply(add_box(name, (x, 0, ARM), **fields))
        return self.scene.apply(attach(name, link))[name]

    def test_what_is_attached_moves_with_its_link(self):
        self.attach_above("a", 0.0)
        self.scene.apply(add_box("post", (2.0, 0, ARM)))
        self.assertEqual(pairs(self.report_at(0, 4, 8)), [])
        self.assertEqual(pairs(self.report_at(2, 4, 8)), [("held", "post")])
        self.assertEqual(pairs(self.report_at(-2, 4, 8)), [])

    def test_what_is_attached_meets_a_link_that_was_in_no_pair(self):
        """Whose geometry the node has not loaded yet."""
        rospy.set_param("/lean/pair_rules", [{"deny": ["c", "a"]}, {"deny": ["c", "b"]}])
        lean = Program(NODE, "__name:=lean")
        try:
            node, scene = NodeClient("/lean"), SceneClient("/lean")
            self.assertIsNotNone(node.next(node.reports, lambda r: r.verdict == r.FREE))
            scene.apply(add_box("held", (8, 0, 0), attached_link="a"))
            report = node.next(node.reports, lambda r: r.verdict == r.COLLISION)
            self.assertIsNotNone(report)
            self.assertEqual(pairs(report), [("c", "held")])
        finally:
            lean.end()

    def test_what_is_attached_moves_with_its_link_also_if_its_name_comes_before_all_links(self):
        self.scene.apply(add_box("post", (10.0, 0, ARM)))
        self.attach_above("c", 8.0, "A first name")
        self.assertEqual(pairs(self.report_at(0, 4, 8)), [])
        self.assertEqual(pairs(self.report_at(0, 4, 10)), [("A first name", "post")])

    def test_what_is_attached_moves_with_a_hypothetical_state(self):
        self.attach_above("a", 0.0)
        self.scene.apply(add_box("post", (2.0, 0, ARM)))
        for x, expected in ((2.0, [("held", "post")]), (0.0, [])):
            reply = self.node.check(joint_state=JointState(name=["slide_a"], position=[x]))
            self.assertTrue(reply.success, reply.message)
            self.assertEqual(pairs(reply.result), expected)

    def test_an_object_goes_from_hand_to_hand(self):
        self.attach_above("a", 0.0)
        self.report_at(3, 4, 8)
        held = self.scene.apply(attach("held", "b"))["held"]
        self.assertAlmostEqual(xyz_of(held)[0], -1.0, places=9)
        self.report_at(0, 6, 8)
        held = self.scene.apply(detach("held"))["held"]
        self.assertAlmostEqual(xyz_of(held)[0], 5.0, places=9)


if __name__ == "__main__":
    rospy.init_node("test_attached_objects")
    rostest.rosrun("collision_pairs", "attached_objects", AttachedObjectsTest)
