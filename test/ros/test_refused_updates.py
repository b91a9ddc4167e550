#!/usr/bin/python3
"""An update of which one change is wrong is refused with a message that names it, and changes nothing at all."""
import os
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import rostest
from shape_msgs.msg import SolidPrimitive

from collision_pairs.msg import SceneChange
from node_client import JointPublisher, NodeClient
from scene_client import (SceneClient, add, add_box, attach, box, change, clear, cone, cylinder, detach, move, plane,
                          pose, remove, sphere, tetrahedron)

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

    def test_an_operation_that_is_none(self):
        self.assert_refused(change(6, "tool"), "changes[2]", "'tool'", "operation 6", "CLEAR 5")

    def test_an_object_that_is_none_is_named_with_the_one_that_is_meant(self):
        for wrong in (move("tol", (0, 0, 9)), remove("tol"), attach("tol", "a"), detach("tol")):
            self.assert_refused(wrong, "changes[2]", "'tol'", "did you mean 'tool'?")

    def test_an_object_of_a_scene_without_any(self):
        reply = self.scene.send(clear(), remove("tool"))
        self.assertFalse(reply.success)
        self.assertIn("the scene has none", reply.message)
        self.assertEqual(self.scene.apply(), self.before)

    def test_a_link_that_is_none_is_named_with_the_one_that_is_meant(self):
        self.assert_refused(attach("tool", "bb"), "'tool'", "'bb'", "did you mean 'b'?")
        self.assert_refused(add_box("new", attached_link="bb"), "'new'", "'bb'", "did you mean 'b'?")
        self.assert_refused(add_box("new", attached_link="bb", frame="bb"), "'new'", "'bb'", "did you mean 'b'?")
        self.assert_refused(attach("tool", "b", touch_links=["cc"]), "'tool'", "touch_links", "'cc'", "did you mean 'c'?")
        self.assert_refused(add_box("new", touch_links=["cc"]), "'new'", "touch_links", "'cc'", "did you mean 'c'?")

    def test_the_name_of_a_link_or_none(self):
        self.assert_refused(add_box("b"), "'b'", "name of a link")
        self.assert_refused(add_box("root"), "'root'", "name of a link")
        self.assert_refused(add_box(""), "changes[2]", "no name")

    def test_attaching_to_nothing_and_detaching_what_hangs_on_nothing(self):
        self.assert_refused(attach("tool", ""), "'tool'", "attached_link is empty")
        self.assert_refused(detach("other"), "'other'", "not attached")

    def test_poses_that_are_none(self):
        for bad, says in ((pose(xyzw=(0, 0, 0, 0)), "its quaternion is of length 0"),
                          (pose(xyzw=(0, 0, 0, 2)), "its quaternion is of length 2"),
                          (pose((NAN, 0, 0)), "its position is not finite"),
                          (pose((0, INF, 0)), "its position is not finite"),
                          (pose(xyzw=(0, 0, NAN, 1)), "its quaternion is not finite")):
            for wrong in (add_box("new", pose=bad), move("tool", (0, 0, 0), pose=bad)):
                self.assert_refused(wrong, "changes[2]", "pose", "quaternion of length 1", says)
            self.assert_refused(add_box("new", primitive_poses=[bad]), "'new'", "primitives[0]", "pose")

    def test_primitives_of_the_wrong_size(self):
        for shape, says in ((box(1, 1), "3: x, y, z"), (sphere(0.1), ""), (box(1, 1, 1, 1), "4 dimensions"),
                            (SolidPrimitive(type=SolidPrimitive.SPHERE), "1: radius"),
                            (SolidPrimitive(type=SolidPrimitive.CYLINDER, dimensions=[1]), "2: height, radius"),
                            (SolidPrimitive(type=SolidPrimitive.CONE, dimensions=[1, 1, 1]), "2: height, radius")):
            if says:
                self.assert_refused(add("new", primitives=[sphere(0.1), shape]), "'new'", "primitives[1]", says)
        for shape in (box(0.1, -0.1, 0.1), sphere(-0.1), cylinder(-0.1, 0.1), cone(0.1, -0.1), box(NAN, 1, 1),
                      sphere(INF), cone(NAN, 1), cylinder(1, NAN)):
            self.assert_refused(add("new", primitives=[shape]), "changes[2]", "'new'", "primitives[0]")

    def test_a_type_of_primitive_that_is_none(self):
        self.assert_refused(add("new", primitives=[SolidPrimitive(type=7)]), "'new'", "primitives[0]", "type 7")

    def test_poses_that_are_not_as_many_as_the_parts(self):
        two = [pose(), pose()]
        for kind, parts in (("primitive", [box(1, 1, 1)]), ("mesh", [tetrahedron(1)]), ("plane", [plane(0, 0, 1, 0)])):
            plural = {"mesh": "meshes"}.get(kind, kind + "s")
            self.assert_refused(add("new", **{plural: parts, kind + "_poses": two}), "'new'", plural, "2 poses")
        self.assert_refused(add("new", mesh_resources=["file:///none.stl"], mesh_resource_poses=two), "2 poses")
        self.assert_refused(add("new", primitive_poses=two), "'new'", "primitives", "2 poses")

    def test_meshes_that_are_none(self):
        beyond = tetrahedron(1)
        beyond.triangles[1].vertex_indices = [0, 1, 4]
        self.assert_refused(add("new", meshes=[tetrahedron(1), beyond]), "'new'", "meshes[1]", "4")
        broken = tetrahedron(1)
        broken.vertices[2].x = NAN
        self.assert_refused(add("new", meshes=[broken]), "'new'", "meshes[0]")
        empty = tetrahedron(1)
        empty.triangles = []
        self.assert_refused(add("new", meshes=[empty]), "'new'", "meshes[0]")

    def test_mesh_files_that_are_not_there(self):
        for uri in ("file:///nowhere/part.stl", "package://no_such_package/part.stl", "part.stl"):
            self.assert_refused(add("new", mesh_resources=[uri]), "'new'", "mesh_resources[0]", uri)

    def test_mesh_files_that_end_the_library_that_reads_them(self):
        vertices = ("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n")
        for faces in ("", "0\n", "3 0 1 -1\n"):
            with tempfile.NamedTemporaryFile("w", suffix=".ply") as file:
                file.write(vertices + faces)
                file.flush()
                uri = "file://" + file.name
                self.assert_refused(add("new", mesh_resources=[uri]), "'new'", "mesh_resources[0]", uri)

    def test_planes_without_a_direction(self):
        for wrong in (plane(0, 0, 0, 1), plane(NAN, 0, 1, 0), plane(0, 0, 1, INF), plane(INF, 0, 0, 0)):
            self.assert_refused(add("new", planes=[wrong]), "'new'", "planes[0]", "do not define a plane")

    def test_a_frame_that_tf_does_not_know(self):
        self.assert_refused(add_box("new", frame="nowhere"), "changes[2]", "'new'", "'nowhere'")
        self.assert_refused(move("tool", (0, 0, 0), frame="nowhere"), "changes[2]", "'tool'", "'nowhere'")
        late = add_box("new", frame="a")
        late.object.header.stamp = rospy.Time.now() + rospy.Duration(100)
        self.assert_refused(late, "changes[2]", "'new'", "extrapolation")

    def test_a_padding_that_is_no_distance(self):
        for metres in (-0.01, NAN, INF):
            self.assert_refused(add_box("new", padding=metres), "'new'", "padding")

    def test_an_object_without_a_shape(self):
        self.assert_refused(add("new"), "'new'", "no shape")


if __name__ == "__main__":
    rospy.init_node("test_refused_updates")
    rostest.rosrun("collision_pairs", "refused_updates", RefusedUpdatesTest)
