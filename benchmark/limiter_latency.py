#!/usr/bin/python3
"""How long from a velocity command to the limited one, through a running node with a cloud of 100,000 voxels.

usage: limiter_latency.py [ROBOT...] [--seconds 30] [--rate 250]     ROBOT: panda, ur5, pr2

COLLISION_PAIRS_SHARED names the folder with the robots. For each it starts a roscore on a free port,
robot_state_publisher, the node with a velocity limiter for the arms, and three processes of its own: a robot that
follows the limited commands and publishes joint states, a camera that sees a wall and four posts within the robot's
reach (640 x 480 points at 30 Hz, voxels of 1 cm), and this one, which sends random commands, numbered in their layout.
Joint states and commands come at --rate. Prints a row of docs/limiter.md for each robot (median and 99 % in ms, the
shares of decisions that took too long and of commands without an answer: a newer one had come), and what the machine
did. Python is in the latency twice. Run it in the environment of the built package.
"""
import argparse
import os
import random
import subprocess
import sys
import time

from cloud_latency import as_cloud, joints_and_root, seen_wall
from node_load import Robot, cpu_seconds, quantile

SHARED = os.environ.get("COLLISION_PAIRS_SHARED", "")
PR2_ARM = "shoulder_pan shoulder_lift upper_arm_roll elbow_flex forearm_roll wrist_flex wrist_roll".split()
# Package, joints of the command, where the arms set out, and how far in front of the root link the posts are.
ROBOTS = {
    "panda": ("panda_model", ["panda_joint%d" % i for i in range(1, 8)], [0, -0.78, 0, -2.36, 0, 1.57, 0.78], 0.5),
    "ur5": ("ur_model", ["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint",
                         "wrist_3_joint"], [0, -1.6, 1.6, -1.6, -1.6, 0], 0.6),
    "pr2": ("pr2_model", [side + name + "_joint" for side in ("l_", "r_") for name in PR2_ARM],
            [0.8, 0, 1.5, -1.6, 0, -1, 0, -0.8, 0, -1.5, -1.6, 0, -1, 0], 0.6)}
SPEED, HALF = 0.6, 2.0  # rad/s, s
DECELERATION = 5.0
POST_WIDTH, POST_HEIGHT = 0.04, 1.5  # m


def files(name):
    folder = os.path.join(SHARED, "robots", ROBOTS[name][0])
    return os.path.join(folder, "urdf", name + ".urdf"), os.path.join(folder, "srdf", name + ".srdf")


def play_camera(name):
    import numpy as np
    import rospy
    from sensor_msgs.msg import PointCloud2
    points = seen_wall(np)
    nb_points = 5000
    for i, y in enumerate((-0.6, -0.2, 0.2, 0.6)):
        at = np.random.default_rng(i).uniform((0.0, y, 0.0), (POST_WIDTH, y + POST_WIDTH, POST_HEIGHT), (nb_points, 3))
        points[i * nb_points:(i + 1) * nb_points] = at + (ROBOTS[name][3], 0.0, 0.0)
    cloud = as_cloud(np, points, joints_and_root(files(name)[0])[1])
    publisher = rospy.Publisher("camera/points", PointCloud2, queue_size=1, tcp_nodelay=True)
    rate = rospy.Rate(30)
    while not rospy.is_shutdown():
        cloud.header.stamp = rospy.Time.now()
        publisher.publish(cloud)
        rate.sleep()


def play_robot(name, hertz):
    import rospy
    from sensor_msgs.msg import JointState
    from std_msgs.msg import Float64MultiArray
    joints = joints_and_root(files(name)[0])[0]
    at = dict.fromkeys(joints, 0.0)
    at.update(zip(ROBOTS[name][1], ROBOTS[name][2]))
    speeds, wanted = [0.0] * len(ROBOTS[name][1]), [0.0] * len(ROBOTS[name][1])

    def follow(message):
        wanted[:] = message.data
    rospy.Subscriber("collision_pairs_node/limited_command", Float64MultiArray, follow, tcp_nodelay=True)
    publisher = rospy.Publisher("joint_states", JointState, queue_size=1, tcp_nodelay=True)
    rate, last = rospy.Rate(hertz), time.monotonic()
    while not rospy.is_shutdown():
        seconds, last = time.monotonic() - last, time.monotonic()
        most = DECELERATION * seconds
        for i, joint in enumerate(ROBOTS[name][1]):
            speeds[i] += max(-most, min(most, wanted[i] - speeds[i]))
            at[joint] += speeds[i] * seconds
        publisher.publish(JointState(name=joints, position=[at[joint] for joint in joints],
                                     header=rospy.Header(stamp=rospy.Time.now())))
        rate.sleep()


