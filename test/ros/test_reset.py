#!/usr/bin/python3
"""~reset reads every parameter of the scene anew, and names what is missing; what requests are warned of."""
import math
import os
import shutil
import sys
import tempfile
import time
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import rostest
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from collision_pairs.msg import CollisionPairs
from collision_pairs.srv import CheckTrajectory
from node_client import PATIENCE, NodeClient, diagnosis_of, publish_transform
from scene_client import SceneClient, add_box, attach, clear

JOINTS = ["slide_a", "slide_b", "slide_c"]
PLACES = [0.0, 3.0, 6.0]
GROUP = '<group name="last"><link name="c"/></group>'


def link(name, geometry, origin=""):
    return '<link name="%s"><collision>%s<geometry>%s</geometry></collision></link>' % (name, origin, geometry)


def robot(mesh, size="1 1 1"):
    """A box, an upright cylinder and a ball of triangles, on sliders along x."""
    links = link("a", '<box size="%s"/>' % size) + link("b", '<cylinder radius="0.5" length="1"/>')
    links += link("c", '<mesh filename="file://%s"/>' % mesh, '<origin rpy="0.5 0.6 0.7"/>')
    sliders = "".join('<joint name="slide_%s" type="prismatic"><parent link="root"/><child link="%s"/><axis xyz="1 0 0"/>'
                      '<limit lower="-9" upper="9" effort="1" velocity="1"/></joint>' % (n, n) for n in "abc")
    return '<robot name="r"><link name="root"/>%s%s</robot>' % (links, sliders)


def write_ball(path, rings=8):
    points = [(math.sin(u) * math.cos(v), math.sin(u) * math.sin(v), math.cos(u))
              for u in (math.pi * (i + 0.5) / rings for i in range(rings))
              for v in (2 * math.pi * j / rings for j in range(rings))]
    faces = [(i * rings + j, (i + 1) * rings + j, (i + 1) * rings + (j + 1) % rings, i * rings + (j + 1) % rings)
             for i in range(rings - 1) for j in range(rings)]
    faces += [tuple(range(rings)), tuple(reversed(range((rings - 1) * rings, rings * rings)))]
    with open(path, "w") as out:
        out.writelines("v %.9f %.9f %.9f\n" % tuple(0.5 * x for x in point) for point in points)
        out.writelines("f " + " ".join(str(i + 1) for i in face) + "\n" for face in faces)


class ResetTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        cls.mesh = os.path.join(cls.folder, "ball.obj")
        write_ball(cls.mesh)
        cls.node = NodeClient("/cell/node")
        cls.scene = SceneClient("/cell/node")
        cls.call_reset = rospy.ServiceProxy("/cell/node/reset", Trigger)
        cls.tf_static = rospy.Publisher("/tf_static", TFMessage, queue_size=10, latch=True)
        rospy.Timer(rospy.Duration(0.1), lambda _: publish_transform(cls.tf_static, "world", "root"))

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def setUp(self):
        rospy.set_param("/cell/robot_description", robot(self.mesh))
        self.reset()
        self.before = self.check()
        self.assertEqual(self.distances(self.before), {("a", "b"): 2.0, ("a", "c"): 5.0, ("b", "c"): 2.0})

    def reset(self):
        reply = self.call_reset()
        self.assertTrue(reply.success, reply.message)
        return reply.message

    def check(self, prefix="", positions=PLACES, fidelity="", alarm_distance=20.0):
        state = JointState(name=[prefix + name for name in JOINTS], position=positions)
        end = time.time() + PATIENCE
        while True:
            reply = self.node.check(joint_state=state, fidelity=fidelity, alarm_distance=alarm_distance)
            on_its_way = "TF does not know" in reply.message  # what is published of the new frame
            if not on_its_way or time.time() > end:
                break
            time.sleep(0.05)
        self.assertTrue(reply.success, reply.message)
        return reply.result

    @staticmethod
    def distances(result):
        return {(p.first_link, p.second_link): round(p.distance, 1) for p in result.pairs}

    def after(self, name, value, **query):
        """What is checked with another parameter, after a reset; the parameter is as before then."""
        rospy.set_param(name, value)
        try:
            self.reset()
            return self.check(**query)
        finally:
            rospy.delete_param(name)
            self.assertEqual(self.reset(), "the robot was reloaded")

    def distances_after(self, name, value, **query):
        return self.distances(self.after("/cell/node/" + name, value, **query))

    def test_paddings(self):
        self.assertEqual(self.distances_after("padding", 0.1), {("a", "b"): 1.8, ("a", "c"): 4.8, ("b", "c"): 1.8})
        self.assertEqual(self.distances_after("link_padding", {"a": 0.1}),
                         {("a", "b"): 1.9, ("a", "c"): 4.9, ("b", "c"): 2.0})
        self.assertEqual(self.distances_after("pair_padding", [{"pair": ["a", "b"], "padding": 0.3}]),
                         {("a", "b"): 1.7, ("a", "c"): 5.0, ("b", "c"): 2.0})

    def test_what_says_which_pairs_there_are(self):
        self.assertEqual(set(self.distances_after("pair_rules", [{"deny": ["a", "*"]}])), {("b", "c")})
        self.assertEqual(set(self.distances_after("ignored_links", ["b"])), {("a", "c")})
        self.assertEqual(set(self.distances_after("links", ["c"])), {("a", "c"), ("b", "c")})
        rospy.set_param("/cell/robot_description_semantic", '<robot name="r">%s</robot>' % GROUP)
        try:
            self.assertEqual(set(self.distances_after("group", "last")), {("a", "c"), ("b", "c")})
        finally:
            rospy.delete_param("/cell/robot_description_semantic")
        switched_off = '<robot name="r"><disable_collisions link1="a" link2="c"/></robot>'
        result = self.after("/cell/robot_description_semantic", switched_off)
        self.assertEqual(set(self.distances(result)), {("a", "b"), ("b", "c")})

    def test_what_else_there_is(self):
        floor = {"height": -1.5}
        self.assertEqual(self.distances_after("floor", floor)[("b", "floor")], 1.0)
        rospy.set_param("/cell/node/floor", floor)
        try:
            self.assertEqual(self.distances_after("cylinder_as_capsule", ["b"])[("b", "floor")], 0.5)
        finally:
            rospy.delete_param("/cell/node/floor")
        world = '<robot name="w">%s</robot>' % link("post", '<sphere radius="0.5"/>')
        result = self.after("/cell/environment_description", world, positions=[2.0, 5.0, 8.0])
        self.assertEqual(self.distances(result)[("a", "post")], 1.0)

    def test_how_exactly_links_are_modelled(self):
        of_ball = lambda result: next(p for p in result.pairs if p.second_link == "c" and p.first_link == "b")
        self.assertNotEqual(of_ball(self.before).fidelity, "obb")
        self.assertEqual(of_ball(self.after("/cell/node/link_fidelity", {"c": "obb"})).fidelity, "obb")
        touching = {"fidelity": "convex", "positions": [0.0, 3.0, 4.01]}
        exact = of_ball(self.check(**touching)).distance
        grown = of_ball(self.after("/cell/node/max_hull_vertices", 6, **touching)).distance
        self.assertLess(grown, exact - 0.001)
        self.assertEqual(self.before.narrow_phase, "native")
        self.assertEqual(self.after("/cell/node/narrow_phase", "fcl").narrow_phase, "fcl")

    def test_the_frame_of_reports_and_the_robots(self):
        self.assertEqual(self.before.header.frame_id, "root")
        self.assertEqual(self.after("/cell/node/fixed_frame", "/world").header.frame_id, "world")
        robots = [{"description": "robot_description", "prefix": "left"}]
        result = self.after("/cell/node/robots", robots, prefix="left/")
        self.assertEqual(set(self.distances(result)), {("left/a", "left/b"), ("left/a", "left/c"), ("left/b", "left/c")})

    def test_another_fixed_frame_is_refused_while_objects_stand_in_the_old_one(self):
        self.scene.apply(add_box("crate", (0, 3, 0)))
        rospy.set_param("/cell/node/fixed_frame", "world")
        try:
            reply = self.call_reset()
        finally:
            rospy.delete_param("/cell/node/fixed_frame")
        self.assertFalse(reply.success)
        self.assertIn("fixed_frame", reply.message)
        self.assertEqual(self.check().header.frame_id, "root")
        self.scene.apply(clear(), add_box("crate", frame="root"))
        publisher = rospy.Publisher("/tf", TFMessage, queue_size=1)
        timer = rospy.Timer(rospy.Duration(0.02), lambda _: publish_transform(publisher, "root", "a"))
        try:
            end = time.time() + PATIENCE
            while not self.scene.send(attach("crate", "a")).success and time.time() < end:
                time.sleep(0.05)
            # What a link carries goes with it, whatever the frame is.
            self.assertEqual(self.after("/cell/node/fixed_frame", "world").header.frame_id, "world")
        finally:
            timer.shutdown()
            self.scene.apply(clear())

    def test_another_robot_and_a_mesh_that_is_missing(self):
        rospy.set_param("/cell/robot_description", robot(self.mesh, "2 1 1"))
        self.reset()
        self.assertEqual(self.distances(self.check())[("a", "b")], 1.5)
        os.rename(self.mesh, self.mesh + ".away")
        try:
            message = self.reset()
        finally:
            os.rename(self.mesh + ".away", self.mesh)
        self.assertIn("'c' is left out", message)
        self.assertIn("ball.obj", message)
        result = self.check()
        self.assertEqual((result.left_out, result.verdict), (["c"], CollisionPairs.UNKNOWN))

    def test_positions_outside_the_limits_are_said_once_a_request(self):
        state = JointState(name=JOINTS, position=[0.0, 30.0, 6.0])
        reply = self.node.check(joint_state=state)
        self.assertTrue(reply.success)
        self.assertEqual(reply.message.count("joint 'slide_b' is outside its limits"), 1)
        self.assertEqual(self.node.check(joint_state=JointState(name=JOINTS, position=PLACES)).message, "")
        check = rospy.ServiceProxy("/cell/node/check_trajectory", CheckTrajectory)
        points = [JointTrajectoryPoint(positions=[0, x, 6]) for x in (3, 30, 31)]
        reply = check(trajectory=JointTrajectory(joint_names=JOINTS, points=points))
        self.assertTrue(reply.success)
        self.assertEqual(list(reply.verdict), [CollisionPairs.FREE] * 3)
        self.assertEqual(reply.message.count("outside its limits"), 1)
        self.assertIn("at 2 points; the first is point 1, where it is 30", reply.message)

    def diagnosis(self, words, node="cell/node", is_said=True):
        """The next one that says these words, or does not."""
        end = time.monotonic() + PATIENCE
        status = diagnosis_of(node)
        while time.monotonic() < end and (words in status.message) != is_said:
            status = diagnosis_of(node)
        self.assertEqual(words in status.message, is_said, status.message)
        return status

    def test_a_description_that_is_replaced_is_named_until_it_is_read(self):
        rospy.set_param("/cell/robot_description", robot(self.mesh, "2 1 1"))
        rospy.set_param("/cell/robot_description_semantic", '<robot name="r">%s</robot>' % GROUP)
        try:
            both = "/cell/robot_description, /cell/robot_description_semantic have changed"
            self.assertIn("~reset", self.diagnosis(both).message)
            self.assertEqual(self.distances(self.check()), self.distances(self.before))
            self.reset()
            self.assertEqual(self.distances(self.check())[("a", "b")], 1.5)
        finally:
            rospy.delete_param("/cell/robot_description_semantic")
        self.diagnosis("robot_description_semantic has changed")
        self.reset()
        self.diagnosis("changed", is_said=False)

    def test_a_description_that_is_deleted_or_emptied_is_named_as_one_that_is_replaced(self):
        texts = {"robot_description_semantic": '<robot name="r"><disable_collisions link1="a" link2="b"/></robot>',
                 "environment_description": '<robot name="w">%s</robot>' % link("post", '<sphere radius="0.5"/>')}
        for name, text in texts.items():
            for delete in (rospy.delete_param, lambda key: rospy.set_param(key, "")):
                rospy.set_param("/cell/" + name, text)
                self.reset()
                checked = self.distances(self.check())
                self.assertNotEqual(checked, self.distances(self.before))
                delete("/cell/" + name)
                self.diagnosis(name + " has changed")
                self.assertEqual(self.distances(self.check()), checked)
                self.reset()
                self.diagnosis("changed", is_said=False)
                self.assertEqual(self.distances(self.check()), self.distances(self.before))
        rospy.delete_param("/cell/robot_description")
        self.diagnosis("robot_description has changed")
        self.assertFalse(self.call_reset().success)
        self.assertEqual(self.distances(self.check()), self.distances(self.before))

    def test_with_reload_auto_it_is_read_again_and_one_that_is_wrong_is_not(self):
        rospy.set_param("/auto/robot_description", robot(self.mesh))
        node = NodeClient("/auto/node")
        self.assertIsNotNone(node.next(node.reports, lambda r: r.left_out))

        def distances():
            state = JointState(name=JOINTS, position=PLACES)
            return self.distances(node.check(joint_state=state, alarm_distance=20.0).result)

        def expect_distance(expected):
            end = time.monotonic() + PATIENCE
            found = None
            while time.monotonic() < end and found != expected:
                found = distances()[("a", "b")]
            self.assertEqual(found, expected)
        expect_distance(2.0)
        rospy.set_param("/auto/robot_description", robot(self.mesh, "2 1 1"))
        expect_distance(1.5)
        srdf = '<robot name="r"><disable_collisions link1="a" link2="c"/></robot>'
        for text, has_pair in ((srdf, False), ("", True), (srdf, False), (None, True)):
            if text is None:
                rospy.delete_param("/auto/robot_description_semantic")
            else:
                rospy.set_param("/auto/robot_description_semantic", text)
            end = time.monotonic() + PATIENCE
            while time.monotonic() < end and (("a", "c") in distances()) != has_pair:
                time.sleep(0.1)
            self.assertEqual(("a", "c") in distances(), has_pair)
        rospy.delete_param("/auto/robot_description")
        self.diagnosis("it cannot be reloaded: there is no parameter robot_description", "auto/node")
        expect_distance(1.5)
        rospy.set_param("/auto/robot_description", "<robot name='r'>")
        self.diagnosis("cannot be reloaded", "auto/node")
        expect_distance(1.5)


if __name__ == "__main__":
    rospy.init_node("reset_test")
    rostest.rosrun("collision_pairs", "reset_test", ResetTest)
