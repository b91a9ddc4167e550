#!/usr/bin/python3
"""The node beside a real roscore, robot_state_publisher and TF: the demo robot in chosen postures."""
import os
import subprocess
import sys
import unittest
import warnings

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from dynamic_reconfigure.client import Client
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

import collision_pairs as cp
from collision_pairs.msg import CollisionPair
from collision_pairs.srv import CheckCollisionsRequest, CheckTrajectory
from node_client import JointPublisher, NodeClient

JOINTS = ["shoulder_pan", "shoulder_lift", "upper_arm_roll", "elbow_flex", "forearm_roll",
          "wrist_flex", "wrist_roll", "gripper"]
FREE = [0, -0.3, 0, 1.2, 0, 0.9, 0, 0.02]
NEAR = [0.84, 0.75, 0, 0.75, 0, 0.4, 0, 0.02]
CONTACT = [0.3, 1.1, 0, 0.6, 0, -0.1, 1.35, 0]
SANITIZED = bool({"ASAN_OPTIONS", "TSAN_OPTIONS"} & set(os.environ))  # scripts/test --sanitize
POSTURES = {"free": FREE, "near": NEAR, "contact": CONTACT}


class NodeTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = JointPublisher(JOINTS)
        cls.node = NodeClient("/collision_pairs_node")

    def report_in(self, posture):
        since = self.robot.hold(posture)
        report = self.node.report_since(since, lambda r: r.nb_boxes and not r.left_out)  # none: the robot is not read yet
        self.assertIsNotNone(report, "no report of a posture")
        return report

    def assert_same_pairs(self, one, other):
        """TF interpolates, so the last digits of a pose differ from look-up to look-up."""
        names_and_states = [[(p.first_link, p.second_link, p.state) for p in report.pairs] for report in (one, other)]
        self.assertEqual(*names_and_states)
        for a, b in zip(one.pairs, other.pairs):
            self.assertAlmostEqual(a.distance, b.distance, places=9)

    def request(self, **fields):
        return self.node.check(CheckCollisionsRequest(**fields))

    def test_postures_are_free_near_and_in_contact(self):
        self.assertEqual(len(self.report_in(FREE).pairs), 0)
        near = self.report_in(NEAR)
        self.assertEqual([pair.state for pair in near.pairs], [CollisionPair.NEAR])
        self.assertEqual((near.pairs[0].first_link, near.pairs[0].second_link), ("forearm", "post"))
        contact = self.report_in(CONTACT)
        self.assertTrue(contact.in_collision)
        self.assertIn(("arch", "wrist_ball"), [(p.first_link, p.second_link) for p in contact.pairs])
        self.assertLess(contact.min_distance, 0.0)

    def test_topic_and_service_agree_on_every_stamp(self):
        for posture in POSTURES.values():
            report = self.report_in(posture)
            reply = self.request(stamp=report.header.stamp)
            self.assertTrue(reply.success, reply.message)
            self.assertEqual(reply.result.header.stamp, report.header.stamp)
            self.assert_same_pairs(reply.result, report)
            self.assertEqual(reply.result.nb_pairs, report.nb_pairs)
            self.assertEqual(reply.result.in_collision, report.in_collision)

    def test_bool_follows_the_report(self):
        for posture in (FREE, CONTACT):
            report = self.report_in(posture)
            verdict = self.node.next(self.node.verdicts)
            self.assertEqual(verdict.data, report.in_collision)

    def test_a_past_stamp_is_answered_for_that_instant(self):
        past = self.report_in(CONTACT)
        self.report_in(FREE)
        reply = self.request(stamp=past.header.stamp)
        self.assertTrue(reply.success, reply.message)
        self.assert_same_pairs(reply.result, past)

    def test_a_hypothetical_state_is_what_the_robot_would_be_in_and_does_not_move_it(self):
        self.report_in(FREE)
        reply = self.request(joint_state=JointState(name=JOINTS, position=CONTACT))
        self.assertTrue(reply.success, reply.message)
        self.assertEqual(reply.joints_from_tf, [])
        self.assertFalse(self.node.next(self.node.reports).in_collision)
        real = self.report_in(CONTACT)
        self.assert_same_pairs(reply.result, real)

    @unittest.skipIf(SANITIZED, "an interpreter without the sanitizer cannot load the module")
    def test_python_beside_the_node_answers_as_its_service(self):
        self.report_in(FREE)
        detector = cp.Detector(cp.Scene(cp.Robot.from_parameters(), settings=rospy.get_param("/collision_pairs_node")))
        for posture in POSTURES.values():
            served = self.request(joint_state=JointState(name=JOINTS, position=posture), alarm_distance=0.1).result
            own = detector.check(posture, JOINTS, alarm_distance=0.1)
            self.assertEqual(own.verdict, served.verdict)
            self.assertEqual([(p.first_link, p.second_link, p.state) for p in served.pairs],
                             [(own.models[p["first"]], own.models[p["second"]], p["state"]) for p in own.pairs])
            for a, b in zip(served.pairs, own.pairs):
                self.assertAlmostEqual(a.distance, b["distance"], places=9)

    @unittest.skipIf(SANITIZED, "an interpreter without the sanitizer cannot load the module")
    def test_python_does_not_use_an_srdf_further_up_than_the_urdf(self):
        box = "<link name='%s'><collision><geometry><box size='1 1 1'/></geometry></collision></link>"
        joint = "<joint name='to_%s' type='continuous'><parent link='%s'/><child link='%s'/></joint>"
        rospy.set_param("/left/robot_description", "<robot name='demo_robot'>%s</robot>" % (
            "".join(box % name for name in "abc") + "".join(joint % (child, parent, child) for parent, child in ("ab", "bc"))))
        off = "<robot name='demo_robot'>%s</robot>" % "".join(
            "<disable_collisions link1='%s' link2='%s'/>" % tuple(pair) for pair in ("ab", "bc", "ac"))
        for semantic, is_used in (("/left/robot_description_semantic", True), ("/robot_description_semantic", False)):
            before = rospy.get_param(semantic, "")
            rospy.set_param(semantic, off)
            try:
                with warnings.catch_warnings(record=True) as said:
                    warnings.simplefilter("always")
                    robot = cp.Robot.from_parameters("/left/robot_description", semantic[1:])
                    beside = cp.Robot.from_parameters("/left/robot_description", semantic)
            finally:
                rospy.set_param(semantic, before) if before else rospy.delete_param(semantic)
            self.assertEqual(any("is not used: it may be of another robot" in str(one.message) for one in said), not is_used)
            verdicts = [cp.Detector(cp.Scene(one)).check([0.0, 0.0], ["to_b", "to_c"]).verdict for one in (robot, beside)]
            self.assertEqual(verdicts[0] == cp.Verdict.COLLISION, not is_used)
            self.assertNotEqual(verdicts[1], cp.Verdict.COLLISION)

    @unittest.skipIf(SANITIZED, "an interpreter without the sanitizer cannot load the module")
    def test_the_example_of_a_live_robot_sees_the_verdict(self):
        example = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../examples/watch_live_robot.py")
        for posture, verdict in ((FREE, "FREE"), (CONTACT, "COLLISION")):
            self.report_in(posture)
            said = subprocess.run([sys.executable, example, "--once"], timeout=60, stdout=subprocess.PIPE, text=True)
            self.assertIn(verdict, said.stdout)
        self.assertIn("contact arch|wrist_ball", said.stdout)

    def test_a_gradient_is_the_difference_quotient_of_the_distance_for_each_joint_of_the_request(self):
        self.report_in(FREE)
        names = ["elbow_flex", "shoulder_pan", "wrist_roll"]  # not all, and not in the URDF's order
        given = [NEAR[JOINTS.index(name)] for name in names]
        rest = [name for name in JOINTS if name not in names]

        def pairs(positions, **fields):
            state = JointState(name=names + rest, position=positions + [NEAR[JOINTS.index(n)] for n in rest])
            reply = self.request(joint_state=state, alarm_distance=0.15, **fields)
            self.assertTrue(reply.success, reply.message)
            return {(p.first_link, p.second_link): p for p in reply.result.pairs}

        found = pairs(given, gradient=True)
        self.assertGreater(len(found), 1)
        for pair in found.values():
            self.assertEqual(len(pair.gradient), len(JOINTS))
        tolerant = pairs(given, gradient=True, tolerance=0.01)  # counts as 0
        self.assertEqual({name: pair.gradient for name, pair in tolerant.items()},
                         {name: pair.gradient for name, pair in found.items()})
        step = 1e-4
        for i in range(len(names)):
            ahead, behind = (pairs([p + s * (j == i) for j, p in enumerate(given)]) for s in (step, -step))
            for name in found.keys() & ahead.keys() & behind.keys():
                slope = (ahead[name].distance - behind[name].distance) / (2.0 * step)
                self.assertAlmostEqual(found[name].gradient[i], slope, delta=1e-5, msg=str((name, names[i])))
        self.assertGreater(max(abs(g) for pair in found.values() for g in pair.gradient), 0.1)
        self.assertEqual({len(pair.gradient) for pair in pairs(given).values()}, {0})

    def test_a_trajectory_is_answered_as_its_points_one_by_one(self):
        self.report_in(FREE)
        check = rospy.ServiceProxy("/collision_pairs_node/check_trajectory", CheckTrajectory)
        points = [[a + (b - a) * i / 40.0 for a, b in zip(FREE, CONTACT)] for i in range(41)]
        trajectory = JointTrajectory(joint_names=JOINTS, points=[JointTrajectoryPoint(positions=p) for p in points])
        reply = check(trajectory=trajectory, want_reports=True)
        self.assertTrue(reply.success, reply.message)
        self.assertEqual((reply.in_collision[0], reply.in_collision[-1]), (False, True))
        for i, point in enumerate(points):
            single = self.request(joint_state=JointState(name=JOINTS, position=point)).result
            self.assertEqual(reply.in_collision[i], single.in_collision)
            self.assertAlmostEqual(reply.min_distance[i], single.min_distance, places=12)
            self.assert_same_pairs(reply.reports[i], single)
        trajectory.points[7].positions = points[7][:-1]
        refused = check(trajectory=trajectory)
        self.assertFalse(refused.success)
        self.assertIn("point 7", refused.message)
        self.assertEqual(len(refused.in_collision), 0)

    def test_settings_of_a_request_are_its_own(self):
        self.report_in(NEAR)
        self.assertEqual(len(self.request(alarm_distance=-1.0).result.pairs), 0)
        wide = self.request(alarm_distance=0.5)
        self.assertEqual(wide.result.alarm_distance, 0.5)
        self.assertGreater(len(wide.result.pairs), 3)
        cheap = self.request(fidelity="aabb", alarm_distance=0.5)
        self.assertEqual(cheap.result.fidelity, "aabb")
        self.assertLessEqual(cheap.result.min_distance, wide.result.min_distance)
        self.assertAlmostEqual(self.node.next(self.node.reports).alarm_distance, 0.03)

    def test_wrong_requests_are_refused_by_name_and_the_cycle_goes_on(self):
        self.report_in(FREE)
        nan = float("nan")
        cases = {
            "elbow_joint": dict(joint_state=JointState(name=["elbow_joint"], position=[0.0])),
            "arm_base_joint": dict(joint_state=JointState(name=["arm_base_joint"], position=[0.0])),
            "not finite": dict(joint_state=JointState(name=["shoulder_pan"], position=[nan])),
            "positions": dict(joint_state=JointState(name=["shoulder_pan"], position=[])),
            "twice": dict(joint_state=JointState(name=["gripper", "gripper"], position=[0.0, 0.0])),
            "exact": dict(fidelity="exact"),
            "gradient needs a joint_state": dict(gradient=True),
            "cannot be combined with verdict_only": dict(joint_state=JointState(name=["gripper"], position=[0.0]), gradient=True,
                                          verdict_only=True),
            "alarm_distance": dict(alarm_distance=nan),
            "tolerance": dict(tolerance=nan),
            "extrapolation": dict(stamp=rospy.Time.now() + rospy.Duration(100)),
        }
        for says, fields in cases.items():
            reply = self.request(**fields)
            self.assertFalse(reply.success, says)
            self.assertIn(says, reply.message)
        self.assertIsNotNone(self.node.next(self.node.reports))

    def test_every_reconfigured_parameter_takes_effect(self):
        client = Client("/collision_pairs_node", timeout=20)
        self.report_in(NEAR)
        before = client.get_configuration()
        told = {"alarm_distance": 1e-4, "tolerance": 0.001, "time_budget": 0.4, "fidelity": "convex", "min_distance": True}
        try:
            client.update_configuration(dict(told, rate=4.0))
            report = self.node.next(self.node.reports, lambda r: r.alarm_distance == told["alarm_distance"])
            for field in ("tolerance", "time_budget", "fidelity"):
                self.assertEqual(getattr(report, field), told[field])
            self.assertFalse(report.min_distance_is_bound)
            self.assertGreater(self.seconds_between_reports(), 0.2)
            client.update_configuration({"rate": 50.0, "min_distance": False})
            self.assertIsNotNone(self.node.next(self.node.reports, lambda r: r.min_distance_is_bound))
            client.update_configuration({"alarm_distance": 0.3})
            self.assertIsNotNone(self.node.next(self.node.reports, lambda r: r.pairs))
            client.update_configuration({"verdict_only": True})
            self.assertIsNotNone(self.node.next(self.node.reports, lambda r: not r.pairs))  # but contacts
        finally:
            client.update_configuration({key: before[key] for key in (*told, "rate", "verdict_only")})

    def test_at_a_slow_rate_a_change_is_seen_at_once_and_markers_last_three_periods(self):
        client = Client("/collision_pairs_node", timeout=20)
        self.report_in(CONTACT)
        try:
            client.update_configuration({"rate": 0.1})
            array = self.node.next(self.node.marker_arrays, lambda a: a.markers[0].lifetime.to_sec() > 2.0)
            self.assertEqual({marker.lifetime.to_sec() for marker in array.markers}, {30.0})
        finally:
            begin = rospy.get_time()
            client.update_configuration({"rate": 50.0})
            self.assertIsNotNone(self.node.next(self.node.reports))
        self.assertLess(rospy.get_time() - begin, 9.0, "the period that has ended")

    def seconds_between_reports(self):
        """Of two that follow each other; the least of three, since a message may be lost."""
        stamps = [self.node.next(self.node.reports).header.stamp.to_sec() for _ in range(4)]
        return min(after - before for before, after in zip(stamps, stamps[1:]))

    def test_reset_reads_the_robot_anew(self):
        self.report_in(FREE)
        reply = rospy.ServiceProxy("/collision_pairs_node/reset", Trigger)()
        self.assertTrue(reply.success, reply.message)
        self.report_in(CONTACT)

    def test_diagnostics_tell_the_health_of_the_node(self):
        statuses = []
        rospy.Subscriber("/diagnostics", DiagnosticArray, lambda m: statuses.extend(m.status))
        self.report_in(FREE)
        end = rospy.get_time() + 10
        while rospy.get_time() < end and not statuses:
            rospy.sleep(0.1)
        values = {value.key: value.value for value in statuses[-1].values}
        self.assertEqual(statuses[-1].level, 0, statuses[-1].message)
        self.assertEqual(int(values["nb_boxes"]), 22)
        self.assertEqual((statuses[-1].name, statuses[-1].hardware_id), ("collision_pairs_node: collision check", "none"))


if __name__ == "__main__":
    rospy.init_node("test_node")
    rostest.rosrun("collision_pairs", "node", NodeTest)
