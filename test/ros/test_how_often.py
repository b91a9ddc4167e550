#!/usr/bin/python3
"""How often a node asks its master and says how it is; how it ends; and that what it serves does not delay its cycle."""
import glob
import os
import signal
import socketserver
import sys
import tempfile
import threading
import time
import unittest
import xmlrpc.client
import xmlrpc.server

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from collision_pairs.srv import CheckTrajectory, UpdateScene
from node_client import PATIENCE
from program import NODE, Program, ProgramCase, wait_until
from scene_client import add, tetrahedron
from test_verdict import write_bumpy_sphere


class ListeningMaster(socketserver.ThreadingMixIn, xmlrpc.server.SimpleXMLRPCServer):
    """Hands everything on to the master, and keeps when it was asked what."""

    def __init__(self):
        super().__init__(("localhost", 0), logRequests=False, allow_none=True)
        self.asked = []  # (time, name of the call, its arguments)
        self.uri = "http://localhost:%d" % self.server_address[1]
        threading.Thread(target=self.serve_forever, daemon=True).start()

    def _dispatch(self, method, params):
        self.asked.append((time.monotonic(), method, params))
        return getattr(xmlrpc.client.ServerProxy(os.environ["ROS_MASTER_URI"]), method)(*params)

    def seconds_between(self, method, *arguments):
        """Of calls with these among their arguments."""
        times = [t for t, name, given in self.asked if name == method and set(arguments) <= set(given)]
        return [after - before for before, after in zip(times, times[1:])]


class HowOftenTest(ProgramCase):
    @classmethod
    def setUpClass(cls):
        """Two nodes that are heard meanwhile."""
        cls.master, cls.diagnoses = ListeningMaster(), []
        rospy.Subscriber("/diagnostics", DiagnosticArray, lambda array: cls.diagnoses.extend(
            time.monotonic() for status in array.status if status.name.startswith("looks:")))
        rospy.set_param("/waits/robots", [{"description": "nowhere"}])
        cls.heard = [Program(NODE, "__name:=" + name, master=cls.master.uri) for name in ("waits", "looks")]

    @classmethod
    def tearDownClass(cls):
        for program in cls.heard:
            program.end()

    def start_node(self, name):
        return self.start(NODE, "__name:=" + name)

    def assert_each(self, gaps, least):
        self.assertTrue(gaps)
        self.assertGreater(sorted(gaps)[len(gaps) // 2], least)

    def test_a_node_that_is_asked_to_end_does_so_without_a_fault(self):
        nodes = [self.start_node("ends_%d" % i) for i in range(4)]
        for node in nodes:
            node.wait_for("ready after")
        for node in nodes:
            node.process.send_signal(signal.SIGINT)
        for node in nodes:
            self.assertEqual(node.process.wait(PATIENCE), 0)

    def test_a_node_that_reads_meshes_tells_how_far_it_is_and_can_be_ended(self):
        with tempfile.NamedTemporaryFile(suffix=".stl") as mesh:
            write_bumpy_sphere(mesh, 200)
            link = "<link name='l%d'><collision><geometry><mesh filename='file://%s' scale='%g 1 1'/></geometry></collision></link>"
            joint = "<joint name='j%d' type='floating'><parent link='root'/><child link='l%d'/></joint>"
            robot = "".join(link % (i, mesh.name, 1 + i) + joint % (i, i) for i in range(20))
            rospy.set_param("/busy/robot", "<robot name='heavy'><link name='root'/>%s</robot>" % robot)
            rospy.set_param("/busy/robots", [{"description": "robot"}])
            node = self.start_node("busy")
            node.wait_for(" of 20 meshes")
            node.process.send_signal(signal.SIGINT)
            self.assertEqual(node.process.wait(PATIENCE), 0)
            self.assertNotIn("ready after", node.said())

    @unittest.skipIf(os.getpriority(os.PRIO_PROCESS, 0) >= 10, "the test itself has a low priority")
    def test_what_builds_scenes_and_checks_trajectories_has_a_low_priority(self):
        node = self.start_node("polite")
        node.wait_for("ready after")

        def nb_low():
            stats = [open(path).read() for path in glob.glob("/proc/%d/task/*/stat" % node.process.pid)]
            return sum(int(stat.rsplit(")", 1)[1].split()[16]) == 10 for stat in stats)
        self.assertEqual(nb_low(), 1)
        points = [JointTrajectoryPoint(positions=[0.0])]
        check = rospy.ServiceProxy("/polite/check_trajectory", CheckTrajectory)
        self.assertTrue(check(trajectory=JointTrajectory(joint_names=["slide_a"], points=points)).success)
        self.assertGreater(nb_low(), 1)

    @unittest.skipIf(os.getpriority(os.PRIO_PROCESS, 0) >= 10, "the test itself has a low priority")
    def test_requests_that_change_the_scene_are_answered_with_the_priority_of_the_node_after_a_load(self):
        rospy.set_param("/prompt/rate", 1.0)  # so that the work of a request exceeds that of the cycles meanwhile
        rospy.set_param("/prompt/clouds", [{"topic": "points", "voxel_size": 0.05}])
        node = self.start_node("prompt")
        node.wait_for("ready after")

        def work():
            """{thread: (its nice value, ns that it ran)}"""
            found = {}
            for path in glob.glob("/proc/%d/task/*" % node.process.pid):
                with open(path + "/stat") as stat, open(path + "/schedstat") as time_run:
                    found[path] = int(stat.read().rsplit(")", 1)[1].split()[16]), int(time_run.read().split()[0])
            return found
        corner = tetrahedron(0.1)
        heavy = add("heavy", (0, 5, 0), meshes=[corner] * 300)
        calls = {"update_scene": (UpdateScene, lambda call: call(changes=[heavy], no_list=True)),
                 "reset": (Trigger, lambda call: call()), "clear_clouds": (Trigger, lambda call: call())}
        for name, (kind, ask) in calls.items():
            rospy.wait_for_service("/prompt/" + name, PATIENCE)
            service = rospy.ServiceProxy("/prompt/" + name, kind, persistent=True)
            before = work()
            for _ in range(50):
                self.assertTrue(ask(service).success)
            ran = {0: 0, 10: 0}
            for thread, (nice, time_run) in work().items():
                ran[nice] += time_run - before.get(thread, (nice, 0))[1]
            self.assertLess(ran[10], 0.1 * ran[0], name)  # it frees the old scenes

    def test_z_a_node_asks_its_master_and_tells_its_health_no_more_than_every_few_seconds(self):
        questions = self.master.seconds_between
        wait_until(lambda: len(questions("searchParam", "/looks", "robot_description")) > 1, "questions")
        self.assert_each(questions("lookupService", "/waits", "/waits/update_scene"), 1.8)
        self.assert_each(questions("searchParam", "/waits", "nowhere"), 1.8)
        # Of a description that has changed; the first gap begins at its load.
        self.assert_each(questions("searchParam", "/looks", "robot_description")[1:], 2.7)
        self.assert_each([after - before for before, after in zip(self.diagnoses, self.diagnoses[1:])], 0.9)


if __name__ == "__main__":
    rospy.init_node("test_how_often")
    rostest.rosrun("collision_pairs", "how_often", HowOftenTest)
