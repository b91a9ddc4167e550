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
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from tf2_msgs.msg import TFMessage
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from scene_client import SceneClient, add_box, attach, clear, detach
from transform_faults import box_at

PATIENCE = 10.0             # s of wall time
STEP, WALL = 0.02, 0.005    # s of the clock, and of wall time: it runs four times as fast


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
        self.tf.publish(TFMessage([box_at(name, x * i, rospy.Time.from_sec(stamp)) for i, name in enumerate("abc")]))

    def play(self, begin, end, x):
        now = begin
        while now < end:
            self.clock.publish(Clock(rospy.Time.from_sec(now)))
            self.publish(now, x)
            time.sleep(WALL)
            now += STEP

    def wait_for(self, verdict, stamp, words=""):
        """The newest report is in time so, of about this stamp."""
        def holds(report):
            return (report.verdict == verdict and abs(report.header.stamp.to_sec() - stamp) < 0.5 and
                    words in " ".join(report.unknown_because))
        end = time.time() + PATIENCE
        while time.time() < end and not (self.reports and holds(self.reports[-1])):
            time.sleep(0.01)
        self.assertTrue(self.reports and holds(self.reports[-1]), self.reports[-1:])
        return self.reports[-1]

    def test_reports_follow_the_clock_back(self):
        self.play(100.0, 102.0, 5.0)
        self.wait_for(CollisionPairs.FREE, 102.0)
        self.play(50.0, 52.0, 0.5)
        self.wait_for(CollisionPairs.COLLISION, 52.0)

    def test_after_a_jump_back_nothing_old_is_reported_as_new(self):
        """The clock goes back and no transform comes yet: the links are left out, not at old places."""
        self.play(100.0, 101.0, 0.5)
        for i in range(25):
            self.clock.publish(Clock(rospy.Time.from_sec(50.0 + STEP * i)))
            time.sleep(WALL)
        self.assertEqual(sorted(self.wait_for(CollisionPairs.UNKNOWN, 50.5).left_out), ["a", "b", "c"])

    def test_a_clock_that_stands_still_makes_the_verdict_unknown_until_it_goes_on(self):
        self.play(100.0, 101.0, 5.0)
        self.wait_for(CollisionPairs.FREE, 101.0)
        self.wait_for(CollisionPairs.UNKNOWN, 101.0, "/clock stands still")
        reply = rospy.ServiceProxy("/node/check_collisions", CheckCollisions)()
        self.assertEqual(reply.result.verdict, CollisionPairs.UNKNOWN)
        self.play(101.0, 101.5, 5.0)
        self.wait_for(CollisionPairs.FREE, 101.5)

    def test_while_the_clock_stands_still_no_object_is_placed_where_something_is(self):
        scene = SceneClient("/node")
        self.play(100.0, 101.0, 5.0)
        scene.apply(add_box("held", (0.0, 5.0, 0.0)), attach("held", "a"))
        self.wait_for(CollisionPairs.UNKNOWN, 101.0, "/clock stands still")
        for change in (detach("held"), add_box("crate", frame="a"), add_box("crate", attached_link="b")):
            reply = scene.send(change)
            self.assertFalse(reply.success)
            self.assertIn("/clock stands still", reply.message)
        self.play(101.0, 101.5, 5.0)
        scene.apply(detach("held"))
        scene.apply(clear())

    def test_00_before_the_clock_runs_the_verdict_is_unknown(self):
        """First by name: later there is a clock."""
        self.wait_for(CollisionPairs.UNKNOWN, 0.0, "/clock")


if __name__ == "__main__":
    rospy.init_node("test_clock_jumps", disable_rostime=True)
    rostest.rosrun("collision_pairs", "clock_jumps", ClockJumpsTest)
