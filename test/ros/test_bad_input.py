#!/usr/bin/python3
"""What is wrong is named, what is right is still checked, and no node ends."""
import fcntl
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import rostest
from roslib.packages import find_node
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from collision_pairs.msg import CollisionPairs
from collision_pairs.srv import CheckTrajectory
from node_client import NodeClient, diagnosis_of, publish_transform
from scene_client import SceneClient, add_box

NAN = float("nan")


class BadInputTest(unittest.TestCase):
    def test_no_description_is_said_and_one_that_comes_later_is_taken(self):
        node = NodeClient("/no_description/node")
        reply = node.check()
        self.assertFalse(reply.success)
        self.assertIn("no robot", reply.message)
        status = diagnosis_of("no_description/node")
        self.assertEqual(status.level, 2)
        rospy.set_param("/no_description/robot_description",
                        "<robot name='late'><link name='a'><collision><geometry><sphere radius='1'/>"
                        "</geometry></collision></link></robot>")
        self.assertIsNotNone(node.next(node.reports, lambda r: r.unchecked == "there is no pair to check"))

    def test_malformed_description_is_named_and_mended_by_a_reset(self):
        node = NodeClient("/malformed/node")
        self.assertFalse(node.check().success)
        status = diagnosis_of("malformed/node")
        self.assertEqual(status.level, 2)
        self.assertIn("/malformed/robot_description", status.message)
        reset = rospy.ServiceProxy("/malformed/node/reset", Trigger)
        self.assertIn("not well-formed", reset().message)
        rospy.set_param("/malformed/robot_description", "<robot name='r'><link name='a'/></robot>")
        reply = reset()
        self.assertTrue(reply.success)
        self.assertIn("the robot has no collision geometry", reply.message)
        self.assertIsNotNone(node.next(node.reports, lambda r: r.unchecked == "the robot has no collision geometry"))

    def test_a_robot_without_collision_geometry_is_never_free_whatever_is_around_it(self):
        node = NodeClient("/no_geometry/node")
        words = "the robot has no collision geometry"
        check = rospy.ServiceProxy("/no_geometry/node/check_trajectory", CheckTrajectory)
        trajectory = JointTrajectory(joint_names=["slide_a"],
                                     points=[JointTrajectoryPoint(positions=[x]) for x in (0.0, 1.0)])
        scene = SceneClient("/no_geometry/node")
        for with_box in (False, True):
            if with_box:
                scene.apply(add_box("around", (0, 0, 0), (50, 50, 50)))
            begin = rospy.Time.now()
            report = node.report_since(begin)
            for result in (report, node.check().result, node.check(joint_state=JointState(name=["slide_a"], position=[0])).result):
                self.assertEqual((result.verdict, result.in_collision, result.unchecked), (CollisionPairs.UNKNOWN, True, words))
                self.assertIn(words, result.unknown_because)
                self.assertEqual((result.min_distance, result.min_distance_is_bound), (0.0, True))
            reply = check(trajectory=trajectory, between=True, want_reports=True)
            self.assertTrue(reply.success, reply.message)
            self.assertEqual((list(bytes(reply.verdict)), list(bytes(reply.segment_verdict))), ([2, 2], [2]))
            self.assertIn(words, reply.unknown_because)
            self.assertEqual({r.verdict for r in reply.reports}, {CollisionPairs.UNKNOWN})
        self.assertTrue(node.next(node.verdicts).data)
        self.assertIn(words, diagnosis_of("no_geometry/node: collision check").message)

        rospy.set_param("/no_geometry/node/allow_empty_scene", True)
        self.assertTrue(rospy.ServiceProxy("/no_geometry/node/reset", Trigger)().success)
        report = node.next(node.reports, lambda r: r.verdict == r.FREE)
        self.assertEqual((report.unchecked, report.unknown_because), (words, []))
        self.assertEqual((node.check().result.unchecked, node.check().message), (words, words))
        reply = check(trajectory=trajectory, between=True)
        self.assertEqual((list(bytes(reply.verdict)), list(bytes(reply.segment_verdict))), ([0, 0], [0]))
        self.assertIn(words, reply.message)
        self.assertIn(words, diagnosis_of("no_geometry/node: collision check").message)

    def test_a_link_with_a_broken_mesh_is_left_out_by_name_and_the_others_are_checked(self):
        node = NodeClient("/broken_mesh/node")
        report = node.next(node.reports, lambda r: r.left_out)
        self.assertEqual(report.left_out, ["broken", "text"])
        self.assertNotEqual(report.verdict, report.FREE)
        self.assertEqual([(p.first_link, p.second_link) for p in report.pairs], [("other", "whole")])
        self.assertEqual(node.check().result.left_out, ["broken", "text"])

    def test_a_joint_without_its_leader_is_unknown_until_tf_says_where_it_is(self):
        with tempfile.NamedTemporaryFile("w", suffix=".stl") as mesh:
            mesh.write("solid sheet\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
                       "endloop\nendfacet\nendsolid sheet\n")
            mesh.flush()
            sheet = "<collision><geometry><mesh filename='file://%s'/></geometry></collision>" % mesh.name
            joint = ("<joint name='%s' type='continuous'><parent link='base'/><child link='%s'/>%s</joint>")
            rospy.set_param("/incomplete/robot_description", "<robot name='r'><link name='base'/>"
                            "<link name='sheet'>" + sheet + "</link><link name='grip'>" + sheet + "</link>" +
                            joint % ("lead", "sheet", "") + joint % ("follow", "grip", "<origin xyz='0 0 2'/><mimic joint='nobody'/>") + "</robot>")
            node = NodeClient("/incomplete/node")
            publisher = rospy.Publisher("/tf", TFMessage, queue_size=10)
            child = ["sheet"]
            moving = rospy.Timer(rospy.Duration(0.05), lambda _: [
                publish_transform(publisher, "base", link, (0, 0, 2.0 * i)) for i, link in enumerate(child)])
            try:
                report = node.next(node.reports, lambda r: r.left_out == ["grip"])
                self.assertEqual(report.verdict, report.UNKNOWN)
                reply = node.check(joint_state=JointState(name=["lead"], position=[0.5]))
                self.assertEqual(reply.result.verdict, CollisionPairs.UNKNOWN)
                self.assertIn("joint 'follow'", " ".join(reply.result.unknown_because))
                self.assertFalse([report for report in node.reports if report.verdict == report.FREE])
                child.append("grip")
                self.assertIsNotNone(node.next(node.reports, lambda r: r.verdict == r.FREE))
            finally:
                moving.shutdown()
        said = {pair.key: pair.value for pair in diagnosis_of("incomplete/node: collision check").values}
        self.assertIn("'grip', 'sheet': about 50 % of the surface of mesh", said["open meshes"])

    def test_with_a_broken_mesh_no_motion_is_free(self):
        node = NodeClient("/broken_mesh/node")
        SceneClient("/broken_mesh/node").apply(add_box("far", (0, 90, 0)))
        check = rospy.ServiceProxy("/broken_mesh/node/check_trajectory", CheckTrajectory)
        trajectory = JointTrajectory(points=[JointTrajectoryPoint(), JointTrajectoryPoint()])
        reply = check(trajectory=trajectory, between=True, links=["far"])
        self.assertTrue(reply.success, reply.message)
        self.assertEqual(list(reply.verdict), [CollisionPairs.UNKNOWN] * 2)
        self.assertEqual((list(reply.segment_verdict), list(reply.clearance)), ([CollisionPairs.UNKNOWN], [0.0]))
        self.assertIn("geometry that could not be read: broken, text", reply.unknown_because)
        report = node.next(node.reports)
        self.assertEqual((report.time_to_contact, report.time_to_contact_is_known), (0.0, True))  # in contact

    def test_a_mesh_that_is_never_read_is_unknown_and_does_not_keep_the_node_from_ending(self):
        with tempfile.NamedTemporaryFile(suffix=".bin") as numbers, tempfile.NamedTemporaryFile("w", suffix=".gltf") as mesh:
            json.dump({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
                       "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
                       "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
                       "bufferViews": [{"buffer": 0, "byteLength": 36}],
                       "buffers": [{"byteLength": 36, "uri": os.path.basename(numbers.name)}]}, mesh)
            mesh.flush()
            signal.signal(signal.SIGIO, signal.SIG_IGN)  # comes when somebody else wants to open it
            fcntl.fcntl(numbers, fcntl.F_SETLEASE, fcntl.F_WRLCK)  # and waits for 45 s (lease-break-time)
            with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "broken_mesh.urdf")) as urdf:
                description = re.sub('filename="[^"]*"', 'filename="file://%s"' % mesh.name, urdf.read())
            rospy.set_param("/endless/robot_description", description)
            process = subprocess.Popen(find_node("collision_pairs", "collision_pairs_node") +
                                       ["__name:=node", "__ns:=/endless"])
            try:
                node = NodeClient("/endless/node")
                report = node.next(node.reports, lambda r: "load" in str(r.unknown_because))
                self.assertEqual(report.verdict, report.UNKNOWN)
                process.send_signal(signal.SIGINT)
                self.assertEqual(process.wait(timeout=20), 0)  # s, less than reading may take
            finally:
                process.kill()


if __name__ == "__main__":
    rospy.init_node("test_bad_input")
    rostest.rosrun("collision_pairs", "bad_input", BadInputTest)
