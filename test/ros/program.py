"""Programs that a rostest starts itself: to hear what they say, or to see how they end."""
import os
import subprocess
import tempfile
import time
import unittest

import roslib.packages

from node_client import PATIENCE

NODE = roslib.packages.find_node("collision_pairs", "collision_pairs_node")[0]


def wait_until(condition, what):
    end = time.time() + PATIENCE
    while not condition():
        if time.time() > end:
            raise AssertionError("waited in vain: " + what)
        time.sleep(0.05)


class Program:
    """A program under a master of its own choice, and what it says."""

    def __init__(self, *command, master=None):
        environment = dict(os.environ, ROS_MASTER_URI=master or os.environ["ROS_MASTER_URI"],
                           PYTHONUNBUFFERED="1", ROSCONSOLE_STDOUT_LINE_BUFFERED="1")  # they say at once what they do
        self._said = tempfile.NamedTemporaryFile()
        self.process = subprocess.Popen(command, env=environment, stdout=self._said, stderr=subprocess.STDOUT)

    def said(self):
        with open(self._said.name) as file:  # not by the descriptor that the program writes to
            return file.read()

    def wait_for(self, words):
        try:
            wait_until(lambda: words in self.said(), words)
        except AssertionError:
            raise AssertionError("waited in vain for %r in: %s" % (words, self.said()))

    def end(self):
        self.process.terminate()
        self.process.wait(PATIENCE)


class ProgramCase(unittest.TestCase):
    """What a test starts ends with it."""
    def setUp(self):
        self.programs = []

    def tearDown(self):
        for program in self.programs:
            program.end()

    def start(self, *command, master=None):
        self.programs.append(Program(*command, master=master))
        return self.programs[-1]
