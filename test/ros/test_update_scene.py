#!/usr/bin/python3
"""Objects that stand still: what a request and its reply say, and when the node knows of it."""
import os
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import rostest
from std_srvs.srv import Trigger

from scene_client import SceneCase, add, add_box, attach, box, clear, move, remove, xyz_of

A, B, C = 0.0, 3.0, 6.0  # where the unit boxes a, b and c stand, along x
TOP = 0.5                # of each of them
GAP = 0.03
OBJ_TETRAHEDRON = "v 0 0 0\nv 0.2 0 0\nv 0 0.2 0\nv 0 0 0.2\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"


def distances(report):
    return {(pair.first_link, pair.second_link): pair.distance for pair in report.pairs}


class UpdateSceneTest(SceneCase):
    def setUp(self):
        since = self.robot.hold([A, B, C])
        self.scene.apply(clear())
        self.assertIsNotNone(self.node.report_since(since, lambda r: not r.left_out and not r.pairs))

    def checked(self):
        reply = self.node.check()
        self.assertTrue(reply.success, reply.message)
        return reply.result

    def assert_only_distance(self, pair, distance, places=9):
        found = distances(self.checked())
        self.assertEqual(list(found), [pair])
        self.assertAlmostEqual(found[pair], distance, places=places)

    def test_objects_are_listed_unless_the_request_says_no(self):
        crate = add("crate", (A, 0, TOP + GAP + 0.1), primitives=[box(0.2, 0.2, 0.2)])
        self.assertEqual(self.scene.send(crate, no_list=True).objects, [])
        self.assert_only_distance(("a", "crate"), GAP)
        self.assertEqual([listed.name for listed in self.scene.send().objects], ["crate"])
        refused = self.scene.send(move("none", (0, 0, 0)), no_list=True)
        self.assertEqual((refused.success, refused.objects), (False, []))

    def test_of_an_update_of_which_one_change_is_wrong_nothing_is_done(self):
        """In the middle of changes that are right, each of which would be seen."""
        before = self.scene.apply(add_box("crate", (A, 0, TOP)), add_box("tool", (B, 0, 2.0)), attach("tool", "b"))
        late = add_box("new", frame="a")
        late.object.header.stamp = rospy.Time.now() + rospy.Duration(100)
        for wrong, *says in ((move("tol", (0, 0, 9)), "changes[2]", "did you mean 'tool'?"),
                             (attach("tool", "bb"), "did you mean 'b'?"),
                             (attach("tool", "b", touch_links=["cc"]), "touch_links", "did you mean 'c'?"),
                             (add_box("new", attached_link="bb", frame="bb"), "did you mean 'b'?"),
                             (add("new", mesh_resources=["file:///nowhere/part.stl"]), "mesh_resources[0]"),
                             (add_box("new", frame="nowhere"), "changes[2]", "'nowhere'"), (late, "changes[2]", "extrapolation")):
            reply = self.scene.send(remove("crate"), add_box("other", (C, 0, 0)), wrong, move("tool", (B, 0, 9)))
            self.assertFalse(reply.success, says)
            for words in ["'%s'" % wrong.object.name] + says:
                self.assertIn(words, reply.message)
            self.assertEqual({listed.name: listed for listed in reply.objects}, before)
            self.assertEqual(self.scene.apply(), before)
            self.assertEqual(list(distances(self.checked())), [("a", "crate")])

    def test_a_mesh_is_what_its_file_holds_when_it_is_added(self):
        with tempfile.NamedTemporaryFile("w", suffix=".obj") as mesh:
            for lifted in (1.0, 0.0):  # as many bytes, and the same time to a second
                mesh.seek(0)
                mesh.write("".join("v %s %s %.1f\n" % (x, y, float(z) + lifted) if kind == "v" else
                                   " ".join((kind, x, y, z)) + "\n"
                                   for kind, x, y, z in map(str.split, OBJ_TETRAHEDRON.splitlines())))
                mesh.flush()
                self.scene.apply(clear(), add("part", (A, 0, TOP + GAP), mesh_resources=["file://" + mesh.name]))
                expected = {} if lifted else {("a", "part"): GAP}
                self.assertEqual({pair: round(d, 6) for pair, d in distances(self.checked()).items()}, expected)

    def test_the_reply_lists_the_scene_by_name_in_the_frame_of_the_reports(self):
        objects = self.scene.apply(add_box("y", (1, 2, 3)), add_box("x", (4, 5, 6), touch_links=["b"]))
        self.assertEqual(list(objects), ["x", "y"])
        self.assertEqual(objects["x"].header.frame_id, "root")
        self.assertEqual((xyz_of(objects["x"]), xyz_of(objects["y"])), ((4, 5, 6), (1, 2, 3)))
        self.assertEqual(objects["x"].touch_links, ["b"])
        self.assertEqual(objects["x"].primitives, [box(0.2, 0.2, 0.2)])
        self.assertEqual(self.scene.apply(), objects)
        self.assertEqual(list(self.scene.apply(remove("x"))), ["y"])
        self.assertEqual(self.scene.apply(clear()), {})

    def test_an_object_that_is_placed_in_a_links_frame_stays_where_that_was(self):
        objects = self.scene.apply(add_box("box", (0, 0, TOP + 0.1 + GAP), frame="b"))
        self.assertEqual((objects["box"].header.frame_id, objects["box"].attached_link), ("root", ""))
        self.assertAlmostEqual(xyz_of(objects["box"])[0], B, places=9)
        self.assert_only_distance(("b", "box"), GAP)
        since = self.robot.hold([B, -3, C])
        report = self.node.report_since(since, lambda r: not r.left_out)
        self.assertEqual(list(distances(report)), [("a", "box")])

    def test_objects_survive_a_reset(self):
        before = self.scene.apply(add_box("box", (A, 0, TOP + 0.1 + GAP)))
        reply = rospy.ServiceProxy("/node/reset", Trigger)()
        self.assertTrue(reply.success, reply.message)
        self.assertEqual(self.scene.apply(), before)
        self.assert_only_distance(("a", "box"), GAP)

    def test_a_reset_that_would_shift_what_stands_still_is_refused(self):
        urdf = rospy.get_param("/robot_description")
        before = self.scene.apply(add_box("box", (A, 0, TOP + 0.1 + GAP)))
        rospy.set_param("/robot_description", urdf.replace('<link name="root"/>', """
            <link name="world"/><link name="root"/>
            <joint name="stand" type="fixed">
              <parent link="world"/><child link="root"/><origin xyz="0 0 5"/>
            </joint>"""))
        try:
            reply = rospy.ServiceProxy("/node/reset", Trigger)()
        finally:
            rospy.set_param("/robot_description", urdf)
        self.assertFalse(reply.success)
        for words in ("'box'", "'root'", "'world'", "remove the object"):
            self.assertIn(words, reply.message)
        self.assertEqual(self.scene.apply(), before)
        self.assert_only_distance(("a", "box"), GAP)

    def test_an_update_is_known_to_the_next_query_and_to_every_report_of_a_later_stamp(self):
        for _ in range(5):
            for changes, expected in (([add_box("box", (A, 0, TOP))], [("a", "box")]), ([remove("box")], [])):
                self.scene.apply(*changes)
                since = rospy.Time.now()
                self.assertEqual(list(distances(self.checked())), expected)
                self.assertIsNotNone(self.node.report_since(since))
                for report in [r for r in self.node.reports if r.header.stamp > since]:
                    self.assertEqual(list(distances(report)), expected)


if __name__ == "__main__":
    rospy.init_node("test_update_scene")
    rostest.rosrun("collision_pairs", "update_scene", UpdateSceneTest)
