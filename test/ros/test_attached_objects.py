#!/usr/bin/python3
"""Objects that hang on links: they move with TF and with hypothetical states, and are let go where they are."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import rostest
from sensor_msgs.msg import JointState

from node_client import NodeClient
from program import NODE, Program
from scene_client import SceneCase, SceneClient, add_box, attach, clear

ARM = 2.0  # from a link to what it carries


def pairs(report):
    return [(pair.first_link, pair.second_link) for pair in report.pairs]


class AttachedObjectsTest(SceneCase):
    def setUp(self):
        self.scene.apply(clear())
        self.stand(0, 4, 8)

    def attach_above(self, link, x, name="held", **fields):
        """A box that hangs in the air, ARM above the link that stands at x."""
        self.scene.apply(add_box(name, (x, 0, ARM), **fields))
        return self.scene.apply(attach(name, link))[name]

    def test_what_is_attached_moves_with_its_link(self):
        for name in ("held", "A name before all links"):
            self.stand(0, 4, 8)
            self.attach_above("a", 0.0, name)
            self.scene.apply(add_box("post", (2.0, 0, ARM)))
            self.assertEqual(pairs(self.stand(0, 4, 8)), [])
            self.assertEqual(pairs(self.stand(2, 4, 8)), [(name, "post")])
            self.assertEqual(pairs(self.stand(-2, 4, 8)), [])
            self.scene.apply(clear())

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

    def test_what_is_attached_moves_with_a_hypothetical_state(self):
        self.attach_above("a", 0.0)
        self.scene.apply(add_box("post", (2.0, 0, ARM)))
        for x, expected in ((2.0, [("held", "post")]), (0.0, [])):
            reply = self.node.check(joint_state=JointState(name=["slide_a"], position=[x]))
            self.assertTrue(reply.success, reply.message)
            self.assertEqual(pairs(reply.result), expected)


if __name__ == "__main__":
    rospy.init_node("test_attached_objects")
    rostest.rosrun("collision_pairs", "attached_objects", AttachedObjectsTest)
