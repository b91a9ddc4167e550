#!/usr/bin/python3
"""Plays recorded bags to a node, and compares what it reports of each stamp with the table of check_bag.

  bags_against_node.py [FOLDER] [--factor 0.5]

Prints a row a bag. FOLDER (default: the environment's COLLISION_PAIRS_SHARED) holds bags/ and robots/; without it only the
demo's bag is played. The node's ~trigger is tf, and --factor slows the clock so that it has time for each stamp. Of a bag without
transforms, robot_state_publisher makes them. Needs a built and sourced package. Exit code 1 if a verdict, a pair or what is left
out differs, a distance by more than 1e-9 m, or if less than 0.9 of the stamps were compared.
"""
import argparse
import csv
import os
import subprocess
import sys
import tempfile
import time

import rosbag
import rospy
from collision_pairs.msg import CollisionPair, CollisionPairs, Scene
from node_load import free_port
from rosgraph import Master

PROJECT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
TOOLS = os.environ.get("COLLISION_PAIRS_TOOLS", os.path.join(PROJECT, "build/devel/lib/collision_pairs"))
DEMO = os.path.join(PROJECT, "config/demo/demo")
VERDICTS = {CollisionPairs.FREE: "free", CollisionPairs.COLLISION: "collision", CollisionPairs.UNKNOWN: "unknown"}
ENOUGH = 0.9


def cases(folder):
    """(bag, urdf, srdf, alarm distance): the last wide enough to have something to compare."""
    yield DEMO + ".bag", DEMO + "_robot.urdf", DEMO + "_robot.srdf", 0.05
    if os.path.isdir(os.path.join(folder, "bags")):
        robots = os.path.join(folder, "robots")
        for bag, model, name, alarm in (("kuka_lwr", "lwr_model", "lwr", 0.4), ("pr2_pr1012", "pr2_model", "pr2_pr1012", 0.05)):
            yield (os.path.join(folder, "bags", bag + ".bag"), os.path.join(robots, model, "urdf", name + ".urdf"),
                   os.path.join(robots, model, "srdf", name + ".srdf"), alarm)


def check_bag(bag, urdf, srdf, alarm):
    """By stamp: its row."""
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "table.csv")
        subprocess.run([os.path.join(TOOLS, "check_bag"), bag, "--urdf", urdf, "--srdf", srdf, "--alarm-distance", str(alarm),
                        "--out", out], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        with open(out) as lines:
            return {int(row["stamp"].replace(".", "")): row for row in csv.DictReader(lines)}


def play(bag, urdf, srdf, alarm, factor):
    """By stamp: the last report of a node that heard the bag."""
    for name, path in (("robot_description", urdf), ("robot_description_semantic", srdf)):
        with open(path) as text:
            rospy.set_param(name, text.read())
    reports = {}
    started = [subprocess.Popen([os.path.join(TOOLS, "collision_pairs_node"), "_trigger:=tf", "_rate:=1000",
                                 "_alarm_distance:=%s" % alarm, "_fidelity:=mesh",
                                 "_allow_paused:=true"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)]
    with rosbag.Bag(bag) as opened:
        if "/tf" not in opened.get_type_and_topic_info().topics:
            started.append(subprocess.Popen(["rosrun", "robot_state_publisher", "robot_state_publisher", "_publish_frequency:=10000"],
                                            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))
    subscriber = rospy.Subscriber("/collision_pairs_node/collision_pairs", CollisionPairs, queue_size=10000,
                                  callback=lambda report: reports.__setitem__(report.header.stamp.to_nsec(), report))
    try:
        rospy.wait_for_message("/collision_pairs_node/scene", Scene, 60)
        subprocess.run(["rosbag", "play", "-q", "--clock", "--hz=1000", "--rate=%s" % factor, "--delay=2", bag,
                        "--topics", "/tf", "/tf_static", "/joint_states"], check=True, stdout=subprocess.DEVNULL)
        time.sleep(1.0)
        return reports
    finally:
        subscriber.unregister()
        for process in started:
            process.terminate()
            process.wait()


def said_by(report):
    """(verdict, pairs with their distances, pairs in contact, what is left out)."""
    pairs = {pair.first_link + "|" + pair.second_link: pair for pair in report.pairs}
    return (VERDICTS[report.verdict], {name: pair.distance for name, pair in pairs.items()},
            {name for name, pair in pairs.items() if pair.state != CollisionPair.NEAR}, set(report.left_out))


def said_by_row(row):
    parts = {column: list(filter(None, row[column].split(";"))) for column in ("distances", "pairs", "left_out")}
    distances = dict(entry.rsplit("=", 1) for entry in parts["distances"])
    return row["verdict"], {name: float(text) for name, text in distances.items()}, set(parts["pairs"]), set(parts["left_out"])


def differ(row, report):
    """Why the two differ (None: they agree), and by how much their distances do."""
    (verdict, distances, contacts, left_out), of_row = said_by(report), said_by_row(row)
    for what, ours, theirs in (("verdict", verdict, of_row[0]), ("pairs", set(distances), set(of_row[1])),
                               ("contacts", contacts, of_row[2]), ("left out", left_out, of_row[3])):
        if ours != theirs:
            return "%s: %s, in the table %s; unknown because %s, in the table %s" % (
                what, ours, theirs, report.unknown_because, row["unknown_because"]), 0.0
    return None, max([abs(distances[name] - of_row[1][name]) for name in distances], default=0.0)


def compared(path, urdf, srdf, alarm, factor):
    """Prints a row. True: they agree."""
    rows, reports = check_bag(path, urdf, srdf, alarm), play(path, urdf, srdf, alarm, factor)
    common = sorted(rows.keys() & reports.keys())
    outcomes = {stamp: differ(rows[stamp], reports[stamp]) for stamp in common}
    wrong = {stamp: why for stamp, (why, _) in outcomes.items() if why}
    furthest = max(distance for _, distance in outcomes.values()) if outcomes else float("inf")
    counts = [sum(row["verdict"] == verdict for row in rows.values()) for verdict in ("free", "collision", "unknown")]
    print("| %s | %d (%d, %d, %d) | %d | %d | %d | %.0e m |" %
          ((os.path.basename(path), len(rows)) + tuple(counts) + (len(common), len(reports.keys() - rows.keys()), len(wrong), furthest)),
          flush=True)
    for stamp, why in list(wrong.items())[:5]:
        print("  %.9f %s" % (1e-9 * stamp, why))
    return not wrong and furthest < 1e-9 and len(common) >= ENOUGH * len(rows)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("folder", nargs="?", default=os.environ.get("COLLISION_PAIRS_SHARED", ""))
    parser.add_argument("--factor", type=float, default=0.5)
    given = parser.parse_args()
    port = free_port()
    packages = [os.path.join(given.folder, "robots"), os.environ.get("ROS_PACKAGE_PATH", "")]
    os.environ.update(ROS_MASTER_URI="http://localhost:%d" % port, ROS_HOSTNAME="localhost", ROS_PACKAGE_PATH=":".join(packages))
    master = subprocess.Popen(["roscore", "-p", str(port)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        while not Master("/probe").is_online():
            time.sleep(0.2)
        rospy.set_param("use_sim_time", True)
        rospy.init_node("bags_against_node", disable_signals=True, disable_rostime=True)
        print("| bag | stamps (free, collision, unknown) | reported, too | reported only | different | distances, at most |")
        print("|---|---|---|---|---|---|")
        agree = [compared(*case, given.factor) for case in cases(given.folder)]
    finally:
        master.terminate()
        master.wait()
    return 0 if all(agree) else 1


if __name__ == "__main__":
    sys.exit(main())
