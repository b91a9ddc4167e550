#!/usr/bin/python3
"""Requests that ask for the pairs of some links only: a group of the SRDF, names, patterns."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import rostest
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from collision_pairs.msg import CollisionPairs
from collision_pairs.srv import CheckTrajectory
from scene_client import SceneCase, add_box, clear, remove

ALL = {("a", "b"), ("a", "c"), ("b", "c"), ("a", "post"), ("b", "post"), ("c", "post")}


def with_any(*names):
    return {pair for pair in ALL if set(pair) & set(names)}


class RestrictedRequestsTest(SceneCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.check_trajectory = rospy.ServiceProxy("/node/check_trajectory", CheckTrajectory)

    def setUp(self):
        """All three links in one place, and a post there too: every pair is in contact."""
        since = self.robot.hold([0, 0, 0])
        self.scene.apply(clear(), add_box("post"))
        self.assertIsNotNone(self.node.report_since(since, lambda r: not r.left_out and len(r.pairs) == len(ALL)))

    def pairs(self, **fields):
        reply = self.node.check(**fields)
        self.assertTrue(reply.success, reply.message)
        self.assertEqual(reply.result.left_out, [])
        return {(pair.first_link, pair.second_link) for pair in reply.result.pairs}

    def test_only_pairs_with_one_of_them_are_looked_at(self):
        for fields, names in ((dict(group="first"), "a"), (dict(group="last"), "c"), (dict(links=["b"]), "b"),
                              (dict(links=["a", "c"]), "ac"), (dict(links=["[ab]"]), "ab"),
                              (dict(group="first", links=["?"]), "abc")):
            self.assertEqual(self.pairs(**fields), with_any(*names), fields)
        self.assertEqual(self.pairs(links=["po*"]), with_any("post"))
        self.assertEqual(self.pairs(), ALL)

    def test_a_restriction_is_of_its_request_alone(self):
        self.pairs(group="first")
        since = rospy.Time.now()
        report = self.node.report_since(since)
        self.assertEqual(len(report.pairs), len(ALL))

    def test_a_restricted_request_sees_an_update_at_once(self):
        for _ in range(5):
            self.assertEqual(self.pairs(group="first"), with_any("a"))
            self.scene.apply(remove("post"))
            self.assertEqual(self.pairs(group="first"), {("a", "b"), ("a", "c")})
            self.scene.apply(add_box("post"))

    def test_a_restriction_to_what_comes_and_goes_is_refused_while_it_is_not_there(self):
        self.assertEqual(self.pairs(links=["post"]), with_any("post"))
        self.scene.apply(remove("post"))
        reply = self.node.check(links=["post"])
        self.assertFalse(reply.success)
        self.assertIn("'post'", reply.message)

    def test_groups_and_links_that_are_none_are_named_with_the_ones_that_are_meant(self):
        for fields, says in ((dict(group="firts"), ("'firts'", "did you mean 'first'?")),
                             (dict(links=["b", "cc"]), ("'cc'", "did you mean 'c'?"))):
            for reply in (self.node.check(**fields), self.check_trajectory(**fields)):
                self.assertFalse(reply.success)
                for words in says:
                    self.assertIn(words, reply.message)
        self.assertEqual(self.pairs(), ALL)

    def test_a_pattern_that_matches_nothing_leaves_nothing_to_look_at(self):
        result = self.node.check(links=["left_*"]).result
        self.assertEqual((result.nb_boxes, result.pairs), (0, []))
        self.assertEqual((result.verdict, result.in_collision), (CollisionPairs.UNKNOWN, True))
        self.assertIn("no pair to check", " ".join(result.unknown_because))
        trajectory = JointTrajectory(joint_names=["slide_a"], points=[JointTrajectoryPoint(positions=[0.0])])
        reply = self.check_trajectory(trajectory=trajectory, links=["left_*"], want_reports=True)
        self.assertEqual((list(reply.verdict), reply.reports[0].verdict), ([CollisionPairs.UNKNOWN], CollisionPairs.UNKNOWN))
        self.assertIn("no pair to check", " ".join(reply.unknown_because))

    def test_a_trajectory_without_points_is_refused(self):
        reply = self.check_trajectory(trajectory=JointTrajectory(joint_names=["slide_a"]))
        self.assertFalse(reply.success)
        self.assertIn("no points", reply.message)

    def test_a_trajectory_of_velocities_alone_is_refused(self):
        for fields in (dict(velocities=[0.5]), dict(accelerations=[0.5]), dict(effort=[0.5])):
            points = [JointTrajectoryPoint(), JointTrajectoryPoint(**fields)]
            reply = self.check_trajectory(trajectory=JointTrajectory(points=points), between=True)
            self.assertEqual((reply.success, list(reply.verdict)), (False, []))
            self.assertIn("but no names and positions", reply.message)
        timed = [JointTrajectoryPoint(time_from_start=rospy.Duration(1.0))]
        reply = self.check_trajectory(trajectory=JointTrajectory(points=timed))
        self.assertEqual((reply.success, reply.message), (False, "the trajectory has times, but no joint_names"))

    def test_of_several_links_one_that_meets_nothing_is_refused(self):
        reply = self.node.check(links=["a", "nothing_*"])
        self.assertEqual((reply.success, reply.message), (False, "links: 'nothing_*' is nothing that is checked"))

    def test_trajectories_are_restricted_like_single_states(self):
        points = [JointTrajectoryPoint(positions=[x]) for x in (0.0, 5.0)]
        trajectory = JointTrajectory(joint_names=["slide_a"], points=points)
        for fields, expected in ((dict(group="first"), [True, False]), (dict(links=["b"]), [True, True])):
            reply = self.check_trajectory(trajectory=trajectory, want_reports=True, **fields)
            self.assertTrue(reply.success, reply.message)
            self.assertEqual(list(reply.in_collision), expected)
        self.assertEqual({(p.first_link, p.second_link) for p in reply.reports[1].pairs},
                         with_any("b") - {("a", "b")})


if __name__ == "__main__":
    rospy.init_node("test_restricted_requests")
    rostest.rosrun("collision_pairs", "restricted_requests", RestrictedRequestsTest)
