#!/usr/bin/python3
"""What the node costs beside a robot: CPU share, time of a cycle, and age of its reports.

usage: node_load.py ROBOT.urdf [--srdf F] [--states STATES.csv] [--rate 100] [--trigger rate|tf] [--seconds 20]
                    [--clients]

Starts a roscore on a free port, robot_state_publisher, the node, and a publisher that walks smoothly
through the rows of STATES.csv (all joints at zero without it) at the same rate. The age of a report
is the time from its stamp, which is that of the transforms, to its arrival here. With --clients it
measures in turns, quiet and beside a client that asks without pause: check_trajectory with 1,000
states of STATES.csv a request, and then check_collisions with one. Run it in the environment of the built package (devel/setup.bash), with the meshes' packages on ROS_PACKAGE_PATH.
"""
import argparse
import csv
import os
import socket
import subprocess
import sys
import time


def arguments():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("urdf")
    parser.add_argument("--srdf")
    parser.add_argument("--states")
    parser.add_argument("--rate", type=float, default=100.0)
    parser.add_argument("--trigger", default="rate")
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--clients", action="store_true")
    return parser.parse_args()


def free_port():
    with socket.socket() as probe:
        probe.bind(("", 0))
        return probe.getsockname()[1]


class Robot:
    """A roscore on a free port that has the robot's description; ends what it started when it is left."""

    def __init__(self, urdf, srdf):
        self._urdf, self._srdf, self._started = urdf, srdf, []

    def __enter__(self):
        port = free_port()
        os.environ.update(ROS_MASTER_URI="http://localhost:%d" % port, ROS_HOSTNAME="localhost")
        self.run("roscore", "-p", str(port))
        while subprocess.run(["rosparam", "set", "robot_description", "-t", self._urdf],
                             stderr=subprocess.DEVNULL).returncode:
            time.sleep(0.2)
        if self._srdf:
            subprocess.run(["rosparam", "set", "robot_description_semantic", "-t", self._srdf], check=True)
        return self

    def __exit__(self, *_):
        for process in reversed(self._started):
            process.terminate()
            process.wait()

    def run(self, *command):
        self._started.append(subprocess.Popen(command, stdout=subprocess.DEVNULL))
        return self._started[-1].pid

    def start(self, package, name, *arguments):
        """The id of the node's process."""
        found = subprocess.run(["catkin_find", "--first-only", "--libexec", package, name], check=True,
                               stdout=subprocess.PIPE, text=True).stdout.strip()
        return self.run(found or os.path.join("/usr/lib", package, name), *arguments)


def cpu_seconds(pid):
    with open("/proc/%d/stat" % pid) as stat:
        fields = stat.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def peak_memory_mib(pid):
    with open("/proc/%d/status" % pid) as status:
        return next(int(line.split()[1]) for line in status if line.startswith("VmHWM")) / 1024


def quantile(values, share):
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))]


def postures(path):
    with open(path) as lines:
        rows = list(csv.reader(lines))
    return rows[0], [[float(field) for field in row] for row in rows[1:]]


def measure(options, node_pid):
    import rospy
    from collision_pairs.msg import CollisionPairs
    from diagnostic_msgs.msg import DiagnosticArray
    from sensor_msgs.msg import JointState

    rospy.init_node("node_load")
    names, rows = postures(options.states) if options.states else ([], [[]])
    publisher = rospy.Publisher("joint_states", JointState, queue_size=1)
    ages, cycles, lookups = [], [], []

    def on_report(report):
        ages.append((rospy.Time.now() - report.header.stamp).to_sec())
        cycles.append(report.time_total)
        lookups.append(report.time_transforms)

    def on_timer(_):
        at = rospy.get_time()  # a posture a second
        a, b, share = rows[int(at) % len(rows)], rows[(int(at) + 1) % len(rows)], at - int(at)
        publisher.publish(JointState(name=names, position=[x + share * (y - x) for x, y in zip(a, b)],
                                     header=rospy.Header(stamp=rospy.Time.now())))

    health = {}

    def on_diagnostics(message):
        for status in message.status:
            health.update((value.key, value.value) for value in status.values)

    rospy.Subscriber("collision_pairs_node/collision_pairs", CollisionPairs, on_report, tcp_nodelay=True,
                     queue_size=1)
    rospy.Subscriber("/diagnostics", DiagnosticArray, on_diagnostics)
    rospy.Timer(rospy.Duration(1.0 / options.rate), on_timer)
    time.sleep(5)  # until everything is loaded and the caches are full
    for client in ("quiet", "trajectories", "quiet", "checks", "quiet") if options.clients else ("quiet",):
        process = None
        if client != "quiet":
            process = subprocess.Popen([sys.executable, __file__, options.urdf, "--states", options.states or ""],
                                       env=dict(os.environ, NODE_LOAD_CLIENT=client))
            time.sleep(2)
        del ages[:], cycles[:], lookups[:]
        overruns, nb_cycles = int(health.get("overruns", 0)), int(health.get("cycles", 0))
        cpu, start = cpu_seconds(node_pid), time.time()
        time.sleep(options.seconds)
        share = (cpu_seconds(node_pid) - cpu) / (time.time() - start)
        if process:
            process.terminate()
            process.wait()
        print("%-12s      %.1f reports per second" % (client, len(ages) / options.seconds))
        print("CPU share         %.1f %% of one core" % (100 * share))
        print("cycle             median %.0f us, p99 %.0f us (look-ups of transforms: median %.0f us)" %
              (1e6 * quantile(cycles, 0.5), 1e6 * quantile(cycles, 0.99), 1e6 * quantile(lookups, 0.5)))
        print("age of a report   median %.1f ms, p99 %.1f ms" %
              (1e3 * quantile(ages, 0.5), 1e3 * quantile(ages, 0.99)))
        print("overruns          %d of %d cycles" % (int(health.get("overruns", 0)) - overruns,
                                                     int(health.get("cycles", 0)) - nb_cycles))
    print("peak memory       %.0f MiB" % peak_memory_mib(node_pid))


def ask_without_pause(kind, options):
    """A client of its own process: until it is ended."""
    import rospy
    from collision_pairs.srv import CheckCollisions, CheckTrajectory
    from sensor_msgs.msg import JointState
    from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

    rospy.init_node("node_load_" + kind)
    names, rows = postures(options.states)
    trajectory = JointTrajectory(joint_names=names, points=[
        JointTrajectoryPoint(positions=rows[i % len(rows)]) for i in range(1000)])
    if kind == "trajectories":
        ask = rospy.ServiceProxy("collision_pairs_node/check_trajectory", CheckTrajectory, persistent=True)
        request = dict(trajectory=trajectory)
    else:
        ask = rospy.ServiceProxy("collision_pairs_node/check_collisions", CheckCollisions, persistent=True)
        request = dict(joint_state=JointState(name=names, position=rows[0]))
    while not rospy.is_shutdown():
        try:
            reply = ask(**request)
        except rospy.ServiceException:
            return
        assert reply.success, reply.message


def main():
    options = arguments()
    if "NODE_LOAD_CLIENT" in os.environ:
        return ask_without_pause(os.environ["NODE_LOAD_CLIENT"], options)
    with Robot(options.urdf, options.srdf) as robot:
        robot.start("robot_state_publisher", "robot_state_publisher")
        measure(options, robot.start("collision_pairs", "collision_pairs_node", "_rate:=%g" % options.rate,
                                     "_trigger:=" + options.trigger))


if __name__ == "__main__":
    sys.exit(main())
