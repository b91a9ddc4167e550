#!/usr/bin/python3
"""What happens around a node: a master that is restarted, a name given twice, no file descriptors left."""
import os
import resource
import signal
import socket
import sys
import tempfile
import unittest
import xmlrpc.client

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import roslib.packages
import rospy
import rostest
from std_srvs.srv import Trigger

from collision_pairs.srv import UpdateScene
from collision_pairs.watchdog import Watchdog
from node_client import PATIENCE, JointPublisher, NodeClient
from program import NODE, ProgramCase, wait_until
from scene_client import add, add_box, clear

GUARD = roslib.packages.find_node("collision_pairs", "limited_command_guard")[0]
PLY = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 4
property list uchar int vertex_indices
end_header
0 0 0
0.1 0 0
0 0.1 0
0 0 0.1
3 0 2 1
3 0 1 3
3 0 3 2
3 1 2 3
"""


def uri_of(node):
    return xmlrpc.client.ServerProxy(os.environ["ROS_MASTER_URI"]).lookupNode("/test", node)[2]


def pid_of(node):
    """As the master knows it; None if it does not, or if that one is dead."""
    try:
        return xmlrpc.client.ServerProxy(uri_of(node)).getPid("/test")[2]
    except OSError:
        return None


class FaultsTest(ProgramCase):
    def launch(self, name, parameters, master=None):
        """collision_pairs.launch with this text of parameters."""
        overlay = tempfile.NamedTemporaryFile("w", suffix=".yaml")
        self.addCleanup(overlay.close)
        overlay.write(parameters)
        overlay.flush()
        return self.start("roslaunch", "collision_pairs", "collision_pairs.launch", "name:=" + name, "overlay:=" + overlay.name,
                          master=master)

    @staticmethod
    def free_master():
        """The URI and the port of a master that may be started."""
        with socket.socket() as probe:
            probe.bind(("", 0))
            port = probe.getsockname()[1]
        return "http://localhost:%d" % port, port

    def start_master(self, port):
        started = self.start("rosmaster", "--core", "-p", str(port))
        master = xmlrpc.client.ServerProxy("http://localhost:%d" % port)

        def answers():
            try:
                return master.getPid("/test")[0] == 1
            except OSError:
                return False
        wait_until(answers, "the master on port %d" % port)
        return started, master

    def test_a_node_that_a_restarted_master_does_not_know_ends_and_says_so(self):
        uri, port = self.free_master()
        first, master = self.start_master(port)
        node = self.start(NODE, "__name:=node", master=uri)
        wait_until(lambda: "robot_description" in node.said(), "the node that looks for its robot")
        self.assertEqual(master.lookupNode("/test", "/node")[0], 1)
        first.end()
        wait_until(lambda: "does not answer" in node.said(), "a word about the master that is gone")
        self.assertIsNone(node.process.poll(), "connections that exist go on")
        self.start_master(port)
        self.assertEqual(node.process.wait(PATIENCE), 1)
        self.assertIn("was restarted", node.said())

    def test_a_launch_files_node_does_not_start_on_a_restarted_master_that_lacks_its_parameters(self):
        uri, port = self.free_master()
        first, master = self.start_master(port)
        launched = self.launch("node", "floor: {height: 0.1}\n", master=uri)
        launched.wait_for("robot_description")
        first.end()
        _, master = self.start_master(port)
        launched.wait_for("cannot start: the parameter /node/configured is gone")
        wait_until(lambda: launched.said().count("cannot start") > 1, "the second time, by respawn")
        self.assertIn("exit code 1", launched.said())
        self.assertEqual(master.lookupService("/test", "/node/update_scene")[0], -1)
        launched.end()
        again = self.launch("node", "floor: {height: 0.1}\n", master=uri)
        again.wait_for("there is no parameter robot_description")
        self.assertEqual(master.lookupService("/test", "/node/update_scene")[0], 1)

    def test_a_scene_is_not_read_again_from_parameters_that_are_gone(self):
        rospy.set_param("/gone/floor", {"height": -0.5, "touch_links": ["a", "b", "c"]})
        node = self.start(NODE, "__name:=gone")
        node.wait_for("ready after")
        settings = rospy.get_param("/gone")
        rospy.delete_param("/gone")
        reset = rospy.ServiceProxy("/gone/reset", Trigger)
        reply = reset()
        self.assertFalse(reply.success)
        self.assertIn("the old scene is kept: the parameter /gone/configured is gone", reply.message)
        rospy.set_param("/gone", settings)
        self.assertTrue(reset().success)

    def test_of_two_nodes_with_one_name_the_first_stays_unless_it_is_dead_or_hangs(self):
        rospy.set_param("/twin/velocity_limiter", {"command": "/jog", "joints": ["slide_a"], "deceleration": 1.0})
        for program in (NODE, GUARD):
            first = self.start(program, "__name:=twin")
            wait_until(lambda: pid_of("/twin") == first.process.pid, "the first node")
            second = self.start(program, "__name:=twin")
            self.assertEqual(second.process.wait(PATIENCE), 1)
            self.assertIn("cannot start: there is a node /twin already, at http://", second.said())
            self.assertIsNone(first.process.poll())
            first.process.kill()
            first.process.wait(PATIENCE)
            third = self.start(program, "__name:=twin")
            wait_until(lambda: pid_of("/twin") == third.process.pid, "the node after one that was killed")
            third.process.send_signal(signal.SIGSTOP)
            hangs = uri_of("/twin")
            fourth = self.start(program, "__name:=twin")
            wait_until(lambda: uri_of("/twin") != hangs, "the node after one that hangs")
            self.assertEqual(pid_of("/twin"), fourth.process.pid)
            third.process.send_signal(signal.SIGCONT)
            third.process.wait(PATIENCE)
            fourth.end()

    def test_whoever_asks_the_watchdog_stops_when_the_node_is_killed_or_hangs(self):
        robot = JointPublisher(["slide_a", "slide_b", "slide_c"])
        robot.hold([0.0, 3.0, 6.0])
        must_stop = Watchdog("/watched/in_collision", timeout=1.0)
        self.assertTrue(must_stop(), "nothing was heard yet")
        node = self.start(NODE, "__name:=watched")
        wait_until(lambda: not must_stop(), "the node to say FREE")
        robot.hold([0.0, 0.0, 0.0])
        wait_until(must_stop, "the node to say COLLISION")
        robot.hold([0.0, 3.0, 6.0])
        wait_until(lambda: not must_stop(), "the node to say FREE again")
        node.process.send_signal(signal.SIGSTOP)
        wait_until(must_stop, "the time-out of a node that hangs")
        node.process.send_signal(signal.SIGCONT)
        wait_until(lambda: not must_stop(), "the node to go on")
        node.process.kill()  # which sends no last will
        wait_until(must_stop, "the time-out of a node that was killed")
        for timeout in (0.0, -1.0, float("nan"), float("inf")):
            self.assertRaises(ValueError, Watchdog, "/watched/in_collision", timeout)

    def test_a_node_that_was_killed_is_started_again_by_the_launch_file(self):
        launched = self.start("roslaunch", "collision_pairs", "collision_pairs.launch", "name:=again")
        client = NodeClient("/again")
        self.assertIsNotNone(client.next(client.reports))
        os.kill(pid_of("/again"), signal.SIGKILL)
        wait_until(lambda: "restarting process" in launched.said(), "roslaunch to start it again")
        self.assertIsNotNone(client.next(client.reports), "reports of the node that was started again")

    def test_what_was_added_to_a_node_that_was_killed_is_unknown_until_clear(self):
        JointPublisher(["slide_a", "slide_b", "slide_c"]).hold([0.0, 3.0, 6.0])
        node = self.start(NODE, "__name:=forgetful")
        client = NodeClient("/forgetful")
        update = rospy.ServiceProxy("/forgetful/update_scene", UpdateScene)
        update.wait_for_service(PATIENCE)
        self.assertIsNotNone(client.next(client.reports, lambda report: report.verdict == report.FREE))
        self.assertTrue(update([add_box("crate", (0, 0, 9))], False).success)
        node.process.kill()
        node.process.wait()
        killed = rospy.Time.now()
        self.start(NODE, "__name:=forgetful")
        def is_told(report):
            self.assertNotEqual(report.verdict, report.FREE)
            return any("objects that ~update_scene had added are lost" in why for why in report.unknown_because)
        self.assertIsNotNone(client.report_since(killed, is_told))
        update.wait_for_service(PATIENCE)
        self.assertTrue(update([add_box("crate", (0, 0, 9))], False).success)
        self.assertIsNotNone(client.report_since(rospy.Time.now(), is_told))
        self.assertTrue(update([clear(), add_box("crate", (0, 0, 9))], False).success)
        now = rospy.Time.now()
        self.assertIsNotNone(client.report_since(now, lambda report: report.verdict == report.FREE))

    def test_nothing_of_an_earlier_launch_file_is_left(self):
        first = self.launch("cleared", "link_padding: {a: 0.5}\nfloor: {height: -9.0, touch_links: [a]}\n")
        first.wait_for("started with pid")
        self.assertEqual(rospy.get_param("/cleared/floor"), {"height": -9.0, "touch_links": ["a"]})
        first.end()
        self.launch("cleared", "floor: {height: -8.0}\n").wait_for("started with pid")
        self.assertEqual(rospy.get_param("/cleared/floor"), {"height": -8.0})
        self.assertEqual(rospy.get_param("/cleared/link_padding", {}), {})

    @unittest.skipIf("UBSAN_OPTIONS" in os.environ, "the sanitizer needs a descriptor to look at the type of an object")
    def test_without_file_descriptors_the_cycle_goes_on_and_what_cannot_be_read_is_refused(self):
        robot = JointPublisher(["slide_a", "slide_b", "slide_c"])
        robot.hold([0.0, 3.0, 6.0])
        node = self.start(NODE, "__name:=poor")
        client = NodeClient("/poor")
        self.assertIsNotNone(client.next(client.reports, lambda report: report.verdict == report.FREE))
        update = rospy.ServiceProxy("/poor/update_scene", UpdateScene, persistent=True)
        self.assertTrue(update([add_box("crate", (0, 0, 9))], False).success)
        with tempfile.NamedTemporaryFile("w", suffix=".ply") as mesh:
            mesh.write(PLY)
            mesh.flush()
            with_mesh = [add("read", (0, 0, 12), mesh_resources=["file://" + mesh.name])]
            enough = resource.prlimit(node.process.pid, resource.RLIMIT_NOFILE)
            in_use = set(map(int, os.listdir("/proc/%d/fd" % node.process.pid)))
            next_free = min(set(range(len(in_use) + 1)) - in_use)
            resource.prlimit(node.process.pid, resource.RLIMIT_NOFILE, (next_free, enough[1]))
            reply = update(with_mesh, False)
            self.assertFalse(reply.success)
            self.assertIn("Too many open files", reply.message)
            now = rospy.Time.now()
            self.assertIsNotNone(client.report_since(now, lambda report: report.verdict == report.FREE))
            resource.prlimit(node.process.pid, resource.RLIMIT_NOFILE, enough)
            reply = update(with_mesh, False)
            self.assertTrue(reply.success, reply.message)
        self.assertTrue(client.check().success)
        self.assertIsNone(node.process.poll())


if __name__ == "__main__":
    rospy.init_node("test_faults")
    rostest.rosrun("collision_pairs", "faults", FaultsTest)
