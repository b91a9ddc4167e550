#!/usr/bin/python3
"""An update of which one change is wrong is refused with a message that names it, and changes nothing at all."""
import os
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import rostest

from node_client import JointPublisher, NodeClient
from scene_client import SceneClient, add, add_box, attach, clear, detach, move, remove

NAN, INF = float("nan"), float("inf")


class RefusedUpdatesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = JointPublisher(["slide_a", "slide_b", "slide_c"])
        cls.node = NodeClient("/node")
        cls.scene = SceneClient("/node")
        since = cls.robot.hold([0, 3, 6])
        cls.node.report_since(since, lambda r: not r.left_out)
        cls.before = cls.scene.apply(clear(), add_box("crate", (0, 0, 0.5)), add_box("tool", (3, 0, 2.0)),
                                     attach("tool", "b"))

    def verdict(self):
        reply = self.node.check()
        self.assertTrue(reply.success, reply.message)
        return [(p.first_link, p.second_link, p.state, p.distance) for p in reply.result.pairs]

    def assert_refused(self, wrong, *says):
        """In the middle of changes that are right, each of which would be seen."""
        before = self.verdict()
        reply = self.scene.send(remove("crate"), add_box("other", (6, 0, 0)), wrong, move("tool", (3, 0, 9)))
        self.assertFalse(reply.success, says)
        for words in says:
            self.assertIn(words, reply.message)
        self.assertEqual({listed.name: listed for listed in reply.objects}, self.before)
        self.assertEqual(self.scene.apply(), self.before)
        self.assertEqual(self.verdict(), before)
        self.assertEqual([pair[:2] for pair in before], [("a", "crate")])

    def test_an_object_that_is_none_is_named_with_the_one_that_is_meant(self):
        for wrong in (move("tol", (0, 0, 9)), remove("tol"), attach("tol", "a"), detach("tol")):
            self.assert_refused(wrong, "changes[2]", "'tol'", "did you mean 'tool'?")

    def test_a_link_that_is_none_is_named_with_the_one_that_is_meant(self):
        self.assert_refused(attach("tool", "bb"), "'tool'", "'bb'", "did you mean 'b'?")
        self.assert_refused(add_box("new", attached_link="bb"), "'new'", "'bb'", "did you mean 'b'?")
        self.assert_refused(add_box("new", attached_link="bb", frame="bb"), "'new'", "'bb'", "did you mean 'b'?")
        self.assert_refused(attach("tool", "b", touch_links=["cc"]), "'tool'", "touch_links", "'cc'", "did you mean 'c'?")
        self.assert_refused(add_box("new", touch_links=["cc"]), "'new'", "touch_links", "'cc'", "did you mean 'c'?")

    def test_mesh_files_that_are_not_there(self):
        for uri in ("file:///nowhere/part.stl", "package://no_such_package/part.stl", "part.stl"):
            self.assert_refused(add("new", mesh_resources=[uri]), "'new'", "mesh_resources[0]", uri)

    def test_a_frame_that_tf_does_not_know(self):
        self.assert_refused(add_box("new", frame="nowhere"), "changes[2]", "'new'", "'nowhere'")
        self.assert_refused(move("tool", (0, 0, 0), frame="nowhere"), "changes[2]", "'tool'", "'nowhere'")
        late = add_box("new", frame="a")
        late.object.header.stamp = rospy.Time.now() + rospy.Duration(100)
        self.assert_refused(late, "changes[2]", "'new'", "extrapolation")


if __name__ == "__main__":
    rospy.init_node("test_refused_updates")
    rostest.rosrun("collision_pairs", "refused_updates", RefusedUpdatesTest)
