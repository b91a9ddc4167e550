#!/usr/bin/python3
"""What check_bag says of a recording is what the node said that heard the same: transforms, clouds, scenes in random orders."""
import csv
import math
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

import roslib.packages
import rospy
import rostest
import tf2_msgs.msg
from collision_pairs.msg import CollisionPairs, Scene, SceneChange
from collision_pairs.srv import UpdateScene
from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import PointCloud2

from cloud_client import cloud_of
from node_client import PATIENCE
from scene_client import add, box, change
from seed import given_seed

CHECK_BAG = roslib.packages.find_node("collision_pairs", "check_bag")[0]
VERDICTS = {CollisionPairs.FREE: "free", CollisionPairs.COLLISION: "collision", CollisionPairs.UNKNOWN: "unknown"}
NB_RECORDINGS = 20 if "COLLISION_PAIRS_LONG" in os.environ else 10
LENGTH = 1.5    # s, of one
PERIOD = 0.02   # s
UNSURE = 0.25   # s around what reaches node and recorder at slightly different times
SOURCE_TIMEOUT = 0.5  # s, of recorded.test: after it a cloud ends at slightly different times, too


class Sender:
    """A robot of three boxes, a camera and somebody who changes the scene."""

    def __init__(self, dice):
        self.dice = dice
        self.tf = rospy.Publisher("/tf", tf2_msgs.msg.TFMessage, queue_size=100)
        self.tf_static = rospy.Publisher("/tf_static", tf2_msgs.msg.TFMessage, queue_size=10, latch=True)
        self.clouds = rospy.Publisher("/eye", PointCloud2, queue_size=10)
        self.update = rospy.ServiceProxy("/live/update_scene", UpdateScene)
        self.unsure = []  # times at which something else than a transform was sent, or fell silent
        self.objects = {}
        self.nb_objects = 0

    def begin(self):
        self.tf_static.publish([self.transform("camera", 0.0, rospy.Time.now())])

    @staticmethod
    def transform(link, x, stamp):
        made = TransformStamped(child_frame_id=link)
        made.header.frame_id, made.header.stamp = "root", stamp
        made.transform.translation.x, made.transform.rotation.w = x, 1.0
        return made

    def note(self):
        self.unsure.append(rospy.get_time())

    def change_scene(self):
        choice = self.dice.random()
        attached = [name for name, link in self.objects.items() if link]
        standing = [name for name, link in self.objects.items() if not link]
        if choice < 0.4 or not self.objects:
            self.nb_objects += 1
            name = "object_%d" % self.nb_objects
            self.objects[name] = ""
            made = add(name, (self.dice.uniform(-5, 5), self.dice.uniform(1, 2), 0), primitives=[box(0.5, 0.5, 0.5)])
        elif choice < 0.6 and standing:
            name = self.dice.choice(standing)
            self.objects[name] = self.dice.choice("abc")
            made = change(SceneChange.ATTACH, name, attached_link=self.objects[name])
        elif choice < 0.8 and attached:
            name = self.dice.choice(attached)
            self.objects[name] = ""
            made = change(SceneChange.DETACH, name)
        else:
            name = self.dice.choice(sorted(self.objects))
            del self.objects[name]
            made = change(SceneChange.REMOVE, name)
        self.note()
        self.update([made], True)
        self.note()

    def record(self):
        """For some seconds, well and badly."""
        dice = self.dice
        offsets, slow = [dice.uniform(-4, 4) for _ in range(3)], [dice.uniform(0.2, 1.0) for _ in range(3)]
        silent_link = dice.choice(["a", "b", "c", None, None])
        silence = sorted(dice.uniform(0.0, LENGTH) for _ in range(2))
        lag = dice.choice([0.0, 0.0, 0.01, 0.2])
        cloud_period = dice.choice([0.1, 0.2, 0.4])
        blind = sorted(dice.uniform(0.0, LENGTH) for _ in range(2)) if dice.random() < 0.4 else (9.0, 9.0)
        changes = sorted(dice.uniform(0.0, LENGTH) for _ in range(dice.randrange(3)))
        began, next_cloud, was_silent = rospy.get_time(), 0.0, False
        self.note()
        while rospy.get_time() - began < LENGTH and not rospy.is_shutdown():
            t = rospy.get_time() - began
            stamp = rospy.Time.now() - rospy.Duration(lag)
            is_silent = silent_link is not None and silence[0] < t < silence[1]
            if is_silent != was_silent:
                self.note()
            was_silent = is_silent
            self.tf.publish([self.transform(link, offset + math.sin(speed * t), stamp)
                             for link, offset, speed in zip("abc", offsets, slow)
                             if not (is_silent and link == silent_link)])
            if t >= next_cloud:
                next_cloud += cloud_period
                if not blind[0] < t < blind[1]:
                    points = [(dice.uniform(-5, 5), 0.7, 0.0) for _ in range(dice.randrange(4))]
                    self.note()
                    self.clouds.publish(cloud_of(points, "camera"))
            if changes and t >= changes[0]:
                changes.pop(0)
                self.change_scene()
            rospy.sleep(PERIOD)


