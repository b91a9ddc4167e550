#!/usr/bin/python3
"""Slows a trajectory controller of a UR by the limiter's scale (docs/limiter.md).

The controller's state gives the velocities that its trajectory wants; the limiter's scale moves the speed slider.
Usage: relay_speed_scale.py [_controller:=/scaled_pos_joint_traj_controller] [_limiter:=/collision_pairs_node]
"""
import rospy
from control_msgs.msg import JointTrajectoryControllerState
from std_msgs.msg import Float64, Float64MultiArray
from ur_msgs.srv import SetSpeedSliderFraction

rospy.init_node("relay_speed_scale")
command = rospy.Publisher("trajectory_velocities", Float64MultiArray, queue_size=1)  # velocity_limiter: command
slider = rospy.ServiceProxy("/ur_hardware_interface/set_speed_slider", SetSpeedSliderFraction)
rospy.Subscriber(rospy.get_param("~controller", "/scaled_pos_joint_traj_controller") + "/state", JointTrajectoryControllerState,
                 lambda state: command.publish(Float64MultiArray(data=state.desired.velocities)))
while not rospy.is_shutdown():
    try:
        scale = rospy.wait_for_message(rospy.get_param("~limiter", "/collision_pairs_node") + "/speed_scale", Float64, timeout=0.2).data
    except rospy.ROSException:  # silence
        scale = 0.0
    slider(scale)
