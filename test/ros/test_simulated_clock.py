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
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray
from tf2_msgs.msg import TFMessage

from collision_pairs.msg import SpeedLimit
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
        rospy.set_param("/own/velocity_limiter", {"command": "/command", "joints": ["slide_a"], "deceleration": 2.0})
        cls.node = Program(NODE, "__name:=own")
        wait_until(lambda: cls.command.get_num_connections() > 0 and cls.tf.get_num_connections() > 0, "the node")

    @classmethod
    def tearDownClass(cls):
        cls.node.end()

    def at(self, now, condition, places=(), joint_stamp=None, commands=True):
        """Says the time, the places of boxes, and a command, until the condition holds."""
        def said():
            self.clock.publish(Clock(rospy.Time(now)))
            message = TFMessage([box_at(name, x) for name, x in places])
            for transform in message.transforms:
                transform.header.stamp = rospy.Time(now)
            self.tf.publish(message)
            if joint_stamp is not None:
                state = JointState(name=["slide_a"], position=[0.0])
                state.header.stamp = rospy.Time(joint_stamp)
                self.joint_states.publish(state)
            if commands:
                self.command.publish(Float64MultiArray(data=[0.1]))
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

    def test_2_a_joint_state_is_as_old_as_it_will_be_when_the_decision_is_made(self):
        boxes = list(zip("abc", (0.0, 3.0, 6.0)))
        self.at(110.0, lambda: self.limits[-1].reason == "", boxes, 110.0)
        self.at(111.0, lambda: self.limits[-1].reason == "the joint state is 1.020000 s old", boxes)
        self.at(112.0, lambda: self.limits[-1].reason == "", boxes, 112.0)

    def test_3_a_clock_that_goes_back_leaves_no_joint_state(self):
        boxes = list(zip("abc", (0.0, 3.0, 6.0)))
        self.at(50.0, lambda: self.limits[-1].reason == "nobody reports joint 'slide_a'", boxes)
        self.at(51.0, lambda: self.limits[-1].reason == "", boxes, 51.0)

    def test_4_nothing_passes_while_the_clock_stands_still(self):
        boxes = list(zip("abc", (0.0, 3.0, 6.0)))
        self.at(60.0, lambda: self.limits[-1].reason == "", boxes, 60.0)
        self.at(60.0, lambda: "/clock stands still" in self.limits[-1].reason, boxes, 60.0)
        self.assertEqual((self.limits[-1].scale, self.limits[-1].verdict), (0.0, SpeedLimit.UNKNOWN))
        self.at(61.0, lambda: self.limits[-1].reason == "", boxes, 61.0)

    def test_5_a_clock_that_went_back_between_two_commands_leaves_no_joint_state(self):
        boxes = list(zip("abc", (0.0, 3.0, 6.0)))

        def without_commands(now, joint_stamp=None):
            end = time.time() + 0.5
            self.at(now, lambda: time.time() > end, boxes, joint_stamp, commands=False)
        self.at(70.0, lambda: self.limits[-1].reason == "", boxes, 70.0)
        without_commands(40.0)
        self.at(70.05, lambda: self.limits[-1].reason == "nobody reports joint 'slide_a'", boxes)
        without_commands(200.0, joint_stamp=200.0)
        self.at(150.0, lambda: self.limits[-1].reason == "nobody reports joint 'slide_a'", boxes)
        self.at(151.0, lambda: self.limits[-1].reason == "", boxes, 151.0)


if __name__ == "__main__":
    rospy.init_node("test_simulated_clock", disable_rostime=True)
    rostest.rosrun("collision_pairs", "simulated_clock", SimulatedClockTest)
