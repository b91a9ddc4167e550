#!/usr/bin/python3
"""Checks recorded bags with check_bag and asks the node's service about some of their stamps.

  bags_against_service.py [FOLDER]

Prints a row a bag (docs/tools.md): what was found, how long it took, and how far the service's
distances are from the table's. FOLDER (default: the environment's COLLISION_PAIRS_SHARED) holds
bags/ and robots/; without it only the demo's bag is checked. Needs a built and sourced package.
Exit code 1 if a pair or state differs, or a distance by more than 1e-9 m.
"""
import csv
import os
import socket
import subprocess
import sys
import tempfile
import time

import rosbag
import rospy
from collision_pairs.msg import CollisionPair
from collision_pairs.srv import CheckCollisions, CheckCollisionsRequest
from rosgraph import Master
from tf2_msgs.msg import TFMessage

PROJECT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
TOOLS = os.environ.get("COLLISION_PAIRS_TOOLS", os.path.join(PROJECT, "build/devel/lib/collision_pairs"))
DEMO = os.path.join(PROJECT, "config/demo/demo")
NB_STAMPS = 5
WINDOW = 1.5  # s of transforms published about a stamp


def cases(folder):
    """(bag, urdf, srdf, alarm distance): the last wide enough to have something to compare."""
    yield DEMO + ".bag", DEMO + "_robot.urdf", DEMO + "_robot.srdf", 0.05
    if os.path.isdir(os.path.join(folder, "bags")):
        robots = os.path.join(folder, "robots")
        for bag, model, name, alarm in (("kuka_lwr", "lwr_model", "lwr", 0.4), ("pr2_pr1012", "pr2_model", "pr2_pr1012", 0.05)):
            yield (os.path.join(folder, "bags", bag + ".bag"), os.path.join(robots, model, "urdf", name + ".urdf"),
                   os.path.join(robots, model, "srdf", name + ".srdf"), alarm)


def check_bag(bag, urdf, srdf, alarm, folder):
    out = os.path.join(folder, "table.csv")
    start = time.time()
    subprocess.run([os.path.join(TOOLS, "check_bag"), bag, "--urdf", urdf, "--srdf", srdf, "--alarm-distance",
                    str(alarm), "--out", out], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    seconds = time.time() - start
    with open(out) as lines:
        return list(csv.DictReader(lines)), seconds


def chosen(rows):
    """Stamps to ask about: evenly over the middle of the bag, and the closest one."""
    rows = rows[len(rows) // 6:-len(rows) // 6]
    closest = min(rows, key=lambda row: float(row["min_distance"] or "inf"))
    return [rows[i * len(rows) // (NB_STAMPS - 1)] for i in range(NB_STAMPS - 1)] + [closest]


def stamp_of(row):
    return rospy.Time(*map(int, row["stamp"].split(".")))


class Node:
    """A node of its own for one robot."""

    def __init__(self, urdf, srdf):
        for name, path in (("robot_description", urdf), ("robot_description_semantic", srdf)):
            with open(path) as text:
                rospy.set_param(name, text.read())
        self._process = subprocess.Popen([os.path.join(TOOLS, "collision_pairs_node")],
                                         stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self._tf = rospy.Publisher("/tf", TFMessage, queue_size=1000)
        rospy.wait_for_service("/collision_pairs_node/check_collisions", 30)
        self._check = rospy.ServiceProxy("/collision_pairs_node/check_collisions", CheckCollisions)
        while not self._check(CheckCollisionsRequest()).message or self._tf.get_num_connections() == 0:
            time.sleep(0.1)
        time.sleep(3.0)  # until it has loaded the robot

    def close(self):
        self._process.terminate()
        self._process.wait()
        self._tf.unregister()

    def ask(self, bag, row, alarm):
        stamp = stamp_of(row)
        request = CheckCollisionsRequest(stamp=stamp, alarm_distance=alarm, fidelity="mesh")
        transforms = [m for _, m, _ in bag.read_messages(["/tf", "/tf_static"]) if self._near(m, stamp)]
        for message in transforms:
            self._tf.publish(message)
            time.sleep(0.002)
        time.sleep(0.3)
        if not transforms:
            request.stamp = rospy.Time(0)
            request.joint_state = next(m for _, m, _ in bag.read_messages("/joint_states") if m.header.stamp == stamp)
        reply = self._check(request)
        if not reply.success:
            sys.exit("the service says: " + reply.message)
        return {pair.first_link + "|" + pair.second_link: pair for pair in reply.result.pairs}

    @staticmethod
    def _near(message, stamp):
        for transform in message.transforms:
            if abs((transform.header.stamp - stamp).to_sec()) < WINDOW:
                return True
        return False


def publish_static(bag):
    """Static transforms for the node's whole life."""
    from tf2_ros import StaticTransformBroadcaster
    transforms = [t for _, m, _ in bag.read_messages("/tf_static") for t in m.transforms]
    broadcaster = StaticTransformBroadcaster()
    if transforms:
        broadcaster.sendTransform(transforms)
    return broadcaster


def compare(row, pairs):
    """Largest difference of a distance; infinite where pairs or states differ."""
    expected = dict(entry.rsplit("=", 1) for entry in filter(None, row["distances"].split(";")))
    contacts = set(filter(None, row["pairs"].split(";")))
    if set(pairs) != set(expected) or contacts != {name for name, pair in pairs.items() if pair.state != CollisionPair.NEAR}:
        return float("inf")
    return max([abs(pairs[name].distance - float(expected[name])) for name in pairs], default=0.0)


def main(folder):
    with socket.socket() as probe:
        probe.bind(("", 0))
        port = probe.getsockname()[1]
    os.environ["ROS_MASTER_URI"] = "http://localhost:%d" % port
    master = subprocess.Popen(["roscore", "-p", str(port)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    worst = 0.0
    try:
        while not Master("/probe").is_online():
            time.sleep(0.2)
        rospy.init_node("bags_against_service", disable_signals=True)
        print("| bag | duration | stamps | with a contact | closest | time taken | faster than real time | service, %d stamps |" % NB_STAMPS)
        for case in cases(folder):
            worst = max(worst, report(*case))
    finally:
        master.terminate()
        master.wait()
    return 0 if worst < 1e-9 else 1


def report(path, urdf, srdf, alarm):
    with tempfile.TemporaryDirectory() as folder:
        rows, seconds = check_bag(path, urdf, srdf, alarm, folder)
    duration = float(rows[-1]["stamp"]) - float(rows[0]["stamp"])
    with rosbag.Bag(path) as bag:
        broadcaster = publish_static(bag)
        node = Node(urdf, srdf)
        try:
            difference = max(compare(row, node.ask(bag, row, alarm)) for row in sorted(chosen(rows), key=stamp_of))
        finally:
            node.close()
            del broadcaster
    closest = min(float(row["min_distance"] or "inf") for row in rows)
    print("| %s | %.1f s | %d | %d | %+.4f m | %.2f s | %.0fx | %.0e m |" %
          (os.path.basename(path), duration, len(rows), sum(row["in_collision"] == "1" for row in rows), closest,
           seconds, duration / seconds, difference), flush=True)
    return difference


if __name__ == "__main__":
    sys.exit(main(sys.argv[1] if len(sys.argv) > 1 else os.environ.get("COLLISION_PAIRS_SHARED", "")))
