#!/usr/bin/python3
"""The image of the simulated camera: rows and columns, what is seen where it was put, and how much noise there is."""
import math
import os
import subprocess
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import numpy as np
import roslib.packages
import rospy
import rostest
import tf2_ros
from sensor_msgs.msg import PointCloud2
from tf2_msgs.msg import TFMessage

from node_client import PATIENCE, JointPublisher, publish_transform

CAMERA = np.array([1.5, -1.1, 1.75])  # metres, in the world
LOOKS_AT = np.array([0.3, 0.0, 1.1])
WIDTH, HEIGHT, VIEW = 320, 240, 1.0  # pixels; rad of the width
BALL, RADIUS = np.array([0.42, -0.5, 1.45]), 0.09
BALL_FROM, BALL_TO, PERIOD = np.array([0.42, -0.9, 1.45]), np.array([0.42, 0.9, 1.45]), 10.0  # by default
PARCEL, HALF = np.array([0.72, -0.38, 0.76]), np.array([0.1, 0.08, 0.06])
NOISE = 0.003
JOINTS = ["shoulder_pan", "shoulder_lift", "upper_arm_roll", "elbow_flex", "forearm_roll", "wrist_flex", "wrist_roll",
          "gripper"]


def rays():
    """In the camera's frame, at depth 1."""
    focal_length = 0.5 * WIDTH / math.tan(0.5 * VIEW)
    u, v = np.meshgrid(np.arange(WIDTH) - 0.5 * (WIDTH - 1), np.arange(HEIGHT) - 0.5 * (HEIGHT - 1))
    return np.dstack([u / focal_length, v / focal_length, np.ones_like(u)])


def axes():
    """Columns: right, down and forward of the camera, in the world."""
    forward = (LOOKS_AT - CAMERA) / np.linalg.norm(LOOKS_AT - CAMERA)
    right = np.cross(forward, [0, 0, 1])
    right /= np.linalg.norm(right)
    return np.column_stack([right, np.cross(forward, right), forward])


def depth_of_ball(center, radius):
    """For each pixel; nan where its ray passes the ball."""
    c, d = axes().T @ (center - CAMERA), rays()
    a, b = (d * d).sum(2), d @ c
    with np.errstate(invalid="ignore"):
        return (b - np.sqrt(b * b - a * (c @ c - radius * radius))) / a


