#!/usr/bin/python3
"""A bag that is played from its middle on: the robot stands on its table all the same."""
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import rostest
from node_client import NodeClient


CONTACT = ("arch", "wrist_ball")


def pairs_of(report):
    return [(pair.first_link, pair.second_link) for pair in report.pairs]


class LateStartTest(unittest.TestCase):
    def test_no_link_is_left_out_and_the_contact_is_seen(self):
        node = NodeClient("/collision_pairs_node")
        report = node.next(node.reports, lambda r: not r.left_out and r.in_collision and CONTACT in pairs_of(r))
        self.assertIsNotNone(report, "no report of the contact with all links")
        self.assertGreater(report.header.stamp.to_sec(), 1004.3)


if __name__ == "__main__":
    rospy.init_node("test_late_start", disable_rostime=True)
    rostest.rosrun("collision_pairs", "late_start", LateStartTest)
