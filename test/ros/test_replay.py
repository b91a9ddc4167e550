#!/usr/bin/python3
"""A bag that is played in a loop: every pass gives the same reports, and the table's."""
import copy
import os
import re
import sys
import time
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rosbag
import rospy
import rostest
from collision_pairs.msg import CollisionPairs
from rosgraph_msgs.msg import Clock

BAG = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../config/demo/demo.bag")
PATIENCE = 170.0  # s of wall time, of which two passes take about 10
ENOUGH = 0.8      # of the stamps, to be seen in two passes
WINDOW = 0.1  # s of TF before a report that say how fast its links moved
TIMES = ("time_transforms", "time_boxes", "time_broad_phase", "time_narrow_phase", "time_total")


def content(report, with_motion):
    """All of it but how long it took and its number: what is no decimal fraction, and what is."""
    report = copy.deepcopy(report)
    for name in TIMES:
        setattr(report, name, 0.0)
    report.header.seq = 0
    if not with_motion:
        report.time_to_contact, report.time_to_contact_is_known = 0.0, False
        for pair in report.pairs:
            pair.closing_speed, pair.closing_speed_is_known = 0.0, False
    # On two parallel faces the closest points may be anywhere: the last digit of a rotation decides.
    for contact in (contact for pair in report.pairs for contact in pair.contacts):
        for axis in "xyz":
            setattr(contact.second_point, axis, getattr(contact.second_point, axis) - getattr(contact.first_point, axis))
            setattr(contact.first_point, axis, 0.0)
    number = r"-?\d+\.\d+(?:e[+-]?\d+)?|-?\d+e[+-]?\d+"
    text = str(report)
    return re.sub(number, "#", text), tuple(map(float, re.findall(number, text)))


def distances(report):
    return [report.min_distance] + [pair.distance for pair in report.pairs]


class Passes:
    """Reports by pass of the clock, each pass a dictionary by stamp."""

    def __init__(self):
        self.reports = [{}]
        self._newest = rospy.Time(0)
        self._clock = rospy.Time(0)
        self.ended = 0
        self._subscribers = [
            rospy.Subscriber("/clock", Clock, self._on_clock, queue_size=1000),
            rospy.Subscriber("/collision_pairs_node/collision_pairs", CollisionPairs, self._on_report, queue_size=1000)]

    def end(self):
        for subscriber in self._subscribers:
            subscriber.unregister()

    def seen_twice(self):
        """{stamp: the passes that have reports of it}, two or more."""
        passes = list(self.reports)
        stamps = set().union(*map(set, passes))
        found = {stamp: [reports for reports in passes if stamp in reports] for stamp in stamps}
        return {stamp: having for stamp, having in found.items() if len(having) > 1}

    def _on_clock(self, message):
        if message.clock < self._clock:
            self.ended += 1
        self._clock = message.clock

    def _on_report(self, report):
        stamp = report.header.stamp
        if report.left_out or stamp == self._newest == rospy.Time(0):
            return  # before the first transforms of a pass, or the first clock
        if stamp < self._newest:
            self.reports.append({})
        self._newest = stamp
        self.reports[-1].setdefault(stamp.to_nsec(), []).append(report)


class ReplayTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with rosbag.Bag(BAG) as bag:
            cls.stamps = {m.header.stamp.to_nsec() for _, m, _ in bag.read_messages("/joint_states")}
        cls.passes = Passes()
        end = time.time() + PATIENCE
        # A busy machine misses stamps in each pass, and others in the next.
        while time.time() < end and len(cls.passes.seen_twice()) <= ENOUGH * len(cls.stamps):
            time.sleep(0.5)
        cls.passes.end()

    def test_every_report_of_a_later_pass_is_that_of_the_first(self):
        common = self.passes.seen_twice()
        self.assertGreater(len(common), ENOUGH * len(self.stamps))
        for stamp, passes in common.items():
            # How far TF reaches back in the first moments of a pass depends on when the node came to hear it.
            with_motion = all(stamp > min(reports) + 1e9 * WINDOW for reports in passes)
            contents = [content(report, with_motion) for reports in passes for report in reports[stamp]]
            text, numbers = contents[0]
            for other_text, other_numbers in contents[1:]:
                self.assertEqual(text, other_text)
                # tf2 interpolates also at a stamp that it has: the last digit of a pose depends on whether
                # the next transform is there already. Where a distance is least it changes with the square of
                # the way along the surface: closest points are as uncertain as the root of such a digit.
                for a, b in zip(numbers, other_numbers):
                    self.assertAlmostEqual(a, b, delta=1e-6)
            all_distances = [distances(report) for reports in passes for report in reports[stamp]]
            for others in all_distances[1:]:
                for a, b in zip(all_distances[0], others):
                    self.assertAlmostEqual(a, b, delta=1e-9)

    def test_reports_are_of_the_stamps_of_the_bag_and_of_no_others(self):
        for reports in self.passes.reports:
            self.assertEqual(set(reports) - self.stamps, set())

    def test_no_report_of_a_pass_was_made_from_poses_of_the_one_before(self):
        """Its stamp would be late, and the next one early again: one pass more than the clock had."""
        self.assertGreater(self.passes.ended, 0)
        self.assertLessEqual(len(self.passes.reports), self.passes.ended + 1)

    def test_contacts_are_seen(self):
        said = {report.in_collision for passes in self.passes.seen_twice().values() for reports in passes
                for of_stamp in reports.values() for report in of_stamp}
        self.assertEqual(said, {False, True})


if __name__ == "__main__":
    rospy.init_node("test_replay", disable_rostime=True)
    rostest.rosrun("collision_pairs", "replay", ReplayTest)
