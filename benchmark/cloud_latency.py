#!/usr/bin/python3
"""How long from the stamp of a cloud to the first report that knows it, and what that costs.

usage: cloud_latency.py [ROBOT.urdf] [--srdf F] [--cloud-rate 30] [--rate 100] [--seconds 20] [--voxel-size 0.01]
                        [--driver node|nodelet]

Starts a roscore on a free port, robot_state_publisher, the node with one cloud in ~clouds, and publishes joint states
at --rate and clouds of 640 x 480 points at --cloud-rate: a wall 3 m away, which occupies about 100,000 voxels of 1 cm,
and a plate of some points before the robot. The plate's distance says which cloud a report is of: it is another one in
each of eight clouds that follow each other, and by it a report is matched with the stamp of its cloud. The latency ends
when the report arrives here, so transport is in it twice. With --driver the clouds go through a process that stands
for a camera's driver (cloud_driver, built with COLLISION_PAIRS_BENCHMARKS=ON), which has the node beside it, or as a
nodelet in it; the CPU share is then of all of it. Run it in the environment of the built package.
"""
import argparse
import os
import subprocess
import sys
import threading
import time

from node_load import Robot, cpu_seconds, peak_memory_mib, quantile

DEMO = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../config/demo")
NB_CODES = 8
WIDTH, HEIGHT = 640, 480


def seen_wall(np):
    """Points of a camera's image that shows a wall 3 m away: about 100,000 voxels of 1 cm."""
    u, v = np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT))
    return np.stack([np.full(u.shape, 3.0), (u / WIDTH - 0.5) * 4.0, v / HEIGHT * 2.6], axis=-1).reshape(-1, 3)


def as_cloud(np, points, frame):
    """The message without a stamp."""
    from sensor_msgs.msg import PointCloud2, PointField
    cloud = PointCloud2(height=HEIGHT, width=WIDTH, point_step=16, row_step=16 * WIDTH, is_dense=True)
    cloud.header.frame_id = frame
    cloud.fields = [PointField(name, 4 * i, PointField.FLOAT32, 1) for i, name in enumerate("xyz")]
    packed = np.zeros((len(points), 4), dtype="<f4")
    packed[:, :3] = points
    cloud.data = packed.tobytes()
    return cloud


def clouds(np, voxel_size, root_frame):
    """A message for each code."""
    messages = []
    for code in range(NB_CODES):
        points = seen_wall(np)
        # In front of the robot, far outside its reach of 5 cm; each code one voxel further.
        side = np.arange(400) % 20, np.arange(400) // 20
        points[:400] = np.stack([np.full(400, 1.0 + (code + 0.5) * voxel_size), 0.01 * side[0] - 0.1,
                                 1.0 + 0.01 * side[1]], axis=-1)
        messages.append(as_cloud(np, points, root_frame))
    return messages


def joints_and_root(urdf):
    """Names of the joints that have a position of their own, and of the root link."""
    import xml.etree.ElementTree as xml
    robot = xml.parse(urdf).getroot()
    joints = [j.get("name") for j in robot.findall("joint")
              if j.get("type") in ("revolute", "continuous", "prismatic") and j.find("mimic") is None]
    children = {j.find("child").get("link") for j in robot.findall("joint")}
    return joints, next(link.get("name") for link in robot.findall("link") if link.get("name") not in children)


class Meter:
    """Matches reports with clouds: by the smallest distance, which each code has another of."""

    def __init__(self):
        self._lock = threading.Lock()
        self._code_of = {}  # by smallest distance, in tenths of a millimetre
        self._last_code = None
        self.sent = {}  # code: stamp of the newest cloud with it
        self.latencies, self.verdicts, self.cycles = [], set(), []

    def clear(self):
        with self._lock:
            self.latencies, self.verdicts, self.cycles = [], set(), []

    def learn(self, code, distance):
        with self._lock:
            self._code_of[round(1e4 * distance)] = code

    def nb_known(self):
        return len(self._code_of)

    def on_report(self, report, now):
        with self._lock:
            self.verdicts.add(report.verdict)
            self.cycles.append(report.time_total)
            code = self._code_of.get(round(1e4 * report.min_distance))
            if code is None or code == self._last_code or code not in self.sent:
                return
            self._last_code = code
            self.latencies.append((now - self.sent[code]).to_sec())

    def note_sent(self, code, stamp):
        with self._lock:
            self.sent[code] = stamp


