#!/usr/bin/python3
"""Every cause of UNKNOWN, by real publishers: the node never says FREE of what it did not check."""
import os
import subprocess
import sys
import tempfile
import threading
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import rostest
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage

from collision_pairs.msg import CollisionPairs
from collision_pairs.srv import CheckCollisionsRequest, CheckTrajectory
from node_client import NodeClient, diagnosis_of
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint
from transform_faults import APART, BoxPublisher, TOUCHING, box_at

FREE, COLLISION, UNKNOWN = CollisionPairs.FREE, CollisionPairs.COLLISION, CollisionPairs.UNKNOWN


LIAR = """import rospy, transform_faults
rospy.init_node('liar')
boxes = transform_faults.BoxPublisher('b')
boxes.x['b'] += 50.0
boxes.heal()
rospy.spin()"""


class VerdictTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.boxes = BoxPublisher("abc")
        cls.node = NodeClient("/node")
        cls.first = cls.node.next(cls.node.reports)

    @classmethod
    def tearDownClass(cls):
        cls.boxes.stop()

    def setUp(self):
        self.boxes.heal()
        self.boxes.x = dict(APART)
        self.assertIsNotNone(self.node.next(self.node.reports, lambda r: r.verdict == FREE), "not FREE at the start")

    def wait_for(self, verdict, *words):
        report = self.node.wait_for(verdict, *words)
        self.assertEqual(report.in_collision, verdict != FREE)
        self.assertEqual(bool(report.unknown_because), verdict == UNKNOWN)
        return report

    def assert_stays(self, verdict, seconds):
        """Counted in reports, so that a slow machine waits longer."""
        end = rospy.get_time() + seconds
        while rospy.get_time() < end:
            self.assertEqual(self.node.next(self.node.reports).verdict, verdict)

    def service_verdict(self, **fields):
        return self.node.check(CheckCollisionsRequest(**fields)).result.verdict

    def test_01_before_any_transform_the_verdict_is_unknown_and_names_the_links(self):
        self.assertEqual((self.first.verdict, self.first.in_collision), (UNKNOWN, True))
        self.assertIn("no usable pose: a, b, c", self.first.unknown_because)

    def test_apart_is_free_and_touching_is_collision(self):
        self.wait_for(FREE)
        self.assertEqual(self.service_verdict(), FREE)
        self.boxes.x = dict(TOUCHING)
        self.wait_for(COLLISION)
        self.assertEqual(self.service_verdict(), COLLISION)

    def test_when_all_publishers_stop_the_last_verdict_is_not_repeated(self):
        self.boxes.fault = {name: "silent" for name in "abc"}
        report = self.wait_for(UNKNOWN, "max_pose_age is 1.00 s")
        self.assertEqual(report.left_out, ["a", "b", "c"])
        reply = self.node.check()
        self.assertEqual((reply.result.verdict, reply.result.in_collision), (UNKNOWN, True))
        self.assert_stays(UNKNOWN, 0.2)

    def test_of_two_nodes_that_contradict_each_other_both_are_named_while_it_lasts(self):
        self.boxes.x = dict(TOUCHING)
        self.wait_for(COLLISION)
        names = ("'/liar'", "'%s'" % rospy.get_name(), "contradict each other")
        liar = subprocess.Popen(["/usr/bin/python3", "-c", LIAR], cwd=os.path.dirname(os.path.abspath(__file__)))
        try:
            report = self.node.next(self.node.reports, lambda r: r.verdict != COLLISION)
            self.assertEqual(report.verdict, UNKNOWN)
            for name in names:
                self.assertIn(name, " ".join(report.unknown_because))
            self.assert_stays(UNKNOWN, 1.0)
            refused = {v.key: v.value for v in diagnosis_of("node").values}["transforms refused"]
            for name in names:
                self.assertIn(name, refused)
        finally:
            liar.terminate()
            liar.wait()
        self.wait_for(COLLISION)

    def test_a_single_mistaken_static_message_is_forgotten(self):
        wrong = TFMessage([box_at("b", 50.0)])
        static = rospy.Publisher("/tf_static", TFMessage, queue_size=1, latch=True)
        static.publish(wrong)
        self.wait_for(UNKNOWN, "both on /tf and on /tf_static")
        self.wait_for(FREE)
        static.unregister()

    def test_what_rviz_draws_fades_when_the_node_is_silent(self):
        for node in (self.node, NodeClient("/none/node")):
            for marker in node.next(node.marker_arrays).markers:
                self.assertAlmostEqual(marker.lifetime.to_sec(), 2.0)

    def test_when_one_publisher_stops_its_link_is_named(self):
        self.boxes.fault = {"c": "silent"}
        report = self.wait_for(UNKNOWN, "link 'c'")
        self.assertEqual(report.left_out, ["c"])
        self.boxes.x = dict(TOUCHING)  # a and b: that is certain whatever c does
        self.wait_for(COLLISION)

    def test_transforms_that_are_no_use_do_not_keep_the_old_verdict_alive(self):
        for fault in ("nan", "last_stamp"):
            self.boxes.heal()
            self.wait_for(FREE)
            self.boxes.fault = {name: fault for name in "abc"}
            self.wait_for(UNKNOWN, "max_pose_age", "refused")
        self.boxes.heal()
        self.wait_for(FREE)

    def test_a_computer_whose_clock_is_ahead_does_not_put_the_others_out(self):
        self.boxes.fault = {"c": "two_seconds_ahead"}
        self.boxes.x = dict(TOUCHING)
        self.wait_for(COLLISION)
        self.boxes.x = dict(APART)
        report = self.wait_for(UNKNOWN, "transform of 'c'", "ahead of the clock")
        self.assertEqual(report.left_out, ["c"])

    def test_a_hypothetical_state_is_free_only_if_all_of_it_is_known(self):
        state = JointState(name=["slide_a", "slide_b", "slide_c"], position=[0, 3, 6])
        self.boxes.fault = {name: "silent" for name in "abc"}
        self.wait_for(UNKNOWN)
        self.assertEqual(self.service_verdict(joint_state=state), FREE)
        part = JointState(name=["slide_a"], position=[-5])
        reply = self.node.check(joint_state=part)
        self.assertEqual(reply.result.verdict, UNKNOWN)
        self.assertTrue(any("max_pose_age" in why for why in reply.result.unknown_because), reply.result)
        check = rospy.ServiceProxy("/node/check_trajectory", CheckTrajectory)
        points = [JointTrajectoryPoint(positions=[x]) for x in (-5, self.boxes.x["b"])]
        reply = check(trajectory=JointTrajectory(joint_names=["slide_a"], points=points), between=True, want_reports=True)
        self.assertEqual(list(reply.verdict), [UNKNOWN, COLLISION])
        self.assertEqual([report.verdict for report in reply.reports], [UNKNOWN, COLLISION])
        self.assertEqual(list(reply.segment_verdict), [COLLISION])
        points[1].positions = [-6]
        beside = check(trajectory=JointTrajectory(joint_names=["slide_a"], points=points), between=True)
        self.assertEqual((list(beside.segment_verdict), list(beside.clearance), list(beside.free_until)),
                         ([UNKNOWN], [0.0], [0.0]))
        self.assertEqual((beside.joints_from_tf, beside.joints_at_zero), (["slide_b", "slide_c"], []))
        self.assertEqual(list(reply.in_collision), [True, True])
        self.assertTrue(reply.unknown_because)

    def test_a_request_that_is_refused_does_not_read_as_free(self):
        reply = self.node.check(fidelity="exact")
        self.assertFalse(reply.success)
        self.assertEqual((reply.result.verdict, reply.result.in_collision), (UNKNOWN, True))

    def test_requests_for_the_verdict_alone_and_for_the_smallest_distance(self):
        reply = self.node.check(CheckCollisionsRequest(min_distance=True))
        self.assertAlmostEqual(reply.result.min_distance, 2.0, places=9)
        self.assertFalse(reply.result.min_distance_is_bound)
        self.boxes.x = {"a": 0.0, "b": 0.5, "c": 0.75}
        self.wait_for(COLLISION)
        quick = self.node.check(CheckCollisionsRequest(verdict_only=True)).result
        self.assertEqual((quick.verdict, len(quick.pairs), quick.verdict_only), (COLLISION, 1, True))
        self.assertEqual(len(self.node.check().result.pairs), 3)

    def test_without_a_robot_the_verdict_is_unknown_at_the_nodes_rate_and_the_first_one_is_taken(self):
        node = NodeClient("/none/node")
        for _ in range(10):
            report = node.next(node.reports)
            self.assertEqual((report.verdict, report.in_collision), (UNKNOWN, True))
            self.assertIn("no parameter later", " ".join(report.unknown_because))
        self.assertTrue(node.next(node.verdicts).data)
        reply = node.check()
        self.assertEqual((reply.success, reply.result.verdict), (False, UNKNOWN))
        self.assertEqual(diagnosis_of("none/node").level, 2)
        rospy.set_param("/none/later", rospy.get_param("/robot_description"))
        self.assertIsNotNone(node.next(node.reports, lambda r: r.verdict == FREE))

    def test_while_a_heavy_robot_is_loaded_or_read_again_the_node_goes_on(self):
        node = NodeClient("/heavy/node")
        with tempfile.NamedTemporaryFile(suffix=".stl") as mesh:
            write_bumpy_sphere(mesh, 120)
            link = "<link name='%s'><collision><geometry><mesh filename='file://" + mesh.name + "'/></geometry></collision></link>"
            joint = "<joint name='to_%s' type='floating'><parent link='root'/><child link='%s'/></joint>"
            # Another scale is another mesh to prepare.
            parts = [(link % name).replace("'/>", "' scale='%g 1 1'/>" % (1 + i), 1) + joint % (name, name)
                     for i, name in enumerate("abc")]
            rospy.set_param("/heavy/heavy_robot", "<robot name='heavy'><link name='root'/>%s</robot>" % "".join(parts))
            loading = node.next(node.reports, lambda r: "is being loaded" in " ".join(r.unknown_because))
            self.assertIsNotNone(loading)
            self.boxes.x = {"a": 0.0, "b": 10.0, "c": 20.0}
            self.assertIsNotNone(node.next(node.reports, lambda r: r.verdict == FREE))

            reset = rospy.ServiceProxy("/heavy/node/reset", Trigger)
            replies = []
            rospy.set_param("/heavy/heavy_robot", rospy.get_param("/heavy/heavy_robot").replace("scale='1 ", "scale='1.5 "))
            thread = threading.Thread(target=lambda: replies.append(reset()))
            before = len(node.reports)
            thread.start()
            thread.join()
            self.assertTrue(replies[0].success, replies[0].message)
            during = node.reports[before:]
            self.assertGreater(len(during), 5, "the cycle stood still")
            self.assertEqual({r.verdict for r in during}, {FREE}, "the old scene answers meanwhile")


def write_bumpy_sphere(file, count):
    """2 count^2 triangles that are not convex, as binary STL."""
    import numpy as np
    u, v = np.meshgrid(np.linspace(0, np.pi, count + 1), np.linspace(0, 2 * np.pi, count + 1), indexing="ij")
    r = 0.4 + 0.05 * np.sin(9 * u) * np.sin(8 * v)
    p = np.stack([r * np.sin(u) * np.cos(v), r * np.sin(u) * np.sin(v), r * np.cos(u)], axis=-1)
    quads = [p[:-1, :-1], p[1:, :-1], p[1:, 1:], p[:-1, :-1], p[1:, 1:], p[:-1, 1:]]
    corners = np.stack(quads, axis=2).reshape(-1, 3, 3)
    records = np.zeros(len(corners), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    records["corners"] = corners
    file.write(b"\0" * 80 + np.uint32(len(corners)).tobytes() + records.tobytes())
    file.flush()


if __name__ == "__main__":
    rospy.init_node("test_verdict")
    rostest.rosrun("collision_pairs", "verdict", VerdictTest)
