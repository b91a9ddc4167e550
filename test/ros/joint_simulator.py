"""Joints that follow velocity commands after a dead time, with a limited acceleration; another robot's are on the topic, too."""
import threading

import rospy
from sensor_msgs.msg import JointState

DEAD_TIME = 0.03     # s
ACCELERATION = 2.0   # m/s^2
PERIOD = 0.01        # s


class JointSimulator:
    def __init__(self, names):
        self.names = names
        self._lock = threading.Lock()
        self._positions = {name: 0.0 for name in names}
        self._velocities = {name: 0.0 for name in names}
        self._commands = []  # (when it takes effect, {joint: velocity})
        self._wanted = {}
        self._publisher = rospy.Publisher("/joint_states", JointState, queue_size=10)
        self._last = rospy.get_time()
        self.is_silent = False
        self.is_uneven = False  # names one more joint, first, without a position
        self._timer = rospy.Timer(rospy.Duration(PERIOD), self._step)

    def command(self, velocities):
        with self._lock:
            self._commands.append((rospy.get_time() + DEAD_TIME, velocities))

    def place(self, **positions):
        """At rest there, from now on."""
        with self._lock:
            self._positions.update(positions)
            self._velocities = {name: 0.0 for name in self.names}
            self._commands, self._wanted = [], {}
        rospy.sleep(0.15)

    def position(self, name):
        with self._lock:
            return self._positions[name]

    def _step(self, _):
        with self._lock:
            now = rospy.get_time()
            seconds, self._last = now - self._last, now
            while self._commands and self._commands[0][0] <= now:
                self._wanted = self._commands.pop(0)[1]
            for name in self.names:
                change = self._wanted.get(name, 0.0) - self._velocities[name]
                step = max(-ACCELERATION * seconds, min(ACCELERATION * seconds, change))
                self._velocities[name] += step
                self._positions[name] += self._velocities[name] * seconds
            message = JointState(name=self.names + ["joint_of_another_robot"],
                                 position=[self._positions[n] for n in self.names] + [0.5])
        message.header.stamp = rospy.Time.now()
        if self.is_uneven:
            message.name.insert(0, "gripper")
        if not self.is_silent:
            self._publisher.publish(message)
