#!/usr/bin/python3
"""drive_steps keeps within limits, ends with zeros whatever happens, and makes a recording of which measure_stopping knows the robot."""
import os
import signal
import subprocess
import sys
import tempfile
import threading
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import roslib.packages
import rosbag
import rosnode
import rospy
import rostest
import yaml
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray

from joint_simulator import ACCELERATION, DEAD_TIME, PERIOD, JointSimulator
from node_client import PATIENCE
from program import Program, wait_until

DRIVE, MEASURE = (roslib.packages.find_node("collision_pairs", name)[0] for name in ("drive_steps", "measure_stopping"))
JOINTS = ["slide_a", "slide_b"]


class DriveSteps(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.simulator = JointSimulator(JOINTS)
        cls.commands, cls.bag, cls.lock, cls.furthest = [], None, threading.Lock(), 0.0
        rospy.Subscriber("/command", Float64MultiArray, cls.on_command, tcp_nodelay=True)
        rospy.Subscriber("/joint_states", JointState, cls.on_state, tcp_nodelay=True)

    @classmethod
    def on_command(cls, message):
        with cls.lock:
            cls.commands.append(list(message.data))
            if cls.bag:
                cls.bag.write("/command", message, rospy.Time.now())
        cls.simulator.command(dict(zip(JOINTS, message.data)))

    @classmethod
    def on_state(cls, message):
        with cls.lock:
            cls.furthest = max([cls.furthest] + [abs(p) for p in message.position[:2]])
            if cls.bag:
                cls.bag.write("/joint_states", message, rospy.Time.now())

    def setUp(self):
        self.simulator.is_silent = self.simulator.is_uneven = False
        self.simulator.place(slide_a=0.0, slide_b=0.0)
        del self.commands[:]

    def drive(self, *parameters):
        """Where nothing else is said: of both joints."""
        if rospy.has_param("/drive_steps"):
            rospy.delete_param("/drive_steps")  # of the last one
        given = {word.split(":=")[0] for word in parameters}
        joints = [] if "_joints" in given else ["_joints:=[slide_a, slide_b]"]
        return Program(DRIVE, *joints, *parameters)

    def wait_until_it_moves(self, program):
        wait_until(lambda: self.moves() or program.process.poll() is not None, "it moves")
        self.assertTrue(self.moves(), program.said())

    def moves(self):
        return bool(self.commands) and any(self.commands[-1])

    def assert_ends_with_zeros(self, program, code):
        self.assertEqual(program.process.wait(PATIENCE), code, program.said())
        wait_until(lambda: not self.moves(), "zeros")
        rospy.sleep(0.2)
        self.assertFalse(self.moves())

    def test_a_recording_of_its_steps_gives_the_robot_s_parameters(self):
        self.simulator.place(slide_a=8.78)  # it has to begin towards the other side
        with tempfile.TemporaryDirectory() as folder:
            path, out = os.path.join(folder, "steps.bag"), os.path.join(folder, "limiter.yaml")
            with self.lock:
                type(self).bag, type(self).furthest = rosbag.Bag(path, "w"), 0.0
            program = self.drive("_velocity:=0.3", "_hold:=0.4")
            self.assert_ends_with_zeros(program, 0)
            with self.lock:
                self.bag.close()
                type(self).bag = None
            for number in range(2):
                self.assertEqual({round(command[number], 6) for command in self.commands}, {0.3, 0.0, -0.3, 0.15, -0.15})
            self.assertTrue(all(not all(command) for command in self.commands), "one at a time")
            self.assertLess(self.furthest, 9.0, "its limit")
            subprocess.run([MEASURE, path, "--out", out, "--joints"] + JOINTS, check=True)
            with open(out) as file:
                found = yaml.safe_load(file)["velocity_limiter"]
            print(found, flush=True)
            self.assertGreaterEqual(found["reaction_time"], DEAD_TIME - PERIOD)  # the simulator moves once a period
            for name in JOINTS:
                self.assertLessEqual(found["deceleration"][name], ACCELERATION)

    def test_interrupted_or_ended_it_sends_zeros(self):
        for number in 5 * (signal.SIGINT, signal.SIGTERM):
            program = self.drive("_rate:=10000")  # so that most signals come while it publishes
            self.wait_until_it_moves(program)
            program.process.send_signal(number)
            self.assert_ends_with_zeros(program, 1)
            self.assertIn("interrupted", program.said())
        program = self.drive()
        self.wait_until_it_moves(program)
        rosnode.kill_nodes(["/drive_steps"])
        self.assert_ends_with_zeros(program, 1)

    def test_without_positions_it_sends_zeros(self):
        for fault in ("is_silent", "is_uneven"):
            self.setUp()
            program = self.drive()
            self.wait_until_it_moves(program)
            setattr(self.simulator, fault, True)
            self.assert_ends_with_zeros(program, 1)
            self.assertIn("no position of joint 'slide_a' in the last 0.5 s", program.said())

    def test_what_would_pass_a_limit_is_refused_before_anything_moves(self):
        self.simulator.place(slide_a=8.99)
        refused = []
        for parameters, says in ((("_velocity:=0.5",), "at 8.990 needs 1.050 on one side and 0.300 on the other"), (("_velocity:=1.1",), "faster than its limit"),
                                 (("_joints:=[slide_a, slid_b]",), "the URDF has no joint slid_b"),
                                 (("_hold:=0.3",), "hold must be at least 0.4 s")):
            refused.append((self.drive(*parameters, "__name:=refused_%d" % len(refused)), says))
        for program, says in refused:
            self.assert_ends_with_zeros(program, 1)
            self.assertIn(says, program.said())
            self.assertFalse([command for command in self.commands if any(command)])


if __name__ == "__main__":
    rospy.init_node("drive_steps_test")
    rostest.rosrun("collision_pairs", "drive_steps_test", DriveSteps)
