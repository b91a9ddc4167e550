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
PATIENCE = 90.0  # s of wall time for two passes and their beginnings
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
    number = r"-?\d+\.\d+(?:e[+-]?\d+)?|-?\d+e[+-]?\d+"
    text = str(report)
    return re.sub(number, "#", text), tuple(map(float, re.findall(number, text)))


class Passes:
    """Reports by pass of the clock, each pass a dictionary by stamp."""

    def __init__(self):
        self.reports = [{}]
        self._newest = rospy.Time(0)
        self._clock = rospy.Time(0)
        self.ended = 0
        rospy.Subscriber("/clock", Clock, self._on_clock, queue_size=1000)
        rospy.Subscriber("/collision_pairs_node/collision_pairs", CollisionPairs, self._on_report, queue_size=1000)

    def _on_clock(self, message):
        if message.clock < self._clock:
            self.ended += 1
        self._clock = message.clock

    def _on_report(self, report):
        if report.left_out:
            return  # before the first transforms of a pass
        stamp = report.header.stamp
        if stamp < self._newest:
            self.reports.append({})
        self._newest = stamp
        self.reports[-1].setdefault(stamp.to_nsec(), []).append(report)


class ReplayTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.passes = Passes()
        end = time.time() + PATIENCE
        while time.time() < end and cls.passes.ended < 2:
            time.sleep(0.1)
        cls.first, cls.second = cls.passes.reports[:2]
        with rosbag.Bag(BAG) as bag:
            cls.stamps = {m.header.stamp.to_nsec() for _, m, _ in bag.read_messages("/joint_states")}

    def test_every_report_of_the_second_pass_is_that_of_the_first(self):
        common = set(self.first) & set(self.second)
        self.assertGreater(len(common), 0.8 * len(self.stamps))
        # How far TF reaches back in the first moments of a pass depends on when the node came to hear it.
        in_both = max(min(self.first), min(self.second)) + 1e9 * WINDOW
        for stamp in common:
            contents = [content(report, stamp > in_both) for report in self.first[stamp] + self.second[stamp]]
            text, numbers = contents[0]
            for other_text, other_numbers in contents[1:]:
                self.assertEqual(text, other_text)
                # tf2 interpolates also at a stamp that it has: the last digit depends on whether
                # the next transform is there already.
                for a, b in zip(numbers, other_numbers):
                    self.assertAlmostEqual(a, b, places=12)

    def test_reports_are_of_the_stamps_of_the_bag_and_of_no_others(self):
        for reports in (self.first, self.second):
            self.assertEqual(set(reports) - self.stamps, set())

    def test_no_report_of_the_second_pass_was_made_from_poses_of_the_first(self):
        """Pass by pass the stamps go up, so each of the two is nearly whole."""
        self.assertGreater(len(self.second), 0.9 * len(self.stamps))

    def test_contacts_are_seen(self):
        said = {report.in_collision for reports in self.second.values() for report in reports}
        self.assertEqual(said, {False, True})


if __name__ == "__main__":
    rospy.init_node("test_replay", disable_rostime=True)
    rostest.rosrun("collision_pairs", "replay", ReplayTest)
