#!/usr/bin/python3
"""Markers and reports against brute force over the published boxes."""
import itertools
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import rostest
from dynamic_reconfigure.client import Client

from node_client import JointPublisher, NodeClient, boxes_by_namespace, gap

ALARM = 0.25


class BoxesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = JointPublisher(["slide_a", "slide_b", "slide_c"])
        cls.node = NodeClient("/boxes")

    def test_markers_carry_as_many_investigated_boxes_as_nb_pairs_involves(self):
        for x, expected_pairs in (([0, 3, 6], 0), ([0, 1.2, 6], 1), ([0, 1.2, 2.4], 2), ([0, 0.5, 0.9], 3)):
            since = self.robot.hold(x)
            report = self.node.report_since(since, lambda r: not r.left_out)
            array = self.node.next(self.node.marker_arrays,
                                   lambda a: a.markers and a.markers[0].header.stamp > since)
            kinds = boxes_by_namespace(array)
            boxes = {i: box for kind in kinds.values() for i, box in kind.items()}
            self.assertEqual(len(boxes), 3)
            close = [(i, j) for i, j in itertools.combinations(boxes, 2) if gap(boxes[i], boxes[j]) <= ALARM]
            self.assertEqual(len(close), expected_pairs)
            self.assertEqual(report.nb_pairs, expected_pairs)
            shown = set(kinds.get("investigated_boxes", {})) | set(kinds.get("boxes_in_contact", {}))
            self.assertEqual(shown, {i for pair in close for i in pair})

    def test_every_cycle_is_published_also_when_nothing_is_close(self):
        self.robot.hold([0, 3, 6])
        before = len(self.node.reports)
        rospy.sleep(0.6)
        self.assertGreater(len(self.node.reports) - before, 15)
        self.assertEqual(self.node.reports[-1].pairs, [])
        self.assertTrue(self.node.reports[-1].min_distance_is_bound)
        self.assertAlmostEqual(self.node.reports[-1].min_distance, ALARM)

    def test_a_reconfiguration_takes_effect_at_once_however_long_a_cycle_is(self):
        client = Client("/boxes", timeout=20)
        since = self.robot.hold([0, 1.2, 6])
        self.assertIsNotNone(self.node.report_since(since, lambda r: not r.left_out))

        def first_array_after(change):
            begin, before = rospy.get_time(), len(self.node.marker_arrays)
            client.update_configuration(change)
            while len(self.node.marker_arrays) == before and rospy.get_time() < begin + 5.0:
                rospy.sleep(0.01)
            rospy.sleep(0.5)  # the cycle that each change begins is over
            return self.node.marker_arrays[before]

        try:
            first_array_after({"rate": 0.1})
            self.assertEqual(self.node.marker_arrays[-1].markers[0].lifetime.to_sec(), 30.0)
            for hide in (True, False):
                stamp = self.node.reports[-1].header.stamp
                array = first_array_after({"show_only_investigated_boxes": hide})
                self.assertEqual("other_boxes" in boxes_by_namespace(array), not hide)
                self.assertIn("investigated_boxes", boxes_by_namespace(array))
                self.assertGreater(array.markers[0].header.stamp, stamp, "of the cycle that the change begins")
        finally:
            begin = rospy.get_time()
            client.update_configuration({"rate": 50.0, "show_only_investigated_boxes": False})
        self.assertIsNotNone(self.node.next(self.node.reports))
        self.assertLess(rospy.get_time() - begin, 5.0)


if __name__ == "__main__":
    rospy.init_node("test_boxes")
    rostest.rosrun("collision_pairs", "boxes", BoxesTest)
