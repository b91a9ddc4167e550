#!/usr/bin/python3
"""Slows a trajectory controller of a UR by the limiter's scale (docs/limiter.md).

The controller's state gives the velocities that its trajectory wants, with the names of the joints: the limiter's command, of
type trajectory_msgs/JointTrajectory. Its scale moves the speed slider. ur_robot_driver refuses a slider below LEAST (its issue
737), so there, without a scale for TIMEOUT, and when this program ends, the robot's program is paused.

Usage: relay_speed_scale.py [_controller:=/scaled_pos_joint_traj_controller] [_limiter:=/collision_pairs_node]
"""
import signal
import threading
import time

import rospy
from control_msgs.msg import JointTrajectoryControllerState
from std_msgs.msg import Float64
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint
from ur_msgs.srv import SetSpeedSliderFraction

LEAST, TIMEOUT, RATE = 0.01, 0.2, 100  # fraction, s, Hz
DRIVER = "/ur_hardware_interface/"

rospy.init_node("relay_speed_scale", disable_signals=True)
slider = rospy.ServiceProxy(DRIVER + "set_speed_slider", SetSpeedSliderFraction)
pause, play = (rospy.ServiceProxy(DRIVER + "dashboard/" + name, Trigger) for name in ("pause", "play"))
newest = {"scale": 0.0, "at": -TIMEOUT}  # of the steady clock: a /clock that stands makes no scale fresh
command = rospy.Publisher("trajectory_velocities", JointTrajectory, queue_size=1)
rospy.Subscriber(rospy.get_param("~controller", "/scaled_pos_joint_traj_controller") + "/state", JointTrajectoryControllerState,
                 lambda state: command.publish(JointTrajectory(joint_names=state.joint_names, points=[
                     JointTrajectoryPoint(velocities=state.desired.velocities)])), queue_size=1, tcp_nodelay=True)
rospy.Subscriber(rospy.get_param("~limiter", "/collision_pairs_node") + "/speed_scale", Float64,
                 lambda scale: newest.update(scale=scale.data, at=time.monotonic()), queue_size=1, tcp_nodelay=True)
# Whatever asks it to end is only noted, so that nothing plays the program again after the last pause.
asked, paused = threading.Event(), threading.Event()
for number in (signal.SIGINT, signal.SIGTERM):
    signal.signal(number, lambda *_: asked.set())
rospy.on_shutdown(lambda: asked.set() or paused.wait(2.0))  # while services can still be called
is_paused = False
while not asked.is_set():
    scale = newest["scale"] if time.monotonic() - newest["at"] < TIMEOUT else 0.0
    try:
        done = slider(max(scale, LEAST)).success
        if done and is_paused != (scale < LEAST):
            done = (play if is_paused else pause)().success
            is_paused ^= done
        if not done:
            rospy.logerr_throttle(1.0, "the driver refuses scale %g" % scale)
    except (rospy.ServiceException, rospy.ROSInterruptException) as error:
        rospy.logerr_throttle(1.0, str(error))
    asked.wait(1.0 / RATE)  # of wall time: a clock that stands still does not keep it from ending
pause()
paused.set()
