#!/usr/bin/python3
"""What is shown of point clouds: every number of their diagnostics, and their voxels in rviz."""
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from dynamic_reconfigure.client import Client
from sensor_msgs.msg import PointCloud2
from std_srvs.srv import Trigger
from visualization_msgs.msg import Marker, MarkerArray

from cloud_client import CloudPublisher, cloud_diagnosis, cloud_of, other_clouds
from node_client import PATIENCE, NodeClient
from program import wait_until
from scene_client import SceneClient, add_box, clear
from transform_faults import APART, BoxPublisher

CLOUD = "camera/points"
BASE = (0.30, 0.55, 0.75)  # the colour of a voxel that nothing is near to


class CloudHealthTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.boxes = BoxPublisher(["a", "b", "c", "camera"])
        cls.boxes.x = dict(APART, a=-0.09, camera=0.0)  # a ends at x = 0.41
        cls.boxes.heal()
        cls.node = NodeClient("/node")
        cls.camera = CloudPublisher("/" + CLOUD, "camera", rate=40.0)
        cls.camera.silent = True
        cls.filtered = []
        rospy.Subscriber("/node/filtered_cloud", PointCloud2, cls.filtered.append)
        cls.clear = rospy.ServiceProxy("/node/clear_clouds", Trigger)

    @classmethod
    def tearDownClass(cls):
        cls.camera.stop()
        cls.boxes.stop()

    def numbers(self, condition=lambda numbers: True):
        """Of the next diagnosis for which they are so."""
        def of(values):
            return {key[len(CLOUD) + 1:]: float(value) for key, value in values.items()
                    if key.startswith(CLOUD) and not key.endswith("problem")}
        found = cloud_diagnosis(lambda values: "used" in of(values) and condition(of(values)))
        self.assertIsNotNone(found)
        return of(found)

    def test_every_number_of_the_diagnostics(self):
        before = self.numbers()
        del self.filtered[:]
        on_a = [(0.0, 0.5, 0.0), (0.1, 0.5, 0.0)]
        for i, points in enumerate((on_a + [(0.05, 5.0, 0.05), (0.06, 5.0, 0.05), (9.05, 5.0, 0.05)],) * 3):
            self.camera.send(cloud_of(points, "camera", rospy.Time.now() - rospy.Duration(0.2)))
            wait_until(lambda: len(self.filtered) > i, "its use")
        for _ in range(2):
            self.camera.send(cloud_of([], "camera", rospy.Time(0)))
            rospy.sleep(0.1)
        now = self.numbers(lambda now: now["refused"] == before["refused"] + 2)
        self.assertEqual({key: now[key] - before[key] for key in ("received", "used", "refused", "dropped")},
                         {"received": 5, "used": 3, "refused": 2, "dropped": 0})
        self.assertEqual((now["points"], now["points kept"], now["voxels"]), (5, 3, 2))
        self.assertGreater(now["latency [s]"], 0.2)
        self.assertLess(now["latency [s]"], 1.0)
        self.assertGreater(now["processing [s]"], 0.0)
        self.assertLess(now["processing [s]"], 1.0)

        # One that waits for its transforms; of those that come meanwhile the newest is kept.
        ahead = rospy.Time.now() + rospy.Duration(0.4)
        for seconds in (0.0, 0.001, 0.002):
            self.camera.send(cloud_of([(0.0, 5.0, 0.0)], "camera", ahead + rospy.Duration(seconds)))
            rospy.sleep(0.05)
        later = self.numbers(lambda later: later["used"] == now["used"] + 2)
        self.assertEqual((later["received"] - now["received"], later["dropped"] - now["dropped"]), (3, 1))

        self.camera.heal([(0.0, 5.0, 0.0)], "camera")
        rate = self.numbers(lambda now: now["used"] > later["used"] + 60)["rate [Hz]"]  # 40 on an idle machine
        self.assertTrue(8.0 < rate < 80.0, rate)
        self.camera.silent = True
        rospy.sleep(0.3)  # until the last has been used
        before = self.numbers()
        # After so long a pause a single cloud takes a tenth off the mean.
        self.camera.send(cloud_of([(0.0, 5.0, 0.0)], "camera"))
        begin = rospy.get_time()
        now = self.numbers(lambda now: now["used"] == before["used"] + 1)
        self.assertAlmostEqual(now["rate [Hz]"] / before["rate [Hz]"], 0.9, delta=0.04)
        self.numbers(lambda now: now["rate [Hz]"] == 0.0)
        self.assertGreater(rospy.get_time() - begin, 2.8)

    def test_a_cloud_whose_transforms_do_not_come_is_refused_after_a_second(self):
        before = self.numbers()
        reports = self.node.reports
        self.boxes.fault = {"b": "silent"}
        try:
            rospy.sleep(0.2)
            self.camera.send(cloud_of([(0.0, 5.0, 0.0)], "camera"))
            begin = rospy.get_time()
            words = "TF has no poses of the sensor ('camera') and the robot at its stamp"
            self.assertIsNotNone(self.node.next(reports, lambda report: words in " ".join(report.unknown_because)))
            self.assertGreater(rospy.get_time() - begin, 0.9)
        finally:
            self.boxes.heal()
        self.numbers(lambda now: now["refused"] > before["refused"] and now["used"] == before["used"])

    def test_without_a_time_out_old_clouds_are_used(self):
        with other_clouds("/node") as (given, use):
            self.assertTrue(use(dict(given, source_timeout=0)).success)
            self.camera.send(cloud_of([(0.0, 5.0, 0.0)], "camera", rospy.Time.now() - rospy.Duration(2.0)))
            self.assertIsNotNone(self.node.next(self.node.reports, lambda report: report.verdict == report.FREE))

    def test_a_topic_that_the_node_knows_by_another_type_is_said_and_ends_nothing(self):
        with other_clouds("/node") as (given, use):
            self.assertTrue(use(dict(given, topic="/tf")).success)
            words = "its topic cannot be subscribed to"
            report = self.node.next(self.node.reports, lambda report: words in " ".join(report.unknown_because))
            self.assertEqual(report.verdict, report.UNKNOWN)

    def shown(self, condition):
        """{x of a voxel: its colour} in the next marker of the cloud that meets the condition."""
        begin = len(self.markers)
        end = rospy.get_time() + PATIENCE
        while rospy.get_time() < end:
            for marker in self.markers[begin:]:
                colours = {round(p.x, 6): tuple(round(part, 2) for part in (c.r, c.g, c.b))
                           for p, c in zip(marker.points, marker.colors)}
                if condition(marker, colours):
                    return colours
            rospy.sleep(0.01)
        self.fail("no such marker")

    def test_voxels_are_drawn_in_red_where_a_link_comes_near_and_removed_with_their_cloud(self):
        self.markers = []
        subscriber = rospy.Subscriber("/node/scene_markers", MarkerArray,
                                      lambda array: self.markers.extend(m for m in array.markers if m.ns == "cloud " + CLOUD))
        client = Client("/node", timeout=20)
        try:
            self.clear()
            self.shown(lambda marker, _: marker.action == Marker.DELETE and marker.header.frame_id == "root")
            # 0.09, 0.19 and 0.29 m from a
            self.camera.heal([(x, 0.05, 0.05) for x in (0.55, 0.65, 0.75)], "camera")
            three = {0.55, 0.65, 0.75}
            colours = self.shown(lambda marker, colours: marker.action == Marker.ADD and set(colours) == three)
            self.assertGreater(colours[0.55][0], 0.85)
            self.assertEqual((colours[0.65], colours[0.75]), (BASE, BASE))
            begin, count = rospy.get_time(), len(self.markers)
            rospy.sleep(1.0)
            rate = (len(self.markers) - count) / (rospy.get_time() - begin)
            self.assertLess(rate, 7.0)
            client.update_configuration({"alarm_distance": 0.2})
            self.shown(lambda _, colours: colours.get(0.65, BASE)[0] > 0.85 and colours.get(0.75) == BASE)
        finally:
            client.update_configuration({"alarm_distance": 0.05})
            self.camera.silent = True
            subscriber.unregister()

    def test_voxels_do_not_follow_so_close_on_the_scene_that_a_queue_of_one_would_drop_it(self):
        arrays = []  # (when, whether it is the scene)
        subscriber = rospy.Subscriber("/node/scene_markers", MarkerArray, lambda array: arrays.append(
            (rospy.get_time(), any(marker.ns == "links" for marker in array.markers))))

        def gaps():
            return [after - when for (when, is_scene), (after, _) in zip(arrays, arrays[1:]) if is_scene]
        scene = SceneClient("/node")
        for i in range(8):
            nb_gaps = len(gaps())
            scene.apply(add_box("crate", (0, 0, 20 + i)))  # which is shown
            wait_until(lambda: len(gaps()) > nb_gaps, "voxels")
        scene.apply(clear())
        subscriber.unregister()
        self.assertGreater(sorted(gaps())[1], 0.15)  # one may have waited on a busy machine

    def test_a_node_without_clouds_says_nothing_of_them(self):
        names = set()
        subscriber = rospy.Subscriber("/diagnostics", DiagnosticArray, lambda array: names.update(s.name for s in array.status))
        self.assertIsNotNone(cloud_diagnosis(lambda _: True))
        self.assertEqual(names, {"node: collision check", "node: point clouds"})
        with other_clouds("/node") as (_, use):
            self.assertTrue(use().success)
            end = rospy.get_time() + PATIENCE
            names.add("node: point clouds")
            while rospy.get_time() < end and "node: point clouds" in names:
                names.clear()
                rospy.sleep(1.5)
            self.assertEqual(names, {"node: collision check"})
            self.assertEqual((self.clear().success, self.clear().message), (False, "there are no clouds"))
        subscriber.unregister()
        self.assertIsNotNone(cloud_diagnosis(lambda _: True))
        self.assertTrue(self.clear().success)
        self.assertIn("UNKNOWN until a new cloud has arrived", self.clear().message)


if __name__ == "__main__":
    rospy.init_node("test_cloud_health")
    rostest.rosrun("collision_pairs", "cloud_health", CloudHealthTest)
