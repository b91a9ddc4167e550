#!/usr/bin/python3
"""check_trajectory with `between`: what lies between the points of a trajectory."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import rostest
from geometry_msgs.msg import Point
from sensor_msgs.msg import JointState
from shape_msgs.msg import MeshTriangle
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from collision_pairs.msg import CollisionPairs
from collision_pairs.srv import CheckTrajectory
from scene_client import SceneCase, add, add_box, clear, tetrahedron

FREE, COLLISION, UNKNOWN = CollisionPairs.FREE, CollisionPairs.COLLISION, CollisionPairs.UNKNOWN


def gate(y):
    """Two tetrahedra, which show flat sides to each other at -y and y."""
    mesh = tetrahedron(1.0)
    mesh.vertices += [Point(p.x, -p.y, p.z) for p in mesh.vertices]
    mesh.triangles += [MeshTriangle(vertex_indices=[4 + i for i in reversed(t.vertex_indices)]) for t in mesh.triangles]
    for p in mesh.vertices[:4]:
        p.y += y
    for p in mesh.vertices[4:]:
        p.y -= y
    return mesh


class MotionsTest(SceneCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.check = rospy.ServiceProxy("/node/check_trajectory", CheckTrajectory)

    def setUp(self):
        """Unit boxes far from each other, and a plate of 2 mm in the way of a."""
        self.stand(0, 20, 30)
        self.scene.apply(clear(), add_box("plate", (5, 0, 0), (0.002, 2, 2)))

    def ask(self, xs, **fields):
        """x of a at each point."""
        points = [JointTrajectoryPoint(positions=[x]) for x in xs]
        reply = self.check(trajectory=JointTrajectory(joint_names=["slide_a"], points=points), **fields)
        self.assertTrue(reply.success, reply.message)
        return reply

    def test_a_thin_plate_between_free_points_is_found(self):
        reply = self.ask([0, 3, 8, 9], between=True)
        self.assertEqual(list(reply.verdict), [FREE] * 4)
        self.assertEqual(list(reply.segment_verdict), [FREE, COLLISION, FREE])
        self.assertEqual((reply.contact_at[0], reply.contact_at[2]), (0.0, 0.0))
        state = JointState(name=["slide_a"], position=[3 + 5 * reply.contact_at[1]])
        there = self.node.check(joint_state=state).result
        self.assertEqual([(p.first_link, p.second_link) for p in there.pairs], [("a", "plate")])
        self.assertEqual(there.verdict, COLLISION)
        # At x = 3 the box is 1.499 m from the plate, at x = 8 it is 2.499 m.
        for i, nearest in ((0, 1.499), (2, 2.499)):
            self.assertGreater(reply.clearance[i], 0.0)
            self.assertLessEqual(reply.clearance[i], nearest)
        self.assertEqual(reply.clearance[1], 0.0)
        self.assertEqual((reply.free_until[0], reply.free_until[2]), (1.0, 1.0))
        self.assertLessEqual(reply.free_until[1], 1.499 / 5)
        self.assertGreater(reply.free_until[1], 1.497 / 5)
        self.assertEqual(reply.unknown_because, [])

    def test_joints_that_are_not_named_stand_where_tf_has_them(self):
        self.stand(0, -5, 30)
        self.assertEqual(list(self.ask([0, -9], between=True).segment_verdict), [COLLISION])
        self.stand(0, 20, 30)
        self.assertEqual(list(self.ask([0, -9], between=True).segment_verdict), [FREE])

    def test_a_pair_that_cannot_be_certified_is_named(self):
        """10 micrometres on either side, in the gap of one object: no plane lies between the two."""
        self.scene.apply(clear(), add("gate", (5, 0, 0), meshes=[gate(0.5 + 1e-5)]))
        reply = self.ask([3, 8], between=True)
        self.assertEqual((list(reply.verdict), list(reply.segment_verdict)), ([FREE, FREE], [UNKNOWN]))
        self.assertIn("a|gate", " ".join(reply.unknown_because))
        self.scene.apply(clear(), add("gate", (5, 0, 0), meshes=[gate(0.51)]))
        self.assertEqual(list(self.ask([3, 8], between=True).segment_verdict), [FREE])
        convex = self.ask([3, 8], between=True, fidelity="convex")  # there is no gap
        self.assertEqual((list(convex.verdict), list(convex.segment_verdict)), ([FREE, FREE], [COLLISION]))

    def test_a_long_answer_does_not_hold_up_the_cycle(self):
        self.scene.apply(clear(), add("gate", (5, 0, 0), meshes=[gate(0.5 + 1e-5)]))
        nb_points, took = 2, 0.0
        while took < 1.0:
            nb_points *= 4
            begin, before = rospy.get_time(), len(self.node.reports)
            self.ask([3, 8] * (nb_points // 2), between=True)
            took = rospy.get_time() - begin
        self.assertGreater(len(self.node.reports) - before, 5, "of about 50 a second")


if __name__ == "__main__":
    rospy.init_node("test_motions")
    rostest.rosrun("collision_pairs", "motions", MotionsTest)
