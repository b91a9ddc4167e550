#!/usr/bin/python3
"""rviz, on a screen of its own, shows our configuration without a complaint: topics, frames, robot."""
import os
import shutil
import sys
import time
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from screen import Screen
from skipping_runner import run_or_skip

try:
    from python_qt_binding.QtWidgets import QApplication
    from rviz import bindings as rviz
except ImportError:  # Debian 13: python3-rviz 1.14.25 cannot be loaded, "sip.simplewrapper is not a registered type"
    rviz = None

CONFIG = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../config/collision_pairs.rviz")
PATIENCE = 150.0  # s
ALL_WELL = {"Global Status": "Ok", "Grid": "Ok", "Robot": "Ok", "Collision pairs": "Ok", "Scene": "Ok"}
MUST_BE_SHOWN = {"Robot": "forearm", "Collision pairs": "investigated_boxes", "Scene": "links"}


def all_properties(display):
    """Every line below a display in rviz's tree, as (name, value)."""
    for i in range(display.numChildren()):
        child = display.childAt(i)
        yield child.getName(), str(child.getValue())
        yield from all_properties(child)


def what_is_shown(group):
    """{display: names of what it has}: rviz calls a display without a robot or a topic "Ok" too."""
    displays = [group.getDisplayAt(i) for i in range(group.numDisplays())]
    return {display.getName(): {name for name, _ in all_properties(display)} for display in displays}


def statuses(group):
    """{display: "Ok", "Warn" or "Error"}, from the lines that rviz calls "Status: …"."""
    found = {}
    for i in range(group.numDisplays()):
        display = group.getDisplayAt(i)
        for name, _ in all_properties(display):
            if name.startswith("Status: "):
                found[display.getName()] = name[len("Status: "):]
    for name, _ in all_properties(group):
        if name.startswith("Global Status: "):
            found["Global Status"] = name[len("Global Status: "):]
    return found


class RvizTest(unittest.TestCase):
    def test_no_display_raises_an_error_status(self):
        screen = Screen()
        self.addCleanup(screen.close)
        found, shown = self.show()
        self.assertEqual(found, ALL_WELL)
        for display, name in MUST_BE_SHOWN.items():
            self.assertIn(name, shown[display])

    def show(self):
        application = QApplication(sys.argv[:1])
        reader = rviz.YamlConfigReader()
        config = rviz.Config()
        reader.readFile(config, CONFIG)
        frame = rviz.VisualizationFrame()
        frame.setSplashPath("")
        frame.initialize()
        frame.load(config)
        frame.show()
        group = frame.getManager().getRootDisplayGroup()
        robot, = (group.getDisplayAt(i) for i in range(group.numDisplays()) if group.getDisplayAt(i).getName() == "Robot")
        self.assertFalse(robot.isEnabled(), "rviz draws it red where it has no materials; the scene draws the links")
        robot.setEnabled(True)  # but it can be shown
        end = time.time() + PATIENCE
        # The first moments are without transforms, and a busy machine takes its time: what must be shown is
        # waited for, and an error that lasts is one.
        while time.time() < end:
            application.processEvents()
            time.sleep(0.02)
            found = statuses(group)
            shown = what_is_shown(group)
            if found == ALL_WELL and all(name in shown[display] for display, name in MUST_BE_SHOWN.items()):
                break
        return found, shown


if __name__ == "__main__":
    WHY_NOT = "no Xvfb" if not shutil.which("Xvfb") else "" if rviz else "rviz's module of Python does not load"
    run_or_skip("collision_pairs", "rviz", RvizTest, WHY_NOT)
