#!/usr/bin/python3
"""Calls of a nodelet fail that no input makes fail: the manager goes on, and the verdict is what was decided."""
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import roslib.packages
import rospy
import rostest

from collision_pairs.msg import CollisionPairs
from program import Program, wait_until
from test_nodelet import load
from transform_faults import BoxPublisher


class FailingNodeletTest(unittest.TestCase):
    def setUp(self):
        self.boxes = BoxPublisher("abc", "/cell/tf")
        self.boxes.heal()

    def tearDown(self):
        self.boxes.stop()
        self.manager.end()

    def start(self, name, failure):
        def path(package, file):
            return roslib.packages.find_node(package, file)[0]
        self.manager = Program("env", "LD_PRELOAD=" + path("collision_pairs", "failing_calls.so"), failure,
                               path("nodelet", "nodelet"), "manager", "__name:=" + name)
        return load("/cell/in_" + name, "/" + name)

    def test_an_exception_of_the_loop_does_not_end_the_manager_and_the_loop_begins_anew(self):
        node = self.start("interrupted", "FAILING_RUNS=2")
        self.assertIsNotNone(node.report_since(rospy.Time(0), lambda report: report.verdict == report.FREE))
        self.assertEqual(self.manager.said().count("run() fails on purpose"), 2)
        self.assertIsNone(self.manager.process.poll())

    def test_what_fails_to_be_drawn_does_not_change_what_was_decided(self):
        node = self.start("undrawn", "FAILING_DRAWING=1")
        self.assertIsNotNone(node.report_since(rospy.Time(0), lambda report: report.verdict == report.FREE))
        first = len(node.reports)
        wait_until(lambda: len(node.reports) >= first + 100, "reports")
        self.manager.wait_for("the markers are not drawn: drawing fails on purpose")
        self.assertEqual({report.verdict for report in node.reports[first:]}, {CollisionPairs.FREE})
        self.assertEqual({in_collision.data for in_collision in node.verdicts[-100:]}, {False})


if __name__ == "__main__":
    rospy.init_node("test_failing_nodelet")
    rostest.rosrun("collision_pairs", "failing_nodelet", FailingNodeletTest)
