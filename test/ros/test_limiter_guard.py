#!/usr/bin/python3
"""Who stops the robot when a decision hangs, and when the limiter's process hangs or dies."""
import ctypes
import os
import shutil
import signal
import sys
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import roslib.packages
import rosnode
import rospy
import rostest
from std_msgs.msg import Float64MultiArray
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from collision_pairs.msg import SpeedLimit
from joint_simulator import JointSimulator
from node_client import PATIENCE, diagnosis_of
from program import NODE, Program, ProgramCase, wait_until

GUARD = roslib.packages.find_node("collision_pairs", "limited_command_guard")[0]
PERIOD, TIMEOUT, SPEED = 0.01, 0.2, 0.05   # s, s, m/s
LATE = 1.0     # s: of a machine with much other work; what is measured is printed
ATTACH, DETACH, ALL_THREADS = 16, 17, 0x40000000  # sys/ptrace.h, sys/wait.h
# The robot stands all the time.
LIMITER = {"joints": ["slide_a"], "deceleration": 2.0, "command_timeout": TIMEOUT, "tracking_tolerance": 10.0}


class Heard:
    """The velocities that come on a topic, and when."""

    def __init__(self, topic, kind):
        self.messages, self.when = [], []
        self.subscriber = rospy.Subscriber(topic, kind, self._on_message, tcp_nodelay=True)

    def _on_message(self, message):
        self.when.append(time.monotonic())
        self.messages.append(message)

    def velocities(self):
        return [list(m.data if hasattr(m, "data") else m.points[0].velocities) for m in self.messages[:]]

    def moves(self):
        return any(self.velocities()[-1:]) and any(self.velocities()[-1])

    def seconds_to_zeros(self, what):
        """From the last command that moves to the zeros that follow it."""
        def stands():
            return not any(self.velocities()[-1])
        wait_until(stands, "zeros")
        all_of = self.velocities()
        last = max(i for i, velocities in enumerate(all_of) if any(velocities))
        took = self.when[last + 1] - self.when[last]
        print("%s: zeros %.1f ms after the last command, of which command_timeout is %.0f" % (
            what, 1e3 * took, 1e3 * TIMEOUT), flush=True)
        return took


