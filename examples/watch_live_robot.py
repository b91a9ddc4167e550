#!/usr/bin/python3
"""Checks a running robot in this process: reads robot_description and joint_states, prints each new verdict.

usage: watch_live_robot.py [--once]     --once: exits after the first verdict

The scene's settings are those of /collision_pairs_node, if it is running. Not checked: its clouds, further robots and
environment, the objects of ~update_scene, and the age of the joint states.
"""
import sys

import rospy
from sensor_msgs.msg import JointState

import collision_pairs as cp


class Watcher:
    def __init__(self):
        settings = rospy.get_param("/collision_pairs_node", {})
        self.detector = cp.Detector(cp.Scene(cp.Robot.from_parameters(), settings=settings))
        self.positions = {}
        self.text = None
        self.subscriber = rospy.Subscriber("joint_states", JointState, self.take, queue_size=1)

    def take(self, message):
        if len(message.name) != len(message.position):  # nobody knows which position is whose
            rospy.logwarn_throttle(5.0, "names and positions of a joint state differ in number: not used")
            return
        self.positions.update(reversed(list(zip(message.name, message.position))))  # the first of a name counts
        unknown = [joint for joint in self.detector.joints if joint not in self.positions]
        text = "UNKNOWN, nothing is known of " + ", ".join(unknown) if unknown else self.check()
        if text != self.text:
            rospy.loginfo(text)
            self.text = text
        if "--once" in sys.argv and not unknown:
            rospy.signal_shutdown("checked once")

    def check(self):
        result = self.detector.check([self.positions[joint] for joint in self.detector.joints])
        text = cp.Verdict(result.verdict).name
        for pair in result.pairs:
            state = cp.PairState(pair["state"]).name.lower()
            text += ", %s %s|%s" % (state, result.models[pair["first"]], result.models[pair["second"]])
        return text


if __name__ == "__main__":
    rospy.init_node("watch_live_robot")
    watcher = Watcher()
    rospy.spin()
