#!/usr/bin/python3
"""Point clouds as obstacles: what is seen, what is not believed, and never FREE without a fresh cloud."""
import os
import random
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import rostest
from sensor_msgs.msg import JointState, PointCloud2
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from cloud_client import CloudPublisher, cloud_diagnosis, cloud_of, other_clouds
from collision_pairs.msg import CollisionPairs
from collision_pairs.srv import CheckCollisionsRequest, CheckTrajectory
from node_client import NodeClient
from scene_client import SceneClient, add_box, attach, clear, detach, remove
from transform_faults import APART, BoxPublisher

FREE, COLLISION, UNKNOWN = CollisionPairs.FREE, CollisionPairs.COLLISION, CollisionPairs.UNKNOWN
CLOUD = "camera/points"
NAMED = "cloud '%s': " % CLOUD
CAMERA_X = 20.0                       # m: where TF has the camera in root
FAR = [(0.0 - CAMERA_X, 5.0, 0.0)]    # in the camera's frame
BESIDE_A = [(0.05 - CAMERA_X, 0.58, 0.05)]   # its voxel begins where box a ends


class CloudsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.boxes = BoxPublisher(["a", "b", "c", "camera"])
        cls.boxes.x = dict(APART, camera=CAMERA_X)
        cls.boxes.heal()
        cls.node = NodeClient("/node")
        cls.wait_for = cls.node.wait_for
        # All links are known, but no cloud has come.
        cls.first = cls.node.next(cls.node.reports, lambda r: r.left_out == [CLOUD])
        cls.camera = CloudPublisher("/" + CLOUD, "camera")
        cls.filtered = []
        rospy.Subscriber("/node/filtered_cloud", PointCloud2, cls.filtered.append)
        cls.trajectory = rospy.ServiceProxy("/node/check_trajectory", CheckTrajectory)

    @classmethod
    def tearDownClass(cls):
        cls.camera.stop()
        cls.boxes.stop()

    def setUp(self):
        self.boxes.heal()
        self.boxes.x = dict(APART, camera=CAMERA_X)
        self.forget()
        self.wait_for(FREE)

    def forget(self):
        """What vanished in front of the camera is not missed."""
        self.camera.points = FAR
        self.assertTrue(rospy.ServiceProxy("/node/clear_clouds", Trigger)().success)
        self.show(FAR)

    def show(self, points):
        """Returns when a cloud of these points is what is known."""
        begin = rospy.Time.now()
        self.camera.heal(points, "camera")
        self.assertIsNotNone(self.node.next(self.filtered, lambda cloud: cloud.header.stamp > begin))

    def test_01_before_the_first_cloud_the_verdict_is_unknown_and_names_the_cloud(self):
        self.assertIsNotNone(self.first)
        self.assertEqual((self.first.verdict, self.first.in_collision), (UNKNOWN, True))
        self.assertIn(NAMED + "none has arrived yet on /camera/points", self.first.unknown_because)

    def test_what_comes_and_goes_is_collision_and_free_again(self):
        self.camera.points = BESIDE_A
        report = self.wait_for(COLLISION)
        self.assertEqual([(p.first_link, p.second_link) for p in report.pairs], [("a", CLOUD)])
        for y in (0.7, 0.9, 1.1, 1.3):
            self.show([(0.05 - CAMERA_X, y, 0.05)])
        self.wait_for(FREE)

    def test_what_is_held_against_a_link_is_unknown_for_as_long_as_it_is_not_seen_to_leave(self):
        for y in (0.9, 0.7, 0.58, 0.58, 0.52):  # the last is within the padding
            self.show([(0.05 - CAMERA_X, y, 0.05)])
        words = NAMED + "something vanished 5 cm from a: it may touch; if it is gone, ~clear_clouds starts anew"
        self.wait_for(UNKNOWN, words)
        rospy.sleep(0.6)  # longer than source_timeout
        begin = len(self.node.reports)
        self.wait_for(UNKNOWN, words)
        self.assertIn(words, self.node.check().result.unknown_because)
        self.assertEqual({r.verdict for r in self.node.reports[begin:]}, {UNKNOWN})
        for y in (0.6, 0.7, 0.9, 1.1):
            self.show([(0.05 - CAMERA_X, y, 0.05)])
        self.wait_for(FREE)

    def test_what_may_touch_does_so_by_other_settings_too(self):
        for y in (0.9, 0.7, 0.58, 0.58, 0.52):
            self.show([(0.05 - CAMERA_X, y, 0.05)])
        words = NAMED + "something vanished 5 cm from a: it may touch"
        self.wait_for(UNKNOWN, words)
        with other_clouds("/node") as (given, use):
            for decay in (0.7, 0.8):
                self.assertTrue(use(dict(given, decay=decay)).success)
                self.show([(0.05 - CAMERA_X, 0.52, 0.05)])
                self.wait_for(UNKNOWN, words)
            self.forget()
            self.wait_for(FREE)

    def test_a_source_that_stops_is_unknown_by_name_until_it_comes_again(self):
        self.camera.points = BESIDE_A
        self.wait_for(COLLISION)
        self.camera.silent = True
        report = self.wait_for(UNKNOWN, NAMED + "the newest is", "source_timeout is 0.50 s")
        self.assertIn(CLOUD, report.left_out)
        self.assertEqual(self.node.check().result.verdict, UNKNOWN)
        self.camera.silent = False
        self.wait_for(COLLISION)

    def test_without_a_transform_of_the_sensor_the_cloud_is_not_used(self):
        self.camera.frame = "nowhere"
        self.wait_for(UNKNOWN, NAMED, "each camera needs a topic of its own")
        self.assertTrue(rospy.ServiceProxy("/node/clear_clouds", Trigger)().success)
        self.wait_for(UNKNOWN, "TF has no poses of the sensor ('nowhere')")
        self.assertIsNotNone(cloud_diagnosis(lambda d: "nowhere" in d["message"]))

    def test_without_the_robots_pose_at_its_stamp_the_cloud_is_not_used(self):
        self.boxes.fault = {"b": "silent"}
        self.wait_for(UNKNOWN, "TF has no poses of the sensor ('camera') and the robot at", "'b'")

    def test_an_earlier_stamp_than_the_one_before_is_refused(self):
        def spoil(cloud):
            cloud.header.stamp -= rospy.Duration(random.choice([0.0, 0.2]))
        self.camera.spoil = spoil
        self.wait_for(UNKNOWN, NAMED, "not later than that of the previous cloud")

    def test_malformed_clouds_are_refused_and_named_in_the_diagnostics(self):
        def without_z(cloud):
            del cloud.fields[2]

        def short_data(cloud):
            cloud.data = cloud.data[:-1]
        for spoil, words in ((without_z, "no field 'z'"), (short_data, "its data has 11 bytes")):
            self.camera.spoil = spoil
            self.wait_for(UNKNOWN, NAMED, words)
            found = cloud_diagnosis(lambda d: words in d["message"])
            self.assertIsNotNone(found, words)
            self.assertIn(words, found[CLOUD + " problem"])
            self.camera.spoil = None
            self.wait_for(FREE)

    def test_in_a_frame_that_nothing_connects_is_not_free_from_the_first_cloud_on(self):
        self.camera.silent = True
        seen = rospy.Time.now()
        self.camera.send(cloud_of(FAR, "unconnected", seen))
        self.wait_for(UNKNOWN, "'unconnected'")
        # A cloud that waits for its transforms is refused after a second; here it was known before that.
        self.assertLess((rospy.Time.now() - seen).to_sec(), 0.45, "not before the cloud of before was too old")

    def test_a_request_at_a_stamp_does_not_mix_its_poses_with_the_newest_clouds(self):
        then = rospy.Time.now() - rospy.Duration(0.3)
        state = JointState(name=["slide_a", "slide_b", "slide_c"], position=[0.0, 3.0, 6.0])
        for request in (CheckCollisionsRequest(stamp=then), CheckCollisionsRequest(stamp=then, joint_state=state)):
            reply = self.node.check(request)
            self.assertTrue(reply.success, reply.message)
            self.assertEqual((reply.result.verdict, reply.result.left_out), (UNKNOWN, [CLOUD]))
            self.assertIn("only the newest clouds are kept", " ".join(reply.result.unknown_because))
        points = [JointTrajectoryPoint(positions=p) for p in ([0, 3, 6], [0, 4, 8])]
        answer = self.trajectory(stamp=then, between=True, trajectory=JointTrajectory(joint_names=state.name, points=points))
        self.assertEqual((list(bytes(answer.verdict)), list(bytes(answer.segment_verdict))), ([UNKNOWN] * 2, [UNKNOWN]))
        self.assertIn("only the newest clouds are kept", " ".join(answer.unknown_because))

    def test_ten_million_points_end_nothing(self):
        self.camera.silent = True
        before = int(cloud_diagnosis(lambda d: True)[CLOUD + " received"])
        nb_points = 10 * 1000 * 1000
        cloud = cloud_of([], "camera")
        cloud.width, cloud.row_step, cloud.data = nb_points, 12 * nb_points, bytes(12 * nb_points)
        self.camera.send(cloud)
        self.assertIsNotNone(cloud_diagnosis(lambda d: int(d[CLOUD + " received"]) > before))
        self.show(FAR)
        self.wait_for(FREE)

    def test_clear_clouds_forgets_everything_until_the_source_comes_again(self):
        self.camera.points = BESIDE_A
        self.wait_for(COLLISION)
        self.camera.silent = True
        self.assertTrue(rospy.ServiceProxy("/node/clear_clouds", Trigger)().success)
        self.wait_for(UNKNOWN, NAMED + "none has arrived yet")
        self.camera.heal(FAR, "camera")
        self.wait_for(FREE)

    def test_services_see_the_clouds_of_the_cycle(self):
        self.show([(1.53 - CAMERA_X, 0.0, 0.0)])  # between a (to 0.5) and b (from 2.5), not on a border of voxels
        self.wait_for(FREE)
        state = JointState(name=["slide_a", "slide_b", "slide_c"], position=[0.0, 2.0, 6.0])
        reply = self.node.check(CheckCollisionsRequest(joint_state=state))
        self.assertTrue(reply.success, reply.message)
        self.assertEqual(reply.result.verdict, COLLISION)
        self.assertEqual([(p.first_link, p.second_link) for p in reply.result.pairs], [("b", CLOUD)])
        points = [JointTrajectoryPoint(positions=p) for p in ([0, 3, 6], [0, 2, 6], [-3, 0, 6])]
        answer = self.trajectory(trajectory=JointTrajectory(joint_names=state.name, points=points), between=True)
        self.assertTrue(answer.success, answer.message)
        self.assertEqual(list(bytes(answer.verdict)), [FREE, COLLISION, FREE])
        # Into the voxel, and through it.
        self.assertEqual(list(bytes(answer.segment_verdict)), [COLLISION, COLLISION])

    def test_a_scene_that_is_reset_goes_on_with_its_clouds(self):
        self.camera.points = BESIDE_A
        self.wait_for(COLLISION)
        self.assertTrue(rospy.ServiceProxy("/node/reset", Trigger)().success)
        before = len(self.node.reports)
        self.wait_for(COLLISION)
        self.assertEqual({r.verdict for r in self.node.reports[before:]}, {COLLISION})

    def test_a_changed_list_of_clouds_is_read_by_reset_and_a_wrong_one_is_refused(self):
        self.camera.points = BESIDE_A
        self.wait_for(COLLISION)
        with other_clouds("/node") as (given, use):
            reply = use(dict(given, voxelsize=0.1))
            self.assertFalse(reply.success)
            self.assertIn("'voxelsize' is not a setting of a cloud; did you mean 'voxel_size'?", reply.message)
            self.wait_for(COLLISION)
            reply = use(dict(given, max_range=1.0, min_valid_points=0))
            self.assertTrue(reply.success, reply.message)
            self.wait_for(FREE)  # the point is further from the camera
            self.assertTrue(use().success)
            self.camera.silent = True
            self.wait_for(FREE)
            self.assertFalse(rospy.ServiceProxy("/node/clear_clouds", Trigger)().success)

    def test_what_was_filtered_with_an_object_is_not_free_before_a_cloud_without_it(self):
        scene = SceneClient("/node")
        held = [add_box("tool", (0.05, 0.72, 0.05), frame="root"), attach("tool", "a")]
        for let_go in (remove("tool"), detach("tool"), clear()):
            scene.apply(*held)
            self.show(BESIDE_A)
            self.wait_for(FREE)
            self.camera.silent = True
            last = cloud_of(BESIDE_A, "camera")
            self.camera.send(last)  # once it is used no other is on its way
            self.assertIsNotNone(self.node.next(self.filtered, lambda cloud: cloud.header.stamp >= last.header.stamp))
            reply = scene.send(let_go)
            self.assertTrue(reply.success, reply.message)
            self.wait_for(UNKNOWN, NAMED + "none has arrived since the robot, or what is attached to it, changed")
            self.assertEqual(self.node.check().result.verdict, UNKNOWN)
            self.camera.heal(BESIDE_A, "camera")
            self.wait_for(COLLISION)
            scene.apply(clear())
            self.forget()
            self.wait_for(FREE)


if __name__ == "__main__":
    rospy.init_node("test_clouds")
    rostest.rosrun("collision_pairs", "clouds", CloudsTest)
