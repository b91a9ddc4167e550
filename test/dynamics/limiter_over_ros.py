#!/usr/bin/python3
"""The velocity limiter's node beside a robot with mass in real time; prints a table (scripts/measure_limiter --over-ros).

usage: limiter_over_ros.py [ROBOT...] [--servo ramp|PI] [--seconds 60] [--factor F] [--pauses] [--steps] [--seed N]
                           [--busy N] [--nice N] [--late S] [--no-real-time]
                           ROBOT: demo, panda, ur5; F: of a simulated clock, 0 for wall time

For each robot it measures the servo (limiter_dynamics steps, measure_stopping), and starts limiter.launch with what came out,
robot_state_publisher and dynamic_robot, which moves, commands and judges the robot; --busy processes with that niceness compute
beside them. --late: seconds that messages are on their way, of which steps without ROS know nothing. --no-real-time: the
limiter and its guard are not permitted real-time scheduling. Standard error: how late the robot was, and what ~speed_limit said
how often. Run it in the environment of the built package, with the benchmarks built. COLLISION_PAIRS_SHARED names the folder with
the robots.
"""
import argparse
import os
import re
import subprocess
import sys
import tempfile

import rosbag

HERE = os.path.dirname(os.path.abspath(__file__))
PROJECT = os.path.dirname(os.path.dirname(HERE))
sys.path.insert(0, os.path.join(PROJECT, "benchmark"))
from node_load import Robot

SHARED = os.environ.get("COLLISION_PAIRS_SHARED", "")
STATE_AGE = 0.1  # s: the default of max_joint_state_age
NO_REAL_TIME = ["setpriv", "--bounding-set", "-sys_nice", "--inh-caps", "-sys_nice"]
MODELS = {"panda": "panda_model", "ur5": "ur_model"}


def files(name):
    if name == "demo":
        return [os.path.join(PROJECT, "config/demo/demo_robot." + kind) for kind in ("urdf", "srdf")]
    return [os.path.join(SHARED, "robots", MODELS[name], kind, name + "." + kind) for kind in ("urdf", "srdf")]


def program(name):
    found = subprocess.run(["catkin_find", "--first-only", "--libexec", "collision_pairs", name], check=True,
                           stdout=subprocess.PIPE, text=True)
    return found.stdout.strip()


def measured(name, servo, late, folder):
    """The file of the limiter's parameters that measure_stopping writes, for messages that are `late`."""
    bag, out = os.path.join(folder, "steps.bag"), os.path.join(folder, "limiter.yaml")
    subprocess.run([program("limiter_dynamics"), "steps", bag, name, servo], check=True, stdout=subprocess.DEVNULL)
    with rosbag.Bag(bag) as content:
        names = next(content.read_messages("/joint_states")).message.name
    subprocess.run([program("measure_stopping"), bag, "--joints", *names, "--out", out], check=True,
                   stderr=subprocess.DEVNULL)
    with open(out) as text:
        limiter = re.sub(r"reaction_time: ([0-9.]+)", lambda found: "reaction_time: %.3f\n  max_joint_state_age: %.3f"
                         % (float(found[1]) + late, max(STATE_AGE, 0.05 + late)), text.read())
    with open(out, "w") as text:
        text.write(limiter)
    return out


def run(name, options):
    with tempfile.TemporaryDirectory() as folder, Robot(*files(name)) as running:
        limiter = measured(name, options.servo, options.late * max(1.0, options.factor), folder)
        if options.factor:
            subprocess.run(["rosparam", "set", "/use_sim_time", "true"], check=True)
        subprocess.run(["rosparam", "set", "/collision_pairs_node/allow_paused", "false"], check=True)
        running.start("robot_state_publisher", "robot_state_publisher")
        running.run(*(NO_REAL_TIME if options.no_real_time else []), "roslaunch", "collision_pairs", "limiter.launch",
                    "limiter:=" + limiter, "limited:=/limited_command")
        for _ in range(options.busy):
            running.run("nice", "-n", str(options.nice), sys.executable, "-c", "while True: pass")
        done = subprocess.run([program("dynamic_robot"), "_robot:=" + name, "_servo:=" + options.servo,
                               "_seconds:=%g" % options.seconds, "_factor:=%g" % options.factor, "_seed:=%d" % options.seed,
                               "_pauses:=%s" % str(options.pauses).lower(), "_steps:=%s" % str(options.steps).lower()],
                              check=True, stdout=subprocess.PIPE, text=True)
        print("%s,%d,%s,%.1f,%s" % (clock_of(options), options.busy, "no" if options.no_real_time else "yes",
                                    os.getloadavg()[0], done.stdout.strip()), flush=True)


def clock_of(options):
    if not options.factor:
        return "wall"
    return " ".join(["factor %g" % options.factor] + ["pauses"] * options.pauses + ["steps"] * options.steps)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("robots", nargs="*", default=["demo", *(MODELS if SHARED else [])])
    parser.add_argument("--servo", default="ramp")
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--factor", type=float, default=0.0)
    parser.add_argument("--pauses", action="store_true")
    parser.add_argument("--steps", action="store_true")
    parser.add_argument("--busy", type=int, default=0)
    parser.add_argument("--nice", type=int, default=0)
    parser.add_argument("--late", type=float, default=0.03)
    parser.add_argument("--no-real-time", action="store_true")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    os.environ["ROS_PACKAGE_PATH"] = os.path.join(SHARED, "robots") + ":" + os.environ.get("ROS_PACKAGE_PATH", "")
    print("clock,busy,real_time,load,robot,servo,seconds,contacts,nearest,nearest_links,passed", flush=True)
    for name in options.robots:
        run(name, options)


if __name__ == "__main__":
    sys.exit(main())