def points_of(cloud):
    assert [(f.name, f.offset, f.datatype) for f in cloud.fields] == [(n, 4 * i, 7) for i, n in enumerate("xyz")]
    numbers = np.frombuffer(cloud.data, np.float32).reshape(cloud.height, cloud.width, cloud.point_step // 4)
    return numbers[:, :, :3].astype(float)


class DepthCameraTest(unittest.TestCase):
    def assert_noise(self, errors):
        self.assertGreater(errors.size, 300)
        self.assertLess(abs(errors.mean()), 5 * NOISE / math.sqrt(errors.size))
        self.assertAlmostEqual(errors.std() / NOISE, 1.0, delta=5 / math.sqrt(2 * errors.size))

    def test_it_shows_the_ball_and_the_parcel_where_they_are_row_by_row(self):
        JointPublisher(JOINTS).hold([0.0] * len(JOINTS))
        cloud = rospy.wait_for_message("points", PointCloud2, PATIENCE)
        self.assertEqual((cloud.height, cloud.width), (HEIGHT, WIDTH))
        self.assertEqual(cloud.row_step, cloud.width * cloud.point_step)
        self.assertFalse(cloud.is_dense)
        points = points_of(cloud)
        seen = np.isfinite(points[:, :, 2])
        self.assertTrue(seen.any() and not seen.all())
        np.testing.assert_allclose((points / points[:, :, 2:])[seen], rays()[seen], atol=1e-5)

        buffer = tf2_ros.Buffer()
        listener = tf2_ros.TransformListener(buffer)
        pose = buffer.lookup_transform("world", cloud.header.frame_id, rospy.Time(0), rospy.Duration(10)).transform
        listener.unregister()
        p, q = pose.translation, pose.rotation
        np.testing.assert_allclose([p.x, p.y, p.z], CAMERA, atol=1e-12)
        axis = np.array([q.x, q.y, q.z])
        for i, unit in enumerate(np.eye(3)):
            turned = unit + 2 * np.cross(axis, np.cross(axis, unit) + q.w * unit)
            np.testing.assert_allclose(turned, axes()[:, i], atol=1e-9)

        in_world = points @ axes().T + CAMERA
        truth = depth_of_ball(BALL, RADIUS)
        on_ball = seen & np.isfinite(truth)
        self.assert_noise((points[:, :, 2] - truth)[on_ball])
        outside = np.abs(in_world - PARCEL) - HALF
        of_parcel = in_world[np.abs(outside.max(2)) < 4 * NOISE]
        for side, face in ((2, HALF[2]), (1, -HALF[1])):  # those that the camera sees, and nothing hides
            on_face = np.abs(of_parcel[:, side] - PARCEL[side] - face) < 2 * NOISE
            others = [axis for axis in range(3) if axis != side]
            spread = np.ptp(of_parcel[on_face][:, others], axis=0)
            self.assertTrue((spread > 1.6 * HALF[others]).all(), (side, spread))

    def test_it_shows_the_robot_and_a_moving_ball_where_they_were_at_the_stamp_of_the_cloud(self):
        clouds = []
        rospy.Subscriber("own/points", PointCloud2, clouds.append)
        rospy.sleep(1.0)
        self.assertEqual(clouds, [], "nobody knows where the robot is")
        place = np.array([0.3, 0.3, 0.9])
        publisher = rospy.Publisher("/tf", TFMessage, queue_size=10)
        timer = rospy.Timer(rospy.Duration(0.01), lambda _: publish_transform(publisher, "own_root", "own_ball", place))
        begin = rospy.get_time()
        end = begin + PATIENCE
        while rospy.get_time() < end and (len(clouds) < 30 or rospy.get_time() < begin + 0.4 * PERIOD):
            rospy.sleep(0.05)
        took = rospy.get_time() - begin
        timer.shutdown()
        timer.join()
        rospy.sleep(0.3)
        nb_clouds = len(clouds)
        rospy.sleep(0.5)
        self.assertEqual(len(clouds), nb_clouds, "the robot is not seen again where it was seen")
        self.assertLess(nb_clouds, 16.0 * (took + 0.5) + 2)

        stamps = [cloud.header.stamp.to_sec() for cloud in clouds]
        self.assertTrue((np.diff(stamps) > 0).all())
        self.assertGreater(stamps[0], begin)
        errors, places = [], []
        of_robot = depth_of_ball(place + [0, 0, 0.1], 0.2)
        for stamp, cloud in zip(stamps, clouds):
            share = 0.5 - 0.5 * math.cos(2 * math.pi * stamp / PERIOD)
            center = (1 - share) * BALL_FROM + share * BALL_TO
            depth = points_of(cloud)[:, :, 2]
            truth = np.fmin(of_robot, depth_of_ball(center, RADIUS))
            # Phases of today's time in double precision have steps of 2.4e-7 rad, by which the node, which rounds in
            # another order, may have the ball up to 2.1e-7 m elsewhere: a ray that grazes it here may pass it there.
            is_hit = np.isfinite(np.fmin(of_robot, depth_of_ball(center, RADIUS - 1e-6)))
            missing = np.argwhere(is_hit & ~np.isfinite(depth))
            self.assertEqual(missing.size, 0, "missing: %s in cloud %d of %d, %.3f s after the first, ball at %s" % (
                missing[:5], len(errors), nb_clouds, stamp - stamps[0], center))
            errors.append((depth - truth)[is_hit])
            places.append(share)
        self.assert_noise(np.concatenate(errors))
        self.assertGreater(max(places) - min(places), 0.3, "the ball did not move")
        pixel = np.argwhere(np.isfinite(of_robot))[len(of_robot) // 2]
        there = {points_of(cloud)[tuple(pixel)][2] for cloud in clouds}
        self.assertGreater(len(there), nb_clouds // 2, "each image has noise of its own")

    def test_what_it_cannot_do_is_said(self):
        camera = roslib.packages.find_node("collision_pairs", "simulate_depth_camera")[0]
        rospy.set_param("/own/second/ball_from", [1.0, 2.0])
        rospy.delete_param("/robot_description")
        for ns, name, words in (("/own", "second", "ball_from has three coordinates"),
                                ("/nowhere", "lost", "there is no parameter robot_description")):
            ended = subprocess.run([camera, "__ns:=" + ns, "__name:=" + name], stdout=subprocess.PIPE,
                                   stderr=subprocess.STDOUT, text=True, timeout=PATIENCE)
            self.assertIn("cannot start: " + words, ended.stdout)
            self.assertEqual(ended.returncode, 1)


if __name__ == "__main__":
    rospy.init_node("depth_camera_test")
    rostest.rosrun("collision_pairs", "depth_camera_test", DepthCameraTest)
