#!/usr/bin/python3
"""The image of the simulated camera: rows and columns, and the ball where it was put."""
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import numpy as np
import rospy
import rostest
import tf2_ros
from sensor_msgs import point_cloud2
from sensor_msgs.msg import PointCloud2

from node_client import JointPublisher

BALL, RADIUS = np.array([0.42, -0.5, 1.45]), 0.09  # metres, in the world
NOISE = 0.003
JOINTS = ["shoulder_pan", "shoulder_lift", "upper_arm_roll", "elbow_flex", "forearm_roll", "wrist_flex", "wrist_roll",
          "gripper"]


class DepthCameraTest(unittest.TestCase):
    def test_it_shows_the_ball_where_it_is_row_by_row(self):
        JointPublisher(JOINTS).hold([0.0] * len(JOINTS))
        cloud = rospy.wait_for_message("points", PointCloud2, 30)
        self.assertEqual((cloud.height, cloud.width), (240, 320))
        self.assertEqual(cloud.row_step, cloud.width * cloud.point_step)
        self.assertFalse(cloud.is_dense)
        points = np.array(list(point_cloud2.read_points(cloud, ("x", "y", "z")))).reshape(240, 320, 3)
        # Along a row a pixel's ray turns to the right, along a column down.
        rays = points[:, :, :2] / points[:, :, 2:]
        seen = np.isfinite(rays[:, :, 0])
        for axis in (0, 1):
            along = np.nanmean(rays[:, :, axis], axis=axis)
            steps = np.diff(along[np.isfinite(along)])
            self.assertTrue((steps > 0).all())
        self.assertTrue(seen.any() and not seen.all())

        buffer = tf2_ros.Buffer()
        listener = tf2_ros.TransformListener(buffer)
        pose = buffer.lookup_transform("world", cloud.header.frame_id, rospy.Time(0), rospy.Duration(10)).transform
        listener.unregister()
        p, q = pose.translation, pose.rotation
        axis, turned = np.array([q.x, q.y, q.z]), points[seen]
        turned = turned + 2 * np.cross(axis, np.cross(axis, turned) + q.w * turned)
        from_ball = np.linalg.norm(turned + [p.x, p.y, p.z] - BALL, axis=1)
        of_ball = from_ball[from_ball < 2 * RADIUS]
        self.assertGreater(len(of_ball), 100)
        self.assertLess(np.abs(of_ball - RADIUS).max(), 6 * NOISE)


if __name__ == "__main__":
    rospy.init_node("depth_camera_test")
    rostest.rosrun("collision_pairs", "depth_camera_test", DepthCameraTest)
