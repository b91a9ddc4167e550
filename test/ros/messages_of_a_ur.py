"""Modules of the messages by which a UR is driven, which Debian does not have, for PYTHONPATH."""
import os

import rospkg
from genpy.generator import MsgGenerator, SrvGenerator

STATE = """Header header
string[] joint_names
trajectory_msgs/JointTrajectoryPoint desired
trajectory_msgs/JointTrajectoryPoint actual
trajectory_msgs/JointTrajectoryPoint error
"""
SLIDER = """float64 speed_slider_fraction
---
bool success
"""


def write_modules(folder):
    for package, kind, name, text, generator in (
            ("control_msgs", "msg", "JointTrajectoryControllerState", STATE, MsgGenerator()),
            ("ur_msgs", "srv", "SetSpeedSliderFraction", SLIDER, SrvGenerator())):
        modules = os.path.join(folder, package, kind)
        os.makedirs(modules)
        definition = os.path.join(modules, "%s.%s" % (name, kind))
        with open(definition, "w") as out:
            out.write(text)
        packages = rospkg.RosPack()
        known = {used: [os.path.join(packages.get_path(used), "msg")] for used in ("std_msgs", "trajectory_msgs")}
        assert generator.generate_messages(package, [definition], modules, known) == 0
        with open(os.path.join(modules, "__init__.py"), "w") as out:
            out.write("from ._%s import *\n" % name)
        open(os.path.join(folder, package, "__init__.py"), "w").close()
