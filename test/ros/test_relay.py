#!/usr/bin/python3
"""examples/relay_speed_scale.py between a running limiter and a robot with a trajectory controller, a slider and a pause."""
import os
import signal
import subprocess
import sys
import tempfile
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)

import rosnode
import rospy
import rostest
from std_srvs.srv import Trigger, TriggerResponse

from joint_simulator import JointSimulator
from messages_of_a_ur import write_modules
from node_client import PATIENCE

RELAY = os.path.join(HERE, "../../examples/relay_speed_scale.py")
PERIOD = 0.02  # s, of the controller's state
STOP_DISTANCE = 0.01  # m, the default


class Robot:
    """Follows its trajectory, a velocity, at the slider's fraction; refuses fractions as ur_robot_driver does."""

    def __init__(self):
        from control_msgs.msg import JointTrajectoryControllerState
        from ur_msgs.srv import SetSpeedSliderFraction, SetSpeedSliderFractionResponse
        self.joints = JointSimulator(["slide_a", "slide_b", "slide_c"])
        self.joints.place(slide_a=1.5, slide_b=4.0, slide_c=8.0)
        self.velocity, self.slider, self.is_paused, self.is_silent = 0.0, 1.0, False, False
        self._state, self._answer = JointTrajectoryControllerState, SetSpeedSliderFractionResponse
        self._publisher = rospy.Publisher("/scaled_pos_joint_traj_controller/state", self._state, queue_size=1)
        driver = "/ur_hardware_interface/"
        rospy.Service(driver + "set_speed_slider", SetSpeedSliderFraction, self._set_slider)
        rospy.Service(driver + "dashboard/pause", Trigger, lambda _: self._set_paused(True))
        rospy.Service(driver + "dashboard/play", Trigger, lambda _: self._set_paused(False))
        rospy.Timer(rospy.Duration(PERIOD), self._step)

    def position(self):
        return self.joints.position("slide_a")

    def _set_slider(self, request):
        is_possible = 0.01 <= request.speed_slider_fraction <= 1.0
        if is_possible:
            self.slider = request.speed_slider_fraction
        return self._answer(success=is_possible)

    def _set_paused(self, is_paused):
        self.is_paused = is_paused
        return TriggerResponse(success=True)

    def _step(self, _):
        state = self._state(joint_names=["slide_a"])
        state.desired.velocities = [self.velocity]
        if not self.is_silent:
            self._publisher.publish(state)
        self.joints.command({"slide_a": 0.0 if self.is_paused else self.slider * self.velocity})


class RelayTest(unittest.TestCase):
    def until(self, condition):
        end = rospy.get_time() + PATIENCE
        while rospy.get_time() < end and not condition():
            rospy.sleep(0.01)
        self.assertTrue(condition(), vars(self.robot))

    def test_a_trajectory_is_slowed_stopped_and_may_lead_back(self):
        with tempfile.TemporaryDirectory() as modules:
            write_modules(modules)
            sys.path.insert(0, modules)
            self.robot = robot = Robot()
            relays = []

            def start():
                relays.append(subprocess.Popen([sys.executable, RELAY],
                                               env=dict(os.environ, PYTHONPATH=modules + ":" + os.environ["PYTHONPATH"])))

            start()
            try:
                self.until(lambda: robot.is_paused)  # nobody limits it yet
                robot.velocity = 0.4
                self.until(lambda: robot.slider == 1.0 and not robot.is_paused and robot.position() > 1.6)
                self.until(lambda: robot.is_paused)  # box b is ahead
                for _ in range(40):
                    rospy.sleep(0.03)
                    self.assertTrue(2.5 < robot.position() < 3.0 - STOP_DISTANCE, robot.position())
                robot.velocity = -0.4
                self.until(lambda: not robot.is_paused and robot.position() < 2.4 and robot.slider == 1.0)
                robot.is_silent = True
                self.until(lambda: robot.is_paused)
                robot.is_silent = False
                self.until(lambda: not robot.is_paused)
                for end in (signal.SIGINT, signal.SIGTERM, "rosnode kill"):
                    robot.velocity = 0.4 if robot.position() < 2.0 else -0.4
                    self.until(lambda: not robot.is_paused)
                    if end == "rosnode kill":
                        rosnode.kill_nodes(["/relay_speed_scale"])
                    else:
                        relays[-1].send_signal(end)
                    relays[-1].wait(PATIENCE)
                    self.assertTrue(robot.is_paused, end)
                    start()
                self.until(lambda: not robot.is_paused)
                rosnode.kill_nodes(["/collision_pairs_node"])
                self.until(lambda: robot.is_paused)
            finally:
                for relay in relays:
                    relay.kill()
                    relay.wait()


if __name__ == "__main__":
    rospy.init_node("test_relay")
    rostest.rosrun("collision_pairs", "relay", RelayTest)
