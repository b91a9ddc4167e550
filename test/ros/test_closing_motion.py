#!/usr/bin/python3
"""How fast near pairs come nearer, and when they can touch at the earliest, by a robot that moves."""
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import rostest
from sensor_msgs.msg import JointState

from collision_pairs.msg import CollisionPairs
from node_client import NodeClient, PATIENCE
from scene_client import SceneClient, add_box, clear

SPEED = 0.2  # m/s


class MovingRobot:
    """Slides a along x, at the speed that it is given, from where it is put; b and c stand far away."""

    def __init__(self):
        self._publisher = rospy.Publisher("joint_states", JointState, queue_size=1)
        self.go(0.0, 0.0)
        self._timer = rospy.Timer(rospy.Duration(0.02), self._publish)

    def go(self, x, speed):
        self._x, self._speed, self._since = x, speed, rospy.Time.now()

    def _publish(self, _):
        now = rospy.Time.now()
        x = self._x + self._speed * (now - self._since).to_sec()
        message = JointState(name=["slide_a", "slide_b", "slide_c"], position=[x, 20, 30])
        message.header.stamp = now
        self._publisher.publish(message)


class ClosingMotionTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = MovingRobot()
        cls.node = NodeClient("/node")
        cls.scene = SceneClient("/node")

    def setUp(self):
        """A wall whose near side is at x = 5; a's front is half a metre before its origin."""
        self.scene.apply(clear(), add_box("wall", (5.5, 0, 0), (1, 4, 4)))

    def report(self, x, speed, **fields):
        """Of a, which has gone on for more than the window."""
        self.robot.go(x, speed)
        rospy.sleep(0.4)
        end = rospy.get_time() + PATIENCE
        while rospy.get_time() < end:
            result = self.node.check(alarm_distance=2.0, **fields).result
            if len(result.pairs) == 1 and result.pairs[0].closing_speed_is_known:
                return result
        self.fail("no report with a known closing speed")

    def test_the_cycle_says_it_as_well(self):
        self.report(4.2, 0.0)  # what is put there is fast for as long as the window
        self.robot.go(4.2, SPEED)
        near = self.node.next(self.node.reports, lambda r: r.pairs and r.verdict == CollisionPairs.FREE)
        self.assertAlmostEqual(near.pairs[0].closing_speed, SPEED, places=2)
        self.assertTrue(near.time_to_contact_is_known)
        self.assertLess(near.time_to_contact, 0.06 / SPEED)
        contact = self.node.next(self.node.reports, lambda r: r.verdict == CollisionPairs.COLLISION)
        self.assertEqual((contact.time_to_contact, contact.time_to_contact_is_known), (0.0, True))
        self.assertAlmostEqual(contact.pairs[0].closing_speed, SPEED, places=2)

    def test_what_is_not_known_is_zero_and_marked(self):
        self.report(4.0, 0.0)
        state = JointState(name=["slide_a"], position=[4.0])
        asked = self.node.check(joint_state=state, alarm_distance=2.0).result
        self.assertEqual((asked.verdict, len(asked.pairs)), (CollisionPairs.FREE, 1))
        only_contacts = self.node.check(alarm_distance=-1.0).result
        quick = self.node.check(alarm_distance=2.0, verdict_only=True).result
        for result in (asked, only_contacts, quick):
            self.assertEqual((result.time_to_contact, result.time_to_contact_is_known), (0.0, False))
            for pair in result.pairs:
                self.assertEqual((pair.closing_speed, pair.closing_speed_is_known), (0.0, False))


if __name__ == "__main__":
    rospy.init_node("test_closing_motion")
    rostest.rosrun("collision_pairs", "closing_motion", ClosingMotionTest)
