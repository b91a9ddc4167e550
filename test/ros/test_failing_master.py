#!/usr/bin/python3
"""What a node makes of a master that does not answer some question, and of parameters that are not its own."""
import http.server
import os
import sys
import threading
import urllib.request

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import rostest
from std_srvs.srv import Trigger

from collision_pairs.srv import UpdateScene
from node_client import PATIENCE
from program import NODE, ProgramCase
from scene_client import add_box, clear


class FailingMaster:
    """Passes requests on to the master of the environment, but those with all of some words, which it leaves unanswered."""

    def __init__(self):
        outer, self.fails_at = self, None

        class Handler(http.server.BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"

            def do_POST(self):
                body = self.rfile.read(int(self.headers["Content-Length"]))
                if outer.fails_at and all(b">%s<" % word.encode() in body for word in outer.fails_at):
                    self.close_connection = True
                    return
                request = urllib.request.Request(os.environ["ROS_MASTER_URI"] + "/RPC2", body, {"Content-Type": "text/xml"})
                with urllib.request.urlopen(request, timeout=PATIENCE) as answer:
                    content = answer.read()
                self.send_response(200)
                self.send_header("Content-Type", "text/xml")
                self.send_header("Content-Length", str(len(content)))
                self.end_headers()
                self.wfile.write(content)

            def log_message(self, *_):
                pass

        self._server = http.server.ThreadingHTTPServer(("localhost", 0), Handler)
        self._server.daemon_threads = True
        threading.Thread(target=self._server.serve_forever, daemon=True).start()
        self.uri = "http://localhost:%d" % self._server.server_address[1]

    def end(self):
        self._server.shutdown()
        self._server.server_close()


class FailingMasterTest(ProgramCase):
    def setUp(self):
        super().setUp()
        self.master = FailingMaster()

    def tearDown(self):
        super().tearDown()
        self.master.end()
        for name in ("asked", "nested", "left"):
            if rospy.has_param("/" + name):
                rospy.delete_param("/" + name)

    def start_node(self, *arguments):
        return self.start(NODE, *arguments, master=self.master.uri)

    def call(self, service, kind, *arguments):
        rospy.wait_for_service(service, PATIENCE)
        return rospy.ServiceProxy(service, kind)(*arguments)

    def test_a_parameter_that_cannot_be_asked_about_is_not_a_default(self):
        rospy.set_param("/asked/floor", {"height": 0.0})
        self.master.fails_at = ("getParam", "/asked/floor")
        node = self.start_node("__name:=asked")
        node.wait_for("does not answer getParam(/asked/floor)")
        self.assertNotIn("ready after", node.said())
        self.master.fails_at = None
        node.wait_for("ready after")
        for question in (("getParam", "/asked/floor"), ("searchParam", "robot_description_semantic"), ("getParam", "/asked")):
            self.master.fails_at = question
            answer = self.call("/asked/reset", Trigger)
            self.assertFalse(answer.success, question)
            self.assertIn("the ROS master does not answer", answer.message)
        self.master.fails_at = None
        self.assertTrue(self.call("/asked/reset", Trigger).success)

    def test_objects_that_could_not_be_noted_for_the_next_node_are_refused(self):
        self.start_node("__name:=asked").wait_for("ready after")
        self.master.fails_at = ("setParam", "/asked/has_objects")
        answer = self.call("/asked/update_scene", UpdateScene, [add_box("box")], False)
        self.assertFalse(answer.success)
        self.assertIn("does not answer, so /asked/has_objects cannot be set", answer.message)
        self.master.fails_at = None
        answer = self.call("/asked/update_scene", UpdateScene, [add_box("box")], False)
        self.assertTrue(answer.success, answer.message)
        self.assertTrue(rospy.get_param("/asked/has_objects"))
        self.assertTrue(self.call("/asked/update_scene", UpdateScene, [clear()], False).success)
        self.assertFalse(rospy.get_param("/asked/has_objects"))

    def test_settings_below_the_name_of_the_node_in_a_file_are_refused(self):
        for settings, key in (({"floor": {"height": 0.0}}, "floor"), ({"deeper": {"clouds": []}}, "deeper/clouds")):
            rospy.set_param("/nested/nested", settings)
            node = self.start_node("__name:=nested")
            node.wait_for("parameter /nested/nested/%s is not read" % key)
            node.end()

    def test_an_srdf_further_up_than_the_urdf_is_not_used(self):
        rospy.set_param("/left/robot_description", rospy.get_param("/robot_description"))
        rospy.set_param("/robot_description_semantic", "<robot name='boxes'/>")
        try:
            node = self.start_node("__ns:=left", "__name:=node")
            node.wait_for("parameter /robot_description_semantic is not used: it may be of another robot than /left/robot_description")
            rospy.set_param("/left/node/robot_description_semantic", "<robot name='boxes'/>")
            node = self.start_node("__ns:=left", "__name:=nearer")
            node.wait_for("is not used")
            rospy.set_param("/left/robot_description_semantic", "<robot name='boxes'/>")
            self.assertTrue(self.call("/left/node/reset", Trigger).success)
            node = self.start_node("__ns:=left", "__name:=third")
            node.wait_for("ready after")
            self.assertNotIn("is not used", node.said())
        finally:
            rospy.delete_param("/robot_description_semantic")


if __name__ == "__main__":
    rospy.init_node("test_failing_master")
    rostest.rosrun("collision_pairs", "failing_master", FailingMasterTest)
