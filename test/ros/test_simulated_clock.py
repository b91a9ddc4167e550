#!/usr/bin/python3
"""What the node counts in seconds of a simulated clock: repeated warnings, and the ages that its limiter knows."""
import os
import sys
import time
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import rostest
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState, PointCloud2
from std_msgs.msg import Float64MultiArray
from tf2_msgs.msg import TFMessage

from cloud_client import cloud_of
from collision_pairs.msg import CollisionPairs, SpeedLimit
from program import NODE, Program, wait_until
from transform_faults import box_at

LEFT_OUT, STOPPED = "left out, no usable transform", "a command is stopped"


class SimulatedClockTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.clock = rospy.Publisher("/clock", Clock, queue_size=10)
        cls.tf = rospy.Publisher("/tf", TFMessage, queue_size=10)
        cls.joint_states = rospy.Publisher("/joint_states", JointState, queue_size=10)
        cls.command = rospy.Publisher("/command", Float64MultiArray, queue_size=1)
        cls.limits = []
        rospy.Subscriber("/own/speed_limit", SpeedLimit, cls.limits.append)
        rospy.set_param("/own/velocity_limiter", {"command": "/command", "joints": ["slide_a"], "deceleration": 2.0,
                                                  "ramp_up": 1000.0, "tracking_tolerance": 10.0})
        cls.node = Program(NODE, "__name:=own")
        wait_until(lambda: cls.command.get_num_connections() > 0 and cls.tf.get_num_connections() > 0, "the node")

    @classmethod
    def tearDownClass(cls):
        cls.node.end()

    def at(self, now, condition, places=(), joint_stamp=None, command=0.1, tick=0.001):
        """Says the time, the places of boxes, where a is, and a command, until the condition holds."""
        def said():
            nonlocal now
            now += tick
            self.clock.publish(Clock(rospy.Time.from_sec(now)))
            message = TFMessage([box_at(name, x) for name, x in places])
            for transform in message.transforms:
                transform.header.stamp = rospy.Time.from_sec(now)
            self.tf.publish(message)
            if joint_stamp is not None:
                state = JointState(name=["slide_a"], position=[dict(places)["a"]])
                state.header.stamp = rospy.Time.from_sec(joint_stamp)
                self.joint_states.publish(state)
            if command is not None:
                self.command.publish(Float64MultiArray(data=[command]))
            return condition()
        wait_until(said, "the node at %s s" % now)

    def counts(self):
        return [self.node.said().count(words) for words in (LEFT_OUT, STOPPED)]

    def test_1_warnings_that_last_are_repeated_every_five_seconds(self):
        self.at(100.0, lambda: self.counts() == [1, 1])
        end = time.time() + 1.0
        self.at(104.5, lambda: time.time() > end)
        self.assertEqual(self.counts(), [1, 1])
        self.at(105.5, lambda: self.counts() == [2, 2])

    def test_5_a_clock_that_went_back_between_two_commands_leaves_no_joint_state(self):
        boxes = list(zip("abc", (0.0, 3.0, 6.0)))

        def without_commands(now, joint_stamp=None):
            end = time.time() + 0.5
            self.at(now, lambda: time.time() > end, boxes, joint_stamp, None)
        self.at(70.0, lambda: self.limits[-1].reason == "", boxes, 70.0)
        without_commands(70.01)  # until zeros have been passed, and nobody looks at the clock
        without_commands(40.0)
        self.at(70.05, lambda: self.limits[-1].reason == "nobody reports joint 'slide_a'", boxes)
        without_commands(200.0, joint_stamp=200.0)
        self.at(150.0, lambda: self.limits[-1].reason == "nobody reports joint 'slide_a'", boxes)
        self.at(151.0, lambda: self.limits[-1].reason == "", boxes, 151.0)

    def test_6_what_was_passed_before_the_clock_went_back_still_moves_the_robot(self):
        """It may go on towards b for 10 cm, and 25 to stop, whatever is commanded next."""
        far, near = (list(zip("abc", (x, 3.0, 6.0))) for x in (0.0, 1.8))
        # An answer to this command, and not to the last one of the test before.
        self.at(300.0, lambda: self.limits[-1].stamp.to_sec() > 300.0 and self.limits[-1].reason == "", far, 300.0, 1.0)
        for now in (300.05, 299.9, 250.0):  # the last two are steps back
            begin = len(self.limits)
            time.sleep(0.1)  # topics keep no order: a joint state that comes after the step is of the future
            self.at(now, lambda: any({limit.first_link, limit.second_link} == {"a", "b"} and limit.scale < 0.5
                                     for limit in self.limits[begin:]), near, now, -1.0)
        self.at(400.0, lambda: self.limits[-1].reason == "", far, 400.0)

    def test_8_a_cloud_that_came_before_the_clock_went_back_is_none_of_after(self):
        """Two wait for transforms at their stamps, one behind the other; these come when the clock was set back."""
        reports, far = [], list(zip("abc", (0.0, 3.0, 6.0)))
        camera = rospy.Publisher("/camera/points", PointCloud2, queue_size=2)
        rospy.Subscriber("/seeing/collision_pairs", CollisionPairs, reports.append)
        rospy.set_param("/seeing/clouds", [{"topic": "/camera/points", "voxel_size": 0.1, "max_range": 50.0,
                                            "source_timeout": 5.0}])
        seeing = Program(NODE, "__name:=seeing")

        def said(words):
            return reports and words in " ".join(reports[-1].unknown_because)
        try:
            self.at(600.0, lambda: camera.get_num_connections() > 0 and said("none has arrived yet"), far, command=None)
            self.clock.publish(Clock(rospy.Time.from_sec(600.6)))
            time.sleep(0.2)
            for stamp in (600.5, 600.51):
                camera.publish(cloud_of([(0.0, 5.0, 0.0)], "root", rospy.Time.from_sec(stamp)))
                time.sleep(0.1)
            self.at(600.3, lambda: said("it came before the clock went back"), far, command=None)
            begin, end = len(reports), time.time() + 1.5
            self.at(600.6, lambda: time.time() > end, far, command=None)
            self.assertEqual({report.verdict for report in reports[begin:]}, {CollisionPairs.UNKNOWN})
            camera.publish(cloud_of([(0.0, 5.0, 0.0)], "root", rospy.Time.from_sec(600.7)))
            self.at(600.7, lambda: reports[-1].verdict == CollisionPairs.FREE, far, command=None)
        finally:
            seeing.end()

    def test_9_a_clock_that_is_late_stops_the_robot_and_says_so(self):
        """It pauses while joint states and commands go on: their stamps say how much time has passed."""
        boxes = list(zip("abc", (0.0, 3.0, 6.0)))
        self.at(700.0, lambda: self.limits[-1].reason == "", boxes, 700.0)
        begin = len(self.limits)
        self.at(700.0, lambda: "slide_a' is stamped 0.15 s ahead of the clock" in self.limits[-1].reason, boxes, 700.15,
                tick=0.0)
        self.assertEqual((self.limits[-1].scale, self.limits[-1].verdict), (0.0, SpeedLimit.UNKNOWN))
        self.at(700.0, lambda: len(self.limits) > begin + 20, boxes, 700.05, tick=0.0)  # late, and not the newest
        self.assertEqual({limit.scale for limit in self.limits[-10:]}, {0.0})
        self.at(701.0, lambda: self.limits[-1].reason == "", boxes, 701.0)

    def test_9_b_nothing_passes_once_no_time_is_heard_of_for_the_time_of_a_command(self):
        boxes = list(zip("abc", (0.0, 3.0, 6.0)))
        self.at(710.0, lambda: self.limits[-1].reason == "", boxes, 710.0)
        stamps = iter(range(1, 10**6))

        def heard():  # the clock stands still, and joint states go on a little
            self.joint_states.publish(JointState(
                header=rospy.Header(stamp=rospy.Time.from_sec(710.05 + 1e-6 * next(stamps))), name=["slide_a"],
                position=[0.0]))
            return "of wall time, and no joint state is later" in self.limits[-1].reason
        begin, end = len(self.limits), time.time() + 0.5
        self.at(710.0, lambda: heard() or time.time() > end, boxes, tick=0.0)
        self.assertFalse(any("no joint state is later" in limit.reason for limit in self.limits[begin:]))
        self.at(710.0, lambda: "/clock stands still" in self.limits[-1].reason, boxes, tick=0.0)
        self.assertEqual(self.limits[-1].scale, 0.0)
        self.at(711.0, lambda: self.limits[-1].reason == "", boxes, 711.0)


if __name__ == "__main__":
    rospy.init_node("test_simulated_clock", disable_rostime=True)
    rostest.rosrun("collision_pairs", "simulated_clock", SimulatedClockTest)