class LimiterGuardTest(ProgramCase):
    @classmethod
    def setUpClass(cls):
        cls.joints = JointSimulator(["slide_a", "slide_b", "slide_c"])
        cls.joints.place(slide_a=0.0, slide_b=4.0, slide_c=8.0)

    def setUp(self):
        super().setUp()
        self.timers = []

    def tearDown(self):
        for timer in self.timers:
            timer.shutdown()
        for program in self.programs:
            if program.process.poll() is None:
                os.kill(program.process.pid, signal.SIGCONT)
        super().tearDown()

    def start_limiter(self, name, message):
        """A limiter, its guard, and commands that repeat the message. Returns the two and what comes out of each."""
        kind = type(message)
        settings = dict(LIMITER, command="/%s/asked" % name, command_type=kind._type)
        for node in (name, name + "_guard"):
            rospy.set_param("/%s/velocity_limiter" % node, settings)
        limiter = Program(NODE, "__name:=" + name)
        guard = Program(GUARD, "__name:=%s_guard" % name, "~limited_command:=/%s/limited_command" % name,
                        "~command:=/%s/command" % name)
        self.programs += [limiter, guard]
        limited, passed = Heard("/%s/limited_command" % name, kind), Heard("/%s/command" % name, kind)
        publisher = rospy.Publisher("/%s/asked" % name, kind, queue_size=1, tcp_nodelay=True)
        self.timers.append(rospy.Timer(rospy.Duration(PERIOD), lambda _: publisher.publish(message)))
        wait_until(passed.moves, "a command through limiter and guard")
        time.sleep(0.5)
        return limiter, guard, limited, passed

    def array(self):
        return Float64MultiArray(data=[SPEED])

    def trajectory(self):
        point = JointTrajectoryPoint(velocities=[SPEED], positions=[0.5], time_from_start=rospy.Duration(0.05))
        message = JointTrajectory(joint_names=["slide_a"], points=[point])
        message.header.stamp = rospy.Time.now()
        return message

    def test_a_decision_that_is_blocked_does_not_keep_zeros_back(self):
        limiter, _, limited, _ = self.start_limiter("blocked", self.array())
        limits = []
        rospy.Subscriber("/blocked/speed_limit", SpeedLimit, limits.append)
        tasks = "/proc/%d/task" % limiter.process.pid
        decider = next(int(task) for task in os.listdir(tasks)
                       if open(os.path.join(tasks, task, "comm")).read() == "limiter_decide\n")
        ptrace = ctypes.CDLL(None, use_errno=True).ptrace
        ptrace.argtypes = [ctypes.c_long, ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p]
        if ptrace(ATTACH, decider, None, None) != 0:
            self.skipTest("ptrace is not permitted: " + os.strerror(ctypes.get_errno()))
        try:
            os.waitpid(decider, ALL_THREADS)
            self.assertLess(limited.seconds_to_zeros("a blocked decision"), TIMEOUT + LATE)
            wait_until(lambda: limits and limits[-1].scale == 0.0, "the reason")
            time.sleep(1.0)
            self.assertFalse(limited.moves(), "nothing passes while it is blocked")
        finally:
            ptrace(DETACH, decider, None, None)
        wait_until(limited.moves, "commands that pass again")
        wait_until(lambda: int({value.key: value.value for value in diagnosis_of("blocked: velocity limiter").values}
                               ["commands"]) > 0, "diagnostics")

    def test_a_limiter_that_hangs_does_not_keep_the_guard_from_zeros(self):
        limiter, _, limited, passed = self.start_limiter("hangs", self.array())
        os.kill(limiter.process.pid, signal.SIGSTOP)
        self.assertLess(passed.seconds_to_zeros("a limiter that hangs"), TIMEOUT + LATE)
        self.assertTrue(limited.moves(), "these zeros are of the guard")
        nb_passed = len(passed.messages)
        time.sleep(0.5)
        self.assertEqual(len(passed.messages), nb_passed, "once, then silence")
        os.kill(limiter.process.pid, signal.SIGCONT)
        wait_until(passed.moves, "commands that pass again")

    def test_a_limiter_that_is_killed_leaves_zeros(self):
        limiter, _, _, passed = self.start_limiter("killed", self.array())
        limiter.process.kill()
        self.assertLess(passed.seconds_to_zeros("a limiter that is killed"), TIMEOUT + LATE)

    def test_a_guard_that_is_started_again_sends_zeros_also_to_a_controller_that_connects_later(self):
        for message in (self.array(), self.trajectory()):
            name = "again_" + type(message).__name__.lower()
            limiter, guard, _, passed = self.start_limiter(name, message)
            for program in (limiter, guard):  # at once: the last command goes on for ever
                program.process.kill()
            guard.process.wait(PATIENCE)
            self.assertTrue(passed.moves())
            self.programs.append(Program(GUARD, "__name:=%s_guard" % name, "~limited_command:=/%s/limited_command" % name,
                                         "~command:=/%s/command" % name))
            wait_until(lambda: not passed.moves(), "zeros at the start")
            passed.subscriber.unregister()  # two in one process share a connection
            time.sleep(2 * TIMEOUT)
            late = Heard("/%s/command" % name, type(message))
            wait_until(lambda: late.messages, "zeros for who connects later")
            self.assertEqual(late.velocities(), [[0.0]])

    def test_a_guard_that_is_asked_to_end_sends_zeros_first(self):
        _, guard, _, passed = self.start_limiter("asked", self.array())
        ends = [lambda number=number: guard.process.send_signal(number) for number in (signal.SIGINT, signal.SIGTERM)]
        for end in ends + [lambda: rosnode.kill_nodes(["/asked_guard"])]:
            wait_until(passed.moves, "a command through limiter and guard")
            end()
            self.assertEqual(guard.process.wait(PATIENCE), 0)
            wait_until(lambda: not passed.moves(), "zeros")
            time.sleep(0.2)
            self.assertFalse(passed.moves())
            guard = Program(GUARD, "__name:=asked_guard", "~limited_command:=/asked/limited_command", "~command:=/asked/command")
            self.programs.append(guard)

    def test_a_trajectory_controller_is_stopped_at_once_and_where_the_robot_is(self):
        limiter, _, _, passed = self.start_limiter("trajectory", self.trajectory())
        os.kill(limiter.process.pid, signal.SIGSTOP)
        self.assertLess(passed.seconds_to_zeros("a limiter of trajectories that hangs"), TIMEOUT + LATE)
        stop = passed.messages[-1]
        self.assertTrue(stop.header.stamp.is_zero(), "a point of the past is dropped")
        self.assertEqual(stop.joint_names, ["slide_a"])
        self.assertLessEqual(stop.points[0].time_from_start.to_sec(), 0.05)
        self.assertEqual(len(stop.points[0].positions), 1)

    def test_zeros_are_of_the_limiters_joints_whatever_a_malformed_trajectory_names(self):
        malformed = self.trajectory()
        malformed.joint_names[0], malformed.points[0].positions = "slide_x", []
        _, _, _, passed = self.start_limiter("malformed", self.trajectory())
        self.timers.pop().shutdown()
        wait_until(lambda: not passed.moves(), "zeros")
        publisher = rospy.Publisher("/malformed/asked", JointTrajectory, queue_size=1, tcp_nodelay=True)
        wait_until(publisher.get_num_connections, "a connection")
        nb_passed = len(passed.messages)
        publisher.publish(malformed)
        wait_until(lambda: len(passed.messages) >= nb_passed + 2, "zeros of the limiter, and then of the guard")
        self.assertEqual({tuple(message.joint_names) for message in passed.messages}, {("slide_a",)})
        # A guard that hears someone else.
        rospy.set_param("/alone/velocity_limiter", dict(LIMITER, command="/alone/asked", command_type=JointTrajectory._type))
        heard = Heard("/alone/command", JointTrajectory)
        self.start(GUARD, "__name:=alone")
        publisher = rospy.Publisher("/alone/limited_command", JointTrajectory, queue_size=1, tcp_nodelay=True)
        wait_until(publisher.get_num_connections, "a connection")
        publisher.publish(malformed)
        wait_until(lambda: heard.moves() or heard.messages[-1:] and heard.messages[-1].joint_names == ["slide_x"], "it passes")
        wait_until(lambda: heard.messages[-1].joint_names == ["slide_a"], "zeros of its own joints")
        self.assertEqual(heard.velocities()[-1], [0.0])

    def test_without_real_time_scheduling_log_and_diagnostics_have_the_line_that_permits_it(self):
        refused = []
        if os.geteuid() == 0:
            if not shutil.which("setpriv"):
                self.skipTest("setpriv is missing")
            refused = ["setpriv", "--bounding-set", "-sys_nice", "--inh-caps", "-sys_nice"]
        rospy.set_param("/idle/velocity_limiter", dict(LIMITER, command="/idle/asked"))
        rospy.set_param("/idle_guard/velocity_limiter", dict(LIMITER, command="/idle/asked"))
        for program, name in ((NODE, "idle"), (GUARD, "idle_guard")):
            self.start(*refused, program, "__name:=" + name)
        for program in self.programs:
            wait_until(lambda: "scheduling" in program.said() or program.process.poll() is not None, "a word")
            if not program.said() and not refused:
                self.skipTest("it is permitted")
            self.assertRegex(program.said(), r"no real-time scheduling: .*/etc/security/limits.conf .*- rtprio \d+'")
            self.assertEqual(program.said().count("no real-time scheduling"), 1)
        values = {pair.key: pair.value for pair in diagnosis_of("idle: velocity limiter").values}
        self.assertRegex(values["real-time scheduling"], r"^no real-time scheduling: .*limits.conf .*- rtprio \d+'$")

    def test_a_command_that_comes_back_as_the_limited_one_is_refused(self):
        for node, topic in (("loop", "/loop/limited_command"), ("loop_guard", "/loop_guard/command")):
            rospy.set_param("/%s/velocity_limiter" % node, dict(LIMITER, command=topic))
        guard = Program(GUARD, "__name:=loop_guard")
        self.programs.append(guard)
        guard.wait_for("commands are read from /loop_guard/command and passed on there")
        self.assertEqual(guard.process.wait(60), 1)
        rospy.set_param("/self_guard/velocity_limiter", dict(LIMITER, command="/other"))
        guard = Program(GUARD, "__name:=self_guard", "~command:=/self_guard/limited_command")
        self.programs.append(guard)
        guard.wait_for("commands are read from /self_guard/limited_command and passed on there")
        self.assertEqual(guard.process.wait(60), 1)
        self.start(NODE, "__name:=loop")
        self.programs[-1].wait_for("commands are read from /loop/limited_command and passed on there")
        self.assertRegex(diagnosis_of("loop: velocity limiter").message, "would be heard again")

    def test_without_the_limiters_settings_a_guard_says_so(self):
        guard = Program(GUARD, "__name:=no_settings")
        guard.wait_for("the parameter ~velocity_limiter is not set")
        self.assertEqual(guard.process.wait(60), 1)


if __name__ == "__main__":
    rospy.init_node("test_limiter_guard")
    rostest.rosrun("collision_pairs", "limiter_guard", LimiterGuardTest)