def said_by(report):
    pairs = {frozenset((pair.first_link, pair.second_link)): pair.distance for pair in report.pairs}
    return VERDICTS[report.verdict], pairs


def said_by_row(row):
    pairs = {}
    for pair in filter(None, row["distances"].split(";")):
        names, distance = pair.rsplit("=", 1)
        pairs[frozenset(names.split("|"))] = float(distance)
    return row["verdict"], pairs


def agree(a, b):
    return a[0] == b[0] and a[1].keys() == b[1].keys() and all(abs(a[1][key] - b[1][key]) < 1e-6 for key in a[1])


def is_unsure(at, events):
    return any(abs(at - when) < UNSURE or abs(at - when - SOURCE_TIMEOUT) < 0.1 for when in events)


class RecordedTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.wait_for_service("/live/update_scene", PATIENCE)
        rospy.wait_for_message("/live/scene", Scene, PATIENCE)
        cls.folder = tempfile.TemporaryDirectory()
        bag = os.path.join(cls.folder.name, "live.bag")
        reports = {}
        subscriber = rospy.Subscriber("/live/collision_pairs", CollisionPairs, queue_size=10000,
                                      callback=lambda report: reports.__setitem__(report.header.stamp.to_nsec(), report))
        recorder = subprocess.Popen(["rosbag", "record", "-q", "-b", "0", "-O", bag, "/tf", "/tf_static", "/eye", "/live/scene"])
        sender = Sender(random.Random(given_seed()))
        end = time.time() + PATIENCE
        while min(sender.tf.get_num_connections(), sender.clouds.get_num_connections()) < 2 and time.time() < end:
            time.sleep(0.1)
        time.sleep(1.0)
        sender.begin()
        time.sleep(0.5)
        for _ in range(NB_RECORDINGS):
            sender.record()
        time.sleep(0.5)
        subscriber.unregister()
        recorder.send_signal(signal.SIGINT)
        recorder.wait(PATIENCE)
        end = time.time() + PATIENCE
        while not os.path.exists(bag) and time.time() < end:  # Debian 13's rosbag ends before its recorder has closed the bag
            time.sleep(0.1)
        out = os.path.join(cls.folder.name, "out.csv")
        cls.done = subprocess.run([CHECK_BAG, bag, "--out", out, "--alarm-distance", "0.5"], stdout=subprocess.PIPE,
                                  stderr=subprocess.STDOUT, text=True, timeout=120)
        with open(out) as table:
            cls.rows = {int(row["stamp"].replace(".", "")): row for row in csv.DictReader(table)}
        cls.reports = dict(reports)
        cls.unsure = sender.unsure

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_the_last_report_of_each_stamp_is_that_of_the_table(self):
        self.assertEqual(self.done.returncode, 0, self.done.stdout)
        nb_equal = nb_unsure = 0
        verdicts, wrong = set(), []
        for stamp in sorted(self.rows.keys() & self.reports.keys()):
            row, report = self.rows[stamp], self.reports[stamp]
            if agree(said_by_row(row), said_by(report)):
                nb_equal += 1
                verdicts.add(row["verdict"])
            elif is_unsure(1e-9 * stamp, self.unsure):
                nb_unsure += 1
            else:
                wrong.append((stamp, said_by_row(row), said_by(report), row["unknown_because"], report.unknown_because))
        print("%d stamps: %d equal, %d where something had just been sent" % (len(self.rows), nb_equal, nb_unsure))
        self.assertEqual(wrong, [])
        self.assertEqual(verdicts, {"free", "collision", "unknown"})
        self.assertGreater(nb_equal, 5 * nb_unsure)
        self.assertGreater(nb_equal, 0.5 * NB_RECORDINGS * LENGTH / PERIOD)

    def test_the_table_has_the_stamps_that_the_node_reported(self):
        of_poses = [stamp for stamp, report in self.reports.items() if len(report.left_out) < 3]
        missing = [stamp for stamp in of_poses if stamp not in self.rows]
        self.assertLess(len(missing), 0.02 * len(of_poses))


if __name__ == "__main__":
    rospy.init_node("recorded_test")
    rostest.rosrun("collision_pairs", "recorded_test", RecordedTest)
