#!/usr/bin/python3
"""The node as a nodelet answers as the node does, ends when it is unloaded, and does not end its manager."""
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rosgraph
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from node_client import PATIENCE, NodeClient
from nodelet.srv import NodeletLoad, NodeletUnload
from tf2_msgs.msg import TFMessage
from transform_faults import APART, TOUCHING, box_at

from collision_pairs.msg import CollisionPairs

TYPE = "collision_pairs/CollisionPairsNodelet"


def call(service, kind, *arguments, manager="/manager"):
    rospy.wait_for_service(manager + "/" + service, PATIENCE)
    return rospy.ServiceProxy(manager + "/" + service, kind)(*arguments).success


def load(name, manager="/manager"):
    if not call("load_nodelet", NodeletLoad, name, TYPE, ["/tf"], ["/cell/tf"], [], "", manager=manager):
        raise RuntimeError("the manager did not load " + name)
    return NodeClient(name)


def unload(name):
    return call("unload_nodelet", NodeletUnload, name)


def has_scene_and_poses(report):
    """Until it is true a report is UNKNOWN, and of now: later than poses that are on their way."""
    return report.alarm_distance > 0.0 and not report.left_out


def topics_of(name):
    publishers = rosgraph.Master("/test_nodelet").getSystemState()[0]
    return [topic for topic, _ in publishers if topic.startswith(name + "/")]


def diagnosed(count):
    """The names under which so many collision checks of nodelets are diagnosed."""
    names = set()
    subscriber = rospy.Subscriber("/diagnostics", DiagnosticArray, lambda array: names.update(
        status.name for status in array.status if status.name.startswith("cell/") and status.name.endswith("collision check")))
    end = rospy.get_time() + PATIENCE
    while rospy.get_time() < end and len(names) < count:
        rospy.sleep(0.1)
    subscriber.unregister()
    return names


class NodeletTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.publisher = rospy.Publisher("/cell/tf", TFMessage, queue_size=100)

    def publish(self, places):
        while not self.publisher.get_num_connections():  # all nodelets of a process share one
            rospy.sleep(0.05)
        message = TFMessage([box_at(name, x) for name, x in sorted(places.items())])
        for transform in message.transforms:
            transform.header.stamp = message.transforms[0].header.stamp
        self.publisher.publish(message)
        return message.transforms[0].header.stamp - rospy.Duration(1e-6)

    def test_its_reports_follow_transforms_of_a_remapped_topic_and_its_service_answers(self):
        node = load("/cell/checks")
        for places, in_contact in ((APART, False), (TOUCHING, True), (APART, False)):
            report = node.report_since(self.publish(places), has_scene_and_poses)
            self.assertEqual((report.in_collision, report.verdict),
                             (in_contact, report.COLLISION if in_contact else report.FREE))
            self.assertEqual(node.check().result.in_collision, in_contact)
        self.assertTrue(unload("/cell/checks"))

    def test_unloading_ends_its_topics_and_its_limiter_and_it_can_be_loaded_again(self):
        rospy.set_param("/cell/again/velocity_limiter",
                        {"command": "/cell/command", "joints": ["slide_a"], "deceleration": 2.0})
        for _ in range(3):
            load("/cell/again")
            for topic in ("collision_pairs", "limited_command", "speed_scale"):
                self.assertIn("/cell/again/" + topic, topics_of("/cell/again"))
            self.assertTrue(unload("/cell/again"))
            self.assertEqual(topics_of("/cell/again"), [])

    def test_with_its_argument_it_is_not_loaded_where_its_launch_files_parameters_are_missing(self):
        def load_with_argument():
            return call("load_nodelet", NodeletLoad, "/cell/configured", TYPE, ["/tf"], ["/cell/tf"], ["--configured"], "")
        self.assertRaises(rospy.ServiceException, load_with_argument)
        self.assertEqual(topics_of("/cell/configured"), [])
        rospy.set_param("/cell/configured/configured", True)
        self.assertTrue(load_with_argument())
        self.assertTrue(unload("/cell/configured"))

    def test_two_in_a_manager_have_their_own_settings_and_one_outlives_the_other(self):
        names = ["/cell/first", "/cell/second"]
        for name, distance in zip(names, (0.125, 4.0)):
            rospy.set_param(name + "/alarm_distance", distance)
        first, second = [load(name) for name in names]
        stamp = self.publish(APART)
        for node, distance in ((first, 0.125), (second, 4.0)):
            report = node.report_since(stamp, has_scene_and_poses)
            self.assertEqual(report.alarm_distance, distance)
        self.assertEqual(diagnosed(2), {name[1:] + ": collision check" for name in names})
        self.assertTrue(unload(names[0]))
        stamp = self.publish(TOUCHING)
        self.assertEqual(second.report_since(stamp, has_scene_and_poses).verdict, CollisionPairs.COLLISION)
        self.assertEqual(topics_of(names[0]), [])
        self.assertTrue(unload(names[1]))


if __name__ == "__main__":
    rospy.init_node("test_nodelet")
    rostest.rosrun("collision_pairs", "nodelet", NodeletTest)
