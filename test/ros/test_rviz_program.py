#!/usr/bin/python3
"""rviz, on a screen of its own, starts with our configuration, and subscribes to what it shows."""
import os
import shutil
import subprocess
import sys
import time
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rosgraph

from screen import Screen
from skipping_runner import run_or_skip

CONFIG = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../config/collision_pairs.rviz")
PATIENCE = 150.0  # s
TOPICS = {"/collision_pairs_node/markers", "/collision_pairs_node/scene_markers"}


def heard_by(node):
    subscriptions = rosgraph.Master("/rviz_program_test").getSystemState()[1]
    return {topic for topic, subscribers in subscriptions if node in subscribers}


class RvizProgramTest(unittest.TestCase):
    def test_it_takes_our_configuration_and_listens(self):
        screen = Screen()
        self.addCleanup(screen.close)
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


if __name__ == "__main__":
    run_or_skip("collision_pairs", "rviz_program", RvizProgramTest, "" if shutil.which("Xvfb") else "no Xvfb")
