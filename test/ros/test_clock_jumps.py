#!/usr/bin/python3
"""The node under a simulated clock that goes back, as when a bag is played in a loop."""
import os
import sys
import time
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import rostest
from collision_pairs.msg import CollisionPairs
from collision_pairs.srv import CheckCollisions, CheckTrajectory, UpdateScene
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TransformStamped
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from tf2_msgs.msg import TFMessage
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from scene_client import SceneClient, add_box, attach, clear, detach

PATIENCE = 10.0  # s of wall time
STEP = 0.02      # s, of either time


class ClockJumpsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.clock = rospy.Publisher("/clock", Clock, queue_size=10)
        cls.tf = rospy.Publisher("/tf", TFMessage, queue_size=100)
        cls.reports = []
        rospy.Subscriber("/node/collision_pairs", CollisionPairs, cls.reports.append, queue_size=100)
        end = time.time() + PATIENCE
        while time.time() < end and not (cls.clock.get_num_connections() > 0 and cls.tf.get_num_connections() > 0):
            time.sleep(0.05)

        cls.without_clock = cls.answers_without_clock()

    @staticmethod
    def answers_without_clock():
        """What the node says before anything came on /clock, by where it says so."""
        check = rospy.ServiceProxy("/node/check_collisions", CheckCollisions)
        check_trajectory = rospy.ServiceProxy("/node/check_trajectory", CheckTrajectory)
        update = rospy.ServiceProxy("/node/update_scene", UpdateScene)
        diagnoses = []
        rospy.Subscriber("/diagnostics", DiagnosticArray, diagnoses.append)
        end = time.time() + PATIENCE
        while time.time() < end and "no robot" in check().message + check_trajectory().message:
            time.sleep(0.05)
        trajectory = JointTrajectory(joint_names=["slide_a"], points=[JointTrajectoryPoint(positions=[5.0])])
        answers = {"check_collisions": check().message,
                   "check_collisions of a joint": check(joint_state=JointState(name=["slide_a"], position=[0])).message,
                   "check_trajectory": " ".join(check_trajectory(trajectory=trajectory, links=["a"]).unknown_because),
                   "update_scene": update(changes=[add_box("crate", frame="elsewhere")]).message}
        del diagnoses[:]
        while time.time() < end and not diagnoses:
            time.sleep(0.05)
        answers["diagnostics"] = diagnoses[0].status[0].message
        return answers

    def test_that_there_is_no_clock_is_said_everywhere(self):
        for where, message in self.without_clock.items():
            self.assertIn("use_sim_time is set, but nothing was received on /clock", message, where)

    def publish(self, stamp, x):
        message = TFMessage()
        for i, name in enumerate("abc"):
            transform = TransformStamped()
            transform.header.stamp = rospy.Time.from_sec(stamp)
            transform.header.frame_id, transform.child_frame_id = "root", name
            transform.transform.translation.x = x * i
            transform.transform.rotation.w = 1.0
            message.transforms.append(transform)
        self.tf.publish(message)

    def play(self, begin, end, x):
        now = begin
        while now < end:
            self.clock.publish(Clock(rospy.Time.from_sec(now)))
            self.publish(now, x)
            time.sleep(STEP)
            now += STEP

    def newest(self):
        return self.reports[-1]

    def test_reports_follow_the_clock_back(self):
        self.play(100.0, 102.0, 5.0)
        self.assertGreater(self.newest().header.stamp.to_sec(), 101.5)
        self.play(50.0, 52.0, 0.5)
        report = self.newest()
        self.assertAlmostEqual(report.header.stamp.to_sec(), 52.0, delta=0.5)
        self.assertTrue(report.in_collision)

    def test_a_transform_that_comes_late_from_before_the_jump_does_not_hold_it(self):
        """Of two publishers one is a little slower: its last words arrive after the clock went back."""
        self.play(100.0, 102.0, 5.0)
        self.play(50.0, 50.2, 0.5)
        self.publish(101.99, 5.0)
        self.play(50.2, 52.0, 0.5)
        report = self.newest()
        self.assertAlmostEqual(report.header.stamp.to_sec(), 52.0, delta=0.5)
        self.assertTrue(report.in_collision)
        self.assertEqual(report.left_out, [])

    def test_reports_follow_the_clock_forward(self):
        self.play(50.0, 51.0, 5.0)
        self.play(500.0, 501.0, 0.5)
        report = self.newest()
        self.assertAlmostEqual(report.header.stamp.to_sec(), 501.0, delta=0.5)
        self.assertTrue(report.in_collision)

    def test_after_a_jump_back_nothing_old_is_reported_as_new(self):
        """The clock goes back and no transform comes yet: the links are left out, not at old places."""
        self.play(100.0, 101.0, 0.5)
        for i in range(25):
            self.clock.publish(Clock(rospy.Time.from_sec(50.0 + STEP * i)))
            time.sleep(STEP)
        report = self.newest()
        self.assertEqual(sorted(report.left_out), ["a", "b", "c"])
        self.assertEqual(report.verdict, CollisionPairs.UNKNOWN)

    def test_a_clock_that_stands_still_makes_the_verdict_unknown_until_it_goes_on(self):
        self.play(100.0, 101.0, 5.0)
        self.assertEqual(self.newest().verdict, CollisionPairs.FREE)
        time.sleep(2.0)
        self.assertEqual(self.newest().verdict, CollisionPairs.UNKNOWN)
        self.assertIn("/clock stands still", " ".join(self.newest().unknown_because))
        reply = rospy.ServiceProxy("/node/check_collisions", CheckCollisions)()
        self.assertEqual(reply.result.verdict, CollisionPairs.UNKNOWN)
        self.play(101.0, 101.5, 5.0)
        self.assertEqual(self.newest().verdict, CollisionPairs.FREE)

    def test_while_the_clock_stands_still_no_object_is_placed_where_something_is(self):
        scene = SceneClient("/node")
        self.play(100.0, 101.0, 5.0)
        scene.apply(add_box("held", (0.0, 5.0, 0.0)), attach("held", "a"))
        time.sleep(2.0)
        for change in (detach("held"), add_box("crate", frame="a"), add_box("crate", attached_link="b")):
            reply = scene.send(change)
            self.assertFalse(reply.success)
            self.assertIn("/clock stands still", reply.message)
        self.play(101.0, 101.5, 5.0)
        scene.apply(detach("held"))
        scene.apply(clear())

    def test_a_clock_that_runs_on_ages_the_poses(self):
        self.play(100.0, 101.0, 5.0)
        self.assertEqual(self.newest().verdict, CollisionPairs.FREE)
        for i in range(75):  # without a transform
            self.clock.publish(Clock(rospy.Time.from_sec(101.0 + STEP * i)))
            time.sleep(STEP)
        report = self.newest()
        self.assertEqual(report.verdict, CollisionPairs.UNKNOWN)
        self.assertIn("max_pose_age", " ".join(report.unknown_because))

    def test_00_before_the_clock_runs_the_verdict_is_unknown(self):
        """First by name: later there is a clock."""
        time.sleep(1.0)
        report = self.newest()
        self.assertEqual(report.verdict, CollisionPairs.UNKNOWN)
        self.assertIn("/clock", " ".join(report.unknown_because))


if __name__ == "__main__":
    rospy.init_node("test_clock_jumps", disable_rostime=True)
    rostest.rosrun("collision_pairs", "clock_jumps", ClockJumpsTest)