def measure(options, pids):
    import numpy as np
    import rospy
    from collision_pairs.msg import CollisionPairs
    from diagnostic_msgs.msg import DiagnosticArray
    from sensor_msgs.msg import JointState, PointCloud2

    rospy.init_node("cloud_latency")
    meter, health, distances = Meter(), {}, []

    def on_report(report):
        meter.on_report(report, rospy.Time.now())
        distances.append(report.min_distance)

    def on_diagnostics(message):
        for status in message.status:
            health.update((value.key, value.value) for value in status.values)

    rospy.Subscriber("collision_pairs_node/collision_pairs", CollisionPairs, on_report, tcp_nodelay=True, queue_size=10)
    rospy.Subscriber("/diagnostics", DiagnosticArray, on_diagnostics)
    joints = rospy.Publisher("joint_states", JointState, queue_size=1, tcp_nodelay=True)
    rospy.Timer(rospy.Duration(1.0 / options.rate), lambda _: joints.publish(
        JointState(name=options.joints, position=[0.0] * len(options.joints),
                   header=rospy.Header(stamp=rospy.Time.now()))))
    publisher = rospy.Publisher("camera/seen" if options.driver else "camera/points", PointCloud2, queue_size=1, tcp_nodelay=True)
    messages = clouds(np, options.voxel_size, options.root)

    def publish(seconds, codes):
        rate = rospy.Rate(options.cloud_rate)
        end, i = rospy.get_time() + seconds, 0
        while rospy.get_time() < end:
            code = codes[i % len(codes)]
            message = messages[code]
            message.header.stamp = rospy.Time.now()
            meter.note_sent(code, message.header.stamp)
            publisher.publish(message)
            i += 1
            rate.sleep()
    publish(8.0, [0])  # until everything is loaded
    for code in range(NB_CODES):
        publish(1.0, [code])
        meter.learn(code, distances[-1])
    assert meter.nb_known() == NB_CODES, "two codes look the same"
    publish(2.0, range(NB_CODES))
    meter.clear()
    cpu, start = sum(map(cpu_seconds, pids)), time.time()
    publish(options.seconds, range(NB_CODES))
    share = (sum(map(cpu_seconds, pids)) - cpu) / (time.time() - start)
    time.sleep(1.5)  # for the diagnostics
    name = "camera/points "
    print("cloud to verdict  median %.1f ms, p99 %.1f ms, %d clouds" %
          (1e3 * quantile(meter.latencies, 0.5), 1e3 * quantile(meter.latencies, 0.99), len(meter.latencies)))
    print("voxels            %s of %s points" % (health[name + "voxels"], health[name + "points"]))
    print("to voxels         %.1f ms (of the last cloud), latency so far %.1f ms" %
          (1e3 * float(health[name + "processing [s]"]), 1e3 * float(health[name + "latency [s]"])))
    print("clouds            %s received, %s dropped, %s refused" %
          tuple(health[name + key] for key in ("received", "dropped", "refused")))
    print("cycle             median %.0f us, p99 %.0f us" %
          (1e6 * quantile(meter.cycles, 0.5), 1e6 * quantile(meter.cycles, 0.99)))
    print("verdicts          %s" % sorted(meter.verdicts))
    print("CPU share         %.1f %% of one core, peak memory %.0f MiB" % (100 * share, sum(map(peak_memory_mib, pids))))


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("urdf", nargs="?", default=os.path.join(DEMO, "demo_robot.urdf"))
    parser.add_argument("--srdf", default=None)
    parser.add_argument("--cloud-rate", type=float, default=30.0)
    parser.add_argument("--rate", type=float, default=100.0)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--voxel-size", type=float, default=0.01)
    parser.add_argument("--driver", choices=("node", "nodelet"))
    options = parser.parse_args()
    if options.srdf is None and options.urdf.startswith(DEMO):
        options.srdf = os.path.join(DEMO, "demo_robot.srdf")
    options.joints, options.root = joints_and_root(options.urdf)

    with Robot(options.urdf, options.srdf) as running:
        subprocess.run(["rosparam", "set", "/collision_pairs_node/clouds",
                        "[{topic: camera/points, voxel_size: %g, replace: true, source_timeout: 2.0}]" %
                        options.voxel_size], check=True)
        subprocess.run(["rosparam", "set", "/collision_pairs_node/links", "[camera/points]"], check=True)
        running.start("robot_state_publisher", "robot_state_publisher")
        for parameter, value in (("rate", "%g" % options.rate), ("min_distance", "true")):
            subprocess.run(["rosparam", "set", "/collision_pairs_node/" + parameter, value], check=True)
        pids = []
        if options.driver:
            pids.append(running.start("collision_pairs", "cloud_driver", options.driver))
        if options.driver != "nodelet":
            pids.append(running.start("collision_pairs", "collision_pairs_node"))
        measure(options, pids)


if __name__ == "__main__":
    sys.exit(main())
