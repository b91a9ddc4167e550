#!/usr/bin/python3
"""rviz, on a screen of its own, shows our configuration without a complaint: topics, frames, robot."""
import os
import shutil
import subprocess
import sys
import time
import unittest

import rosgraph
import rostest

try:
    from python_qt_binding.QtWidgets import QApplication
    from rviz import bindings as rviz
except ImportError:  # Debian 13: python3-rviz 1.14.25 cannot be loaded, "sip.simplewrapper is not a registered type"
    rviz = None

CONFIG = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../config/collision_pairs.rviz")
PATIENCE = 150.0  # s
ALL_WELL = {"Global Status": "Ok", "Grid": "Ok", "Robot": "Ok", "Collision pairs": "Ok", "Scene": "Ok"}
TOPICS = {"/collision_pairs_node/markers", "/collision_pairs_node/scene_markers"}
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


class Screen:
    """An X server without a screen, on a display that is free."""

    def __init__(self):
        reading, writing = os.pipe()
        self._process = subprocess.Popen(["Xvfb", "-displayfd", str(writing), "-screen", "0", "1024x768x24"],
                                         pass_fds=[writing], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(writing)
        with os.fdopen(reading) as answer:
            self.name = ":" + answer.readline().strip()

    def close(self):
        self._process.terminate()
        self._process.wait()


def heard_by(node):
    subscriptions = rosgraph.Master("/rviz_test").getSystemState()[1]
    return {topic for topic, subscribers in subscriptions if node in subscribers}


@unittest.skipUnless(shutil.which("Xvfb"), "no Xvfb")
class RvizTest(unittest.TestCase):
    def setUp(self):
        screen = Screen()
        self.addCleanup(screen.close)
        os.environ.update(DISPLAY=screen.name, LIBGL_ALWAYS_SOFTWARE="1", QT_QPA_PLATFORM="xcb")

    def test_the_program_takes_our_configuration_and_listens(self):
        program = subprocess.Popen(["rosrun", "rviz", "rviz", "-d", CONFIG, "__name:=shown"])
        try:
            end = time.time() + PATIENCE
            while not heard_by("/shown") >= TOPICS and program.poll() is None and time.time() < end:
                time.sleep(0.1)
            self.assertGreaterEqual(heard_by("/shown"), TOPICS)
            time.sleep(3.0)  # in which it draws
            self.assertIsNone(program.poll(), "rviz ended by itself")
        finally:
            program.terminate()
            program.wait()

    @unittest.skipUnless(rviz, "skipped: rviz's module of Python does not load")
    def test_no_display_raises_an_error_status(self):
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
    rostest.rosrun("collision_pairs", "rviz", RvizTest)
