#!/usr/bin/python3
"""The velocity limiter of a running node, in closed loop with simulated joints."""
import os
import subprocess
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import rostest
from std_msgs.msg import Float64, Float64MultiArray
from std_srvs.srv import Trigger
from visualization_msgs.msg import Marker, MarkerArray

from cloud_client import CloudPublisher
from collision_pairs.msg import SpeedLimit
from joint_simulator import JointSimulator
from node_client import PATIENCE, diagnosis_of

PERIOD = 0.02          # s between commands
STOP_DISTANCE = 0.01   # m, between the boxes, which are links of one robot


class Limited:
    """What comes out of a node's limiter."""

    def __init__(self, node, kind):
        self.commands, self.scales, self.limits = [], [], []
        self.when = []
        self.hand_on = None
        rospy.Subscriber(node + "/limited_command", kind, self._on_command)
        rospy.Subscriber(node + "/speed_scale", Float64, self.scales.append)
        rospy.Subscriber(node + "/speed_limit", SpeedLimit, self.limits.append)

    def _on_command(self, message):
        self.when.append(rospy.get_time())
        self.commands.append(message)
        if self.hand_on:
            self.hand_on(message)


class Driver:
    """Repeats a command until it is given another; None: silence."""

    def __init__(self, topic, kind):
        self.message = None
        self._publisher = rospy.Publisher(topic, kind, queue_size=1)
        self._timer = rospy.Timer(rospy.Duration(PERIOD), self._publish)

    def _publish(self, _):
        if self.message is not None:
            self._publisher.publish(self.message)


def wait_until(condition):
    end = rospy.get_time() + PATIENCE
    while rospy.get_time() < end:
        if condition():
            return True
        rospy.sleep(0.01)
    return False


def newest(messages, condition):
    """Whether the newest comes to meet the condition: topics keep no order among each other."""
    return wait_until(lambda: messages and condition(messages[-1]))


def level_of(status):
    return ord(status.level) if isinstance(status.level, bytes) else status.level


class LimiterTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.joints = JointSimulator(["slide_a", "slide_b", "slide_c"])
        cls.out = Limited("/array", Float64MultiArray)
        cls.out.hand_on = lambda m: cls.joints.command({"slide_a": m.data[0]} if m.data else {})
        cls.driver = Driver("/array_command", Float64MultiArray)

    def setUp(self):
        self.drive(None)
        self.joints.place(slide_a=0.0, slide_b=4.0, slide_c=8.0)

    def drive(self, *velocities):
        self.driver.message = None if velocities == (None,) else Float64MultiArray(data=velocities)

    def limit_that(self, condition):
        """The next limit that meets the condition."""
        start = len(self.out.limits)
        self.assertTrue(wait_until(lambda: any(condition(x) for x in self.out.limits[start:])),
                        self.out.limits[-1:])
        return next(x for x in self.out.limits[start:] if condition(x))

    def test_far_from_everything_the_whole_command_passes(self):
        self.drive(0.3)
        limit = self.limit_that(lambda x: x.scale == 1.0)
        self.assertEqual((limit.verdict, limit.reason, limit.first_link), (SpeedLimit.FREE, "", ""))
        self.assertTrue(newest(self.out.commands, lambda x: x.data == (0.3,)))
        self.assertTrue(newest(self.out.scales, lambda x: x.data == 1.0))

    def test_it_stops_before_what_is_ahead_names_the_pair_and_can_retreat(self):
        self.joints.place(slide_a=2.0)
        self.drive(1.0)
        limit = self.limit_that(lambda x: x.scale == 0.0 and x.first_link)
        self.assertEqual((limit.first_link, limit.second_link), ("a", "b"))
        self.assertIn("comes nearer", limit.reason)
        rospy.sleep(1.0)
        distance = 3.0 - self.joints.position("slide_a")
        self.assertGreater(distance, STOP_DISTANCE)
        self.assertLess(distance, 0.1)
        limit = self.limit_that(lambda x: x.first_link)
        self.assertAlmostEqual(limit.distance, distance, delta=0.02)
        self.drive(-1.0)
        self.limit_that(lambda x: x.scale > 0.0)
        self.limit_that(lambda x: x.scale == 1.0)
        self.assertLess(self.joints.position("slide_a"), 3.0 - distance)

    def test_who_watches_the_markers_sees_the_scale_and_the_pair(self):
        shown = []
        subscriber = rospy.Subscriber("/array/markers", MarkerArray, lambda array: shown.append(
            {marker.id: marker for marker in array.markers if marker.ns == "speed_limit"}))
        self.joints.place(slide_a=2.5)
        self.drive(1.0)
        self.assertTrue(wait_until(lambda: shown and shown[-1] and shown[-1][0].text == "speed 0 %\na | b"))
        rospy.sleep(0.5)
        first, second = next(marker.points for marker in shown[-1].values() if marker.type == Marker.LINE_LIST)
        self.assertAlmostEqual(second.x - first.x, 3.0 - self.joints.position("slide_a"), delta=1e-3)
        self.drive(None)
        begin = rospy.get_time()
        self.assertTrue(wait_until(lambda: not shown[-1]), "who sends no commands is not limited")
        self.assertGreater(rospy.get_time() - begin, 1.0, "a second after the zeros")
        subscriber.unregister()

    def test_what_a_latching_publisher_has_left_is_not_passed_before_it_publishes_again(self):
        # A node of its own: in this one, the driver's publisher is connected already.
        program = ("import rospy; from std_msgs.msg import Float64MultiArray; rospy.init_node('latching');"
                   "publisher = rospy.Publisher('/array_command', Float64MultiArray, queue_size=1, latch=True);"
                   "publisher.publish(data=[0.3]);"
                   "exec('while not publisher.get_num_connections(): rospy.sleep(0.01)'); print(flush=True);"
                   "input(); publisher.publish(data=[0.2]); input()")
        with subprocess.Popen([sys.executable, "-c", program], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                              text=True) as latching:
            self.assertEqual(latching.stdout.readline(), "\n", "it is connected")
            rospy.sleep(0.5)
            self.assertEqual(self.joints.position("slide_a"), 0.0)
            latching.stdin.write("\n")
            latching.stdin.flush()
            self.assertTrue(wait_until(lambda: self.joints.position("slide_a") > 0.0))
            latching.communicate("\n")

    def test_after_the_timeout_zeros_are_passed_once(self):
        self.drive(0.2)
        self.limit_that(lambda x: x.scale > 0.0)
        self.drive(None)
        self.limit_that(lambda x: "no command for" in x.reason)
        rospy.sleep(0.1)
        nb_commands = len(self.out.commands)
        self.assertTrue(newest(self.out.commands, lambda x: x.data == (0.0,)))
        rospy.sleep(0.5)
        self.assertEqual(len(self.out.commands), nb_commands)
        self.assertEqual(len(self.out.scales), nb_commands)

    def test_while_the_scene_is_read_again_it_goes_on(self):
        reset = rospy.ServiceProxy("/array/reset", Trigger)
        self.drive(0.05)
        self.limit_that(lambda x: x.scale == 1.0)
        for _ in range(3):
            self.assertTrue(reset().success)
            self.limit_that(lambda x: x.scale == 1.0)
        self.assertLess(self.joints.position("slide_a"), 2.0)

    def test_a_robot_that_moves_without_a_command_is_said_and_stopped_until_commands_have_rested(self):
        name = "watched: velocity limiter"
        out = Limited("/watched", Float64MultiArray)
        driver = Driver("/watched_command", Float64MultiArray)
        out.hand_on = lambda m: self.joints.command({"slide_a": m.data[0]})
        rospy.sleep(1.2)  # since it was placed
        driver.message = Float64MultiArray(data=[0.1])
        self.assertTrue(newest(out.limits, lambda x: x.scale == 1.0))
        self.joints.place(slide_a=0.3)  # something pushes it
        self.assertTrue(newest(out.limits, lambda x: "joint 'slide_a' is 0." in x.reason), out.limits[-1:])
        self.assertEqual((out.limits[-1].scale, out.limits[-1].verdict), (0.0, SpeedLimit.UNKNOWN))
        self.assertTrue(newest(out.commands, lambda x: x.data == (0.0,)))
        self.assertTrue(wait_until(lambda: "off what was passed" in diagnosis_of(name).message))
        self.assertEqual(level_of(diagnosis_of(name)), 2)
        start = len(out.commands)
        rospy.sleep(1.1)
        self.assertTrue(all(m.data == (0.0,) for m in out.commands[start:]), "who still commands has not noticed")
        driver.message = None
        rospy.sleep(1.2)
        driver.message = Float64MultiArray(data=[0.1])
        self.assertTrue(newest(out.limits, lambda x: x.scale == 1.0), out.limits[-1:])
        driver.message = out.hand_on = None
        self.joints.command({"slide_a": 0.0})

    def test_a_joint_that_is_not_the_robots_is_named_and_nothing_passes(self):
        out = Limited("/unknown_joint", Float64MultiArray)
        driver = Driver("/unknown_command", Float64MultiArray)
        driver.message = Float64MultiArray(data=[0.1])
        self.assertTrue(newest(out.limits, lambda x: "slide_x" in x.reason))
        self.assertTrue(newest(out.commands, lambda x: x.data == (0.0,)))
        self.assertTrue(wait_until(  # while the robot is loaded, it is said that nobody reports the joint
            lambda: "stopped: joint 'slide_x'" in diagnosis_of("unknown_joint: velocity limiter").message))
        self.assertEqual(level_of(diagnosis_of("unknown_joint: velocity limiter")), 1)
        driver.message = None

    def test_links_that_stop_every_command_are_named_in_the_diagnostics_with_the_remedy(self):
        name = "always_near: velocity limiter"
        self.assertTrue(wait_until(lambda: "lower and upper stop every command" in diagnosis_of(name).message))
        status = diagnosis_of(name)
        self.assertEqual(level_of(status), 1)
        self.assertIn("self_stop_distance", status.message)

    def test_diagnostics_name_the_topic_on_which_no_commands_come(self):
        self.assertTrue(wait_until(lambda: diagnosis_of("array: velocity limiter").message ==
                                   "no commands on /array_command"))
        self.drive(0.1)
        self.assertTrue(wait_until(lambda: diagnosis_of("array: velocity limiter").message == "commands are limited"))
        values = {pair.key: pair.value for pair in diagnosis_of("array: velocity limiter").values}
        self.assertTrue(0 < float(values["commands"]) < 100, "those since the last one")
        self.assertGreater(float(values["longest decision [s]"]), 0.0)
        self.assertIn(float(values["scale"]), [scale.data for scale in self.out.scales])  # diagnostics are a second old
        self.joints.place(slide_a=2.99)
        limit = self.limit_that(lambda x: x.scale == 0.0 and x.first_link)
        status = diagnosis_of("array: velocity limiter")
        self.assertEqual(status.message, "commands are limited", "a pair that is near is no fault")
        self.assertEqual({pair.key: pair.value for pair in status.values}["reason"], limit.reason)

    def test_without_a_robot_nothing_passes_and_who_watches_sees_it(self):
        shown = []
        subscriber = rospy.Subscriber("/no_robot/markers", MarkerArray, lambda array: shown.append(
            [marker.text for marker in array.markers if marker.ns == "speed_limit"]))
        out = Limited("/no_robot", Float64MultiArray)
        driver = Driver("/no_robot_command", Float64MultiArray)
        driver.message = Float64MultiArray(data=[0.1])
        self.assertTrue(newest(out.limits, lambda x: x.reason == "there is no robot yet"))
        self.assertTrue(newest(out.commands, lambda x: x.data == (0.0,)))
        self.assertTrue(wait_until(lambda: ["speed 0 %"] in shown))
        driver.message = None
        self.assertTrue(wait_until(lambda: shown[-1] == []))
        subscriber.unregister()

    def test_a_cloud_stops_it_while_it_is_unknown_and_where_it_is_near(self):
        """What is seen of it may have come nearer since then, at 0.1 m/s."""
        out = Limited("/with_cloud", Float64MultiArray)
        driver = Driver("/cloud_command", Float64MultiArray)
        driver.message = Float64MultiArray(data=[0.1])
        self.assertTrue(newest(out.limits, lambda x: "none has arrived yet" in x.reason))
        camera = CloudPublisher("/points", "root")
        camera.heal([(-3.0, 0.0, 0.0)], "root")
        self.assertTrue(newest(out.limits, lambda x: x.scale == 1.0))
        camera.points = [(0.57, 0.0, 0.0)]  # 5 cm before a
        self.assertTrue(newest(out.limits, lambda x: x.first_link == "a"))
        self.assertEqual(out.limits[-1].second_link, "points")
        camera.silent = True
        rospy.sleep(0.4)

        def told():
            """When, and how far an object must be."""
            start = len(out.limits)
            self.assertTrue(wait_until(lambda: any(" m to an object" in x.reason for x in out.limits[start:])))
            limit = next(x for x in out.limits[start:] if " m to an object" in x.reason)
            return limit.stamp.to_sec(), float(limit.reason.split(", or than ")[1].split(" m")[0])
        first, before = told()
        rospy.sleep(1.0)
        then, after = told()
        self.assertAlmostEqual((after - before) / (then - first), 0.1, delta=0.03)
        driver.message = None
        camera.stop()

    def test_a_misspelt_key_is_an_error_of_the_diagnostics_and_nothing_passes(self):
        status = diagnosis_of("misspelt: velocity limiter")
        self.assertEqual(level_of(status), 2)
        self.assertIn("'decceleration' is not a setting of the limiter; did you mean 'deceleration'?",
                      status.message)
        names = [name for name, _ in rospy.get_published_topics()]
        self.assertNotIn("/misspelt/limited_command", names)


if __name__ == "__main__":
    rospy.init_node("test_limiter")
    rostest.rosrun("collision_pairs", "limiter", LimiterTest)
