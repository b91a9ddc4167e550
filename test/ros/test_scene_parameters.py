#!/usr/bin/python3
"""What parameters say of the scene: environment, floor, rules about pairs, paddings, what is left aside."""
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticStatus
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger
from visualization_msgs.msg import Marker, MarkerArray

from node_client import JointPublisher, NodeClient, diagnosis_of
from scene_client import SceneClient, add_box

LINKS = ["slide_a", "slide_b", "slide_c"]

WRONG_WORLD = ("<robot name='world'><link name='a'><collision><geometry><sphere radius='1'/></geometry></collision>"
               "</link></robot>")
REFUSED = (
    ("node/pair_rules", "deny", ("pair_rules is deny", "a list of")),
    ("node/pair_rules", [{"deny": ["a"]}], ("pair_rules is [a]", "two names")),
    ("node/pair_rules", [{"deny": ["a", "b"], "allow": ["a", "c"]}], ("pair_rules", "{deny: [first, second]}")),
    ("node/pair_padding", [{"pair": ["a", "b"], "padding": -1.0}], ("pair_padding is -1", "0 or more")),
    ("node/pair_padding", [{"pair": ["a", "cc"], "padding": 0.1}], ("pair_padding", "'cc'", "did you mean 'c'?")),
    ("node/padding", -0.5, ("padding is -0.5", "0 or more metres")),
    ("node/narrow_phase", "bullet", ("narrow_phase is bullet", "native or fcl")),
    ("node/paddding", 0.1, ("/ignored/node/paddding", "did you mean 'padding'?")),
    ("node/pair_rule", [{"deny": ["a", "b"]}], ("/ignored/node/pair_rule", "did you mean 'pair_rules'?")),
    ("node/robot", [{"description": "robot_description"}], ("/ignored/node/robot", "did you mean 'robots'?")),
    ("node/link", ["a"], ("/ignored/node/link", "did you mean 'links'?")),
    ("node/environment_descriptoin", WRONG_WORLD, ("/ignored/node/env", "did you mean 'environment_description'?")),
    ("node/padding", "thick", ("padding is thick", "0 or more metres")),
    ("node/link_padding", {"cc": 0.1}, ("link_padding", "'cc'", "did you mean 'c'?")),
    ("node/ignored_links", "b", ("ignored_links is b", "a list of names")),
    ("node/ignored_links", ["bb"], ("ignored_links", "'bb'", "did you mean 'b'?")),
    ("node/cylinder_as_capsule", ["bb"], ("cylinder_as_capsule", "'bb'", "did you mean 'b'?")),
    ("node/floor", {"hight": 0.0}, ("floor is {hight", "{height: metres")),
    ("node/floor", {"touch_links": ["a"]}, ("floor is", "{height: metres")),
    ("node/floor", {"height": 0.0, "touch_links": ["bb"]}, ("'floor'", "touch_links", "'bb'", "did you mean 'b'?")),
    ("node/group", "first", ("'first'", "no SRDF")),
    ("node/links", ["bb"], ("'bb'", "did you mean 'b'?")),
    ("node/robots", {"description": "robot_description"}, ("/ignored/node/robots", "is not a list")),
    ("node/robots", 5, ("/ignored/node/robots", "is not a list")),
    ("node/robots", [{"urdf": "robot_description"}], ("/ignored/node/robots", "is not a list of {description")),
    ("node/robots", [{"description": "nowhere", "prefix": "left"}], ("no parameter nowhere",)),
    ("node/robots", [{"description": "robot_description"}] * 2, ("same name", "different prefix")),
    ("environment_description", "<robot name='world'>", ("/ignored/environment_description",)),
    ("environment_description", 5, ("/ignored/environment_description is not text",)),
    ("robot_description_semantic", {"robot": 1}, ("/ignored/robot_description_semantic is not text",)),
    ("environment_description", WRONG_WORLD, ("'a'", "in the robot and in the world")),
)


def names_of(pairs):
    return [(pair.first_link, pair.second_link) for pair in pairs]


class SceneParametersTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = JointPublisher(LINKS)
        cls.since = cls.robot.hold([0, 0, 0])

    def client(self, namespace):
        node = NodeClient("/" + namespace + "/node")
        report = node.report_since(self.since, lambda r: not r.left_out)
        self.assertIsNotNone(report)
        return node

    def distances(self, node, positions, names=LINKS, **fields):
        """{pair: distance} in a hypothetical state."""
        reply = node.check(joint_state=JointState(name=names, position=positions), **fields)
        self.assertTrue(reply.success, reply.message)
        return {(p.first_link, p.second_link): round(p.distance, 9) for p in reply.result.pairs}

    def test_the_environment_and_the_floor_stand_still_and_are_checked_against_the_robot_alone(self):
        node = self.client("cell")
        found = self.distances(node, [0, 3, 6])
        self.assertEqual(found, {("a", "floor"): 0.02, ("c", "floor"): 0.02, ("a", "table"): 0.03,
                                 ("b", "table"): 0.03, ("c", "table"): 0.03, ("b", "column"): 0.01})
        self.assertNotIn(("b", "floor"), self.distances(node, [0, 3, 6], alarm_distance=1.0))
        self.assertEqual(node.check(links=["column", "table"]).result.nb_boxes, 5)

    def test_a_link_of_the_environment_has_its_name_for_itself(self):
        node = self.client("cell")
        scene = SceneClient("/cell/node")
        for name in ("table", "floor"):
            reply = scene.send(add_box(name))
            self.assertFalse(reply.success)
            self.assertIn("'%s'" % name, reply.message)
        self.assertNotIn(("floor", "table"), self.distances(node, [0, 3, 6], alarm_distance=9.0))

    def test_the_last_rule_that_matches_a_pair_decides_it_whatever_the_srdf_says(self):
        node = self.client("rules")
        SceneClient("/rules/node").apply(add_box("crate_1"), add_box("crate_2"), add_box("post"))
        self.assertEqual(set(self.distances(node, [0, 0, 0])),
                         {("a", "c"), ("b", "crate_1"), ("c", "post")})

    def test_paddings_are_those_of_the_pair_or_else_the_sum_of_both(self):
        node = self.client("paddings")
        self.assertEqual(self.distances(node, [0, 1.03, 2.06], alarm_distance=0.1),
                         {("a", "b"): 0.018, ("b", "c"): 0.025})
        touching = self.distances(node, [0, 1.012 - 1e-6, 9], alarm_distance=-1.0)
        self.assertEqual(list(touching), [("a", "b")])
        self.assertEqual(self.distances(node, [0, 1.012 + 1e-6, 9], alarm_distance=-1.0), {})

    def test_a_misspelt_parameter_that_leaves_no_pair_out_is_named_by_diagnostics(self):
        self.client("paddings")
        status = diagnosis_of("paddings/node")
        self.assertEqual(status.level, DiagnosticStatus.WARN)
        self.assertIn("/paddings/node/max_pos_age", status.message)
        self.assertIn("did you mean 'max_pose_age'?", status.message)

    def test_a_report_says_who_answered_and_fcl_gives_the_same_distances_as_the_native_narrow_phase(self):
        by_fcl, native = self.client("fcl"), self.client("cell")
        self.assertEqual(by_fcl.next(by_fcl.reports).narrow_phase, "fcl")
        self.assertEqual(native.next(native.reports).narrow_phase, "native")
        apart = by_fcl.check(joint_state=JointState(name=LINKS, position=[0, 1.03, 3])).result
        self.assertEqual([round(pair.distance, 9) for pair in apart.pairs], [0.03])
        self.assertEqual(apart.nb_answered_natively, 0)
        deep = by_fcl.check(joint_state=JointState(name=LINKS, position=[0, 0.9, 3])).result
        self.assertEqual([round(pair.distance, 9) for pair in deep.pairs], [-0.1])
        self.assertEqual(deep.nb_answered_natively, 1)  # FCL has no depth of two boxes

    def test_an_ignored_link_is_in_no_pair_and_gets_no_box(self):
        node = self.client("ignored")
        self.assertEqual(list(self.distances(node, [0, 0, 0])), [("a", "c")])
        self.assertEqual(node.check().result.nb_boxes, 2)

    def test_a_node_that_is_restricted_to_a_group_answers_other_requests_all_the_same(self):
        node = self.client("restricted")
        self.assertEqual(names_of(node.next(node.reports).pairs), [("a", "b"), ("a", "c")])
        self.assertEqual(list(self.distances(node, [0, 0, 0])), [("a", "b"), ("a", "c")])
        self.assertEqual(list(self.distances(node, [0, 0, 0], links=["c"])), [("a", "c"), ("b", "c")])

    def test_a_cylinder_taken_as_a_capsule_is_longer_by_its_radius_and_is_drawn_so(self):
        node = NodeClient("/capsule/node")
        above = 0.1 + 0.1 + 0.2  # half the plate, the radius, half the rod
        self.assertEqual(self.distances(node, [above + 0.03, 0.0], ["lift", "press"]), {("plate", "rod"): 0.03})
        array = rospy.wait_for_message("/capsule/node/scene_markers", MarkerArray, 20)
        rod = sorted(m.type for m in array.markers if m.header.frame_id == "rod")
        self.assertEqual(rod, [Marker.SPHERE, Marker.SPHERE, Marker.CYLINDER])

    def assert_diagnosed(self, namespace, *says):
        status = diagnosis_of(namespace + "/node")
        self.assertEqual(status.level, 2)
        for words in says:
            self.assertIn(words, status.message)
        self.assertFalse(NodeClient("/" + namespace + "/node").check().success)

    def test_a_rule_that_cannot_be_read_is_in_the_diagnostics_of_a_node_that_stays_up(self):
        self.assert_diagnosed("wrong_rule", "/wrong_rule/node", "pair_rules", "forbid", "deny: [first, second]")

    def test_a_rule_about_no_link_is_diagnosed_and_once_mended_taken(self):
        self.assert_diagnosed("wrong_link", "pair_rules", "'aa'", "did you mean 'a'?")
        node = NodeClient("/wrong_link/node")
        rospy.set_param("/wrong_link/node/pair_rules", [{"deny": ["a", "*"]}])
        self.assertIsNotNone(node.next(node.reports, lambda r: r.left_out or r.nb_boxes))
        self.assertEqual(list(self.distances(node, [0, 0, 0])), [("b", "c")])

    def test_parameters_that_are_refused_at_a_reset_leave_the_old_scene(self):
        node = self.client("ignored")
        reset = rospy.ServiceProxy("/ignored/node/reset", Trigger)
        for name, value, says in REFUSED:
            name = "/ignored/" + name
            before = rospy.get_param(name, None)
            rospy.set_param(name, value)
            reply = reset()
            rospy.delete_param(name)
            if before is not None:
                rospy.set_param(name, before)
            self.assertFalse(reply.success, (name, value))
            for words in ("old scene is kept",) + says:
                self.assertIn(words, reply.message)
            self.assertEqual(list(self.distances(node, [0, 0, 0])), [("a", "c")])
        reply = reset()
        self.assertTrue(reply.success, reply.message)


if __name__ == "__main__":
    rospy.init_node("test_scene_parameters")
    rostest.rosrun("collision_pairs", "scene_parameters", SceneParametersTest)
