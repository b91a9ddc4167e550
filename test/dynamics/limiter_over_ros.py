#!/usr/bin/python3
"""The velocity limiter's node beside a robot with mass in real time; prints rows as limiter_dynamics runs does.

usage: limiter_over_ros.py [ROBOT...] [--servo ramp|PI] [--seconds 60] [--factor F] [--pauses] [--steps] [--busy N] [--seed N]
                           ROBOT: demo, panda, ur5; F: of a simulated clock, 0 for wall time

For each robot it measures the servo (limiter_dynamics steps, measure_stopping), and starts limiter.launch with what came out,
robot_state_publisher and dynamic_robot, which moves, commands and judges the robot; N processes compute beside them. Run it in
the environment of the built package, with the benchmarks built. COLLISION_PAIRS_SHARED names the folder with the robots.
"""
import argparse
import os
import re
import subprocess
import sys
import tempfile

import rosbag

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "benchmark"))
from node_load import Robot

SHARED, PROJECT = os.environ.get("COLLISION_PAIRS_SHARED", ""), os.path.dirname(os.path.dirname(HERE))
TRANSPORT = 0.03  # s, that steps without ROS do not have: belongs to reaction_time
MODELS = {"panda": "panda_model", "ur5": "ur_model"}


def files(name):
    if name == "demo":
        return [os.path.join(PROJECT, "config/demo/demo_robot." + kind) for kind in ("urdf", "srdf")]
    return [os.path.join(SHARED, "robots", MODELS[name], kind, name + "." + kind) for kind in ("urdf", "srdf")]


def program(name):
    found = subprocess.run(["catkin_find", "--first-only", "--libexec", "collision_pairs", name], check=True,
                           stdout=subprocess.PIPE, text=True)
    return found.stdout.strip()


def measured(name, servo, folder):
    """The file of the limiter's parameters that measure_stopping writes."""
    bag, out = os.path.join(folder, "steps.bag"), os.path.join(folder, "limiter.yaml")
    subprocess.run([program("limiter_dynamics"), "steps", bag, name, servo], check=True, stdout=subprocess.DEVNULL)
    with rosbag.Bag(bag) as content:
        names = next(content.read_messages("/joint_states")).message.name
    subprocess.run([program("measure_stopping"), bag, "--joints", *names, "--out", out], check=True,
                   stderr=subprocess.DEVNULL)
    with open(out) as text:
        limiter = re.sub(r"reaction_time: ([0-9.]+)", lambda found: "reaction_time: %.3f" % (float(found[1]) + TRANSPORT), text.read())
    with open(out, "w") as text:
        text.write(limiter)
    return out


def run(name, options):
    with tempfile.TemporaryDirectory() as folder, Robot(*files(name)) as running:
        limiter = measured(name, options.servo, folder)
        if options.factor:
            subprocess.run(["rosparam", "set", "/use_sim_time", "true"], check=True)
        subprocess.run(["rosparam", "set", "/collision_pairs_node/allow_paused", "false"], check=True)
        running.start("robot_state_publisher", "robot_state_publisher")
        running.run("roslaunch", "collision_pairs", "limiter.launch", "limiter:=" + limiter, "limited:=/limited_command")
        for _ in range(options.busy):
            running.run(sys.executable, "-c", "while True: pass")
        subprocess.run([program("dynamic_robot"), "_robot:=" + name, "_servo:=" + options.servo,
                        "_seconds:=%g" % options.seconds, "_factor:=%g" % options.factor, "_seed:=%d" % options.seed,
                        "_pauses:=%s" % str(options.pauses).lower(), "_steps:=%s" % str(options.steps).lower()], check=True)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("robots", nargs="*", default=["demo", *(MODELS if SHARED else [])])
    parser.add_argument("--servo", default="ramp")
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--factor", type=float, default=0.0)
    parser.add_argument("--pauses", action="store_true")
    parser.add_argument("--steps", action="store_true")
    parser.add_argument("--busy", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    os.environ["ROS_PACKAGE_PATH"] = os.path.join(SHARED, "robots") + ":" + os.environ.get("ROS_PACKAGE_PATH", "")
    print("robot,servo,seconds,contacts,nearest,nearest_links,passed", flush=True)
    for name in options.robots:
        run(name, options)


if __name__ == "__main__":
    sys.exit(main())