class Meter:
    """Sends numbered commands, and notes when each comes back limited."""

    def __init__(self, name, hertz):
        import rospy
        from diagnostic_msgs.msg import DiagnosticArray
        from std_msgs.msg import Float64, Float64MultiArray
        self._message, self._hertz, self._nb_joints = Float64MultiArray, hertz, len(ROBOTS[name][1])
        self._sent, self.latencies, self.scales, self.health = {}, [], [], []
        self._commands = rospy.Publisher("command", Float64MultiArray, queue_size=1, tcp_nodelay=True)
        node = "collision_pairs_node/"
        rospy.Subscriber(node + "limited_command", Float64MultiArray, self._on_limited, tcp_nodelay=True)
        rospy.Subscriber(node + "speed_scale", Float64, lambda message: self.scales.append(message.data))
        rospy.Subscriber("/diagnostics", DiagnosticArray, self._on_diagnostics)

    def _on_limited(self, message):
        now = time.perf_counter()
        sent = self._sent.pop(message.layout.data_offset, None)
        if sent is not None:
            self.latencies.append(now - sent)

    def _on_diagnostics(self, message):
        self.health += [{value.key: value.value for value in status.values} for status in message.status]

    def send(self, seconds, draw):
        """For HALF seconds in a random direction, then back along it, and so on. Returns how many were sent."""
        import rospy
        rate, nb_sent, direction = rospy.Rate(self._hertz), int(seconds * self._hertz), []
        for i in range(nb_sent):
            if i % int(2 * HALF * self._hertz) == 0:
                direction = [draw.uniform(-SPEED, SPEED) for _ in range(self._nb_joints)]
            elif i % int(HALF * self._hertz) == 0:
                direction = [-x for x in direction]
            message = self._message(data=direction)
            message.layout.data_offset = i
            self._sent[i] = time.perf_counter()
            self._commands.publish(message)
            rate.sleep()
        return nb_sent


def measure(name, options, node_pid):
    import rospy
    rospy.init_node("limiter_latency", disable_signals=True)
    meter, draw = Meter(name, options.rate), random.Random(1)
    meter.send(8.0, draw)  # until everything is loaded
    time.sleep(0.5)
    for values in (meter.latencies, meter.scales, meter.health):
        del values[:]
    cpu, own, start = cpu_seconds(node_pid), time.process_time(), time.time()
    nb_sent = meter.send(options.seconds, draw)
    took = time.time() - start
    shares = (cpu_seconds(node_pid) - cpu) / took, (time.process_time() - own) / took
    time.sleep(1.5)  # for the diagnostics
    limiter = [values for values in meter.health if "longest decision [s]" in values]
    cloud = next(values for values in reversed(meter.health) if "camera/points voxels" in values)
    nb_decided = max(1, sum(int(values["commands"]) for values in limiter))
    print("| %s | %.2f | %.2f | %.2f %% | %.2f %% |" % (
        name, 1e3 * quantile(meter.latencies, 0.5), 1e3 * quantile(meter.latencies, 0.99),
        100.0 * sum(int(values["overruns"]) for values in limiter) / nb_decided, 100.0 - 100.0 * len(meter.latencies) / nb_sent))
    print("  %s voxels; 90 %% %.2f ms, most %.2f ms; mean scale %.2f, %.0f %% stopped; longest decision %.1f ms; "
          "CPU share of the node %.0f %%, of this process %.0f %%; load average %.1f" % (
              cloud["camera/points voxels"], 1e3 * quantile(meter.latencies, 0.9), 1e3 * max(meter.latencies),
              sum(meter.scales) / len(meter.scales), 100.0 * meter.scales.count(0.0) / len(meter.scales),
              1e3 * max(float(values["longest decision [s]"]) for values in limiter),
              100 * shares[0], 100 * shares[1], os.getloadavg()[0]), flush=True)


def run(name, options):
    with Robot(*files(name)) as running:
        limiter = "{command: /command, joints: [%s], deceleration: %g}" % (", ".join(ROBOTS[name][1]), DECELERATION)
        for key, value in (("velocity_limiter", limiter),
                           ("clouds", "[{topic: camera/points, voxel_size: 0.01, replace: true, source_timeout: 2.0}]")):
            subprocess.run(["rosparam", "set", "/collision_pairs_node/" + key, value], check=True)
        running.start("robot_state_publisher", "robot_state_publisher", "_publish_frequency:=%g" % options.rate)
        pid = running.start("collision_pairs", "collision_pairs_node")
        for role in ("camera", "robot"):
            running.run(sys.executable, __file__, name, "--role", role, "--rate", str(options.rate))
        measure(name, options, pid)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("robots", nargs="*", default=list(ROBOTS))
    parser.add_argument("--seconds", type=float, default=30.0)
    parser.add_argument("--rate", type=int, default=250)
    parser.add_argument("--role", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.role:
        import rospy
        rospy.init_node(options.role)
        return play_camera(options.robots[0]) if options.role == "camera" else play_robot(options.robots[0], options.rate)
    os.environ["ROS_PACKAGE_PATH"] = os.path.join(SHARED, "robots") + ":" + os.environ.get("ROS_PACKAGE_PATH", "")
    for name in options.robots:
        # A process for each: rospy cannot change its master.
        if len(options.robots) == 1:
            run(name, options)
        else:
            subprocess.run([sys.executable, __file__, name, "--seconds", str(options.seconds), "--rate", str(options.rate)], check=True)


if __name__ == "__main__":
    sys.exit(main())
