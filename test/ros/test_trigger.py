#!/usr/bin/python3
"""With ~trigger: tf, cycles begin when transforms arrive, and not in between."""
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import rostest
from dynamic_reconfigure.client import Client
from node_client import NodeClient
from tf2_msgs.msg import TFMessage
from transform_faults import APART, TOUCHING, box_at

RATE, COUNT, PAUSE = 1000.0, 40, 0.03  # Hz, messages, and seconds between two: less than the idle period


class TriggerTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.node = NodeClient("/node")
        cls.publisher = rospy.Publisher("/tf", TFMessage, queue_size=100)
        while not cls.publisher.get_num_connections():
            rospy.sleep(0.05)

    def publish(self, places):
        message = TFMessage([box_at(name, x) for name, x in sorted(places.items())])
        stamp = message.transforms[0].header.stamp
        for transform in message.transforms:
            transform.header.stamp = stamp
        self.publisher.publish(message)
        return stamp

    def test_each_message_has_its_report_and_there_are_few_others(self):
        self.assertIsNotNone(self.node.report_since(self.publish(APART) - rospy.Duration(1e-6)))
        first, begin = len(self.node.reports), rospy.get_time()
        stamps = []
        for i in range(COUNT):
            stamps.append(self.publish(TOUCHING if i % 2 else APART))
            rospy.sleep(PAUSE)
        self.assertIsNotNone(self.node.report_since(stamps[-1] - rospy.Duration(1e-6)))
        reports, took = self.node.reports[first:], rospy.get_time() - begin
        in_contact = {report.header.stamp: report.in_collision for report in reports}
        # Two messages that the network delivers at once may share one.
        seen = [stamp for stamp in stamps if stamp in in_contact]
        self.assertGreater(len(seen), 0.8 * COUNT)
        for i, stamp in enumerate(stamps):
            self.assertEqual(in_contact.get(stamp, bool(i % 2)), bool(i % 2))
        self.assertLess(len(reports), 0.2 * RATE * took)

    def test_without_transforms_reports_go_on_and_end_as_unknown(self):
        self.publish(APART)
        self.assertIsNotNone(self.node.next(self.node.reports, lambda report: report.left_out))
        first = len(self.node.reports)
        rospy.sleep(1.0)
        times = sorted(self.node.received[id(report)] for report in self.node.reports[first:])
        gaps = sorted(after - before for before, after in zip(times, times[1:]))
        self.assertGreater(gaps[len(gaps) // 2], 0.04)

    def test_many_transforms_are_checked_at_most_at_the_rate(self):
        client = Client("/node", timeout=20)
        try:
            client.update_configuration({"rate": 10.0})
            first, begin = len(self.node.reports), rospy.get_time()
            for _ in range(100):
                self.publish(APART)
                rospy.sleep(0.01)
            self.assertLessEqual(len(self.node.reports) - first, 10.0 * (rospy.get_time() - begin) + 2)
        finally:
            client.update_configuration({"rate": RATE})


if __name__ == "__main__":
    rospy.init_node("test_trigger")
    rostest.rosrun("collision_pairs", "trigger", TriggerTest)
