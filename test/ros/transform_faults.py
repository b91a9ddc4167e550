"""Publishes the transforms of boxes a, b, c along x, each well or with a fault of its own."""
import bisect
import threading

import rospy
from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage

APART = {"a": 0.0, "b": 3.0, "c": 6.0}
TOUCHING = {"a": 0.0, "b": 0.9, "c": 6.0}
ELSEWHERE = 100.0  # m between boxes of messages with a fault: what is wrong must not read as apart
PERIOD = 0.02      # s


def box_at(name, x):
    transform = TransformStamped()
    transform.header.frame_id, transform.child_frame_id = "root", name
    transform.header.stamp = rospy.Time.now()
    transform.transform.translation.x, transform.transform.rotation.w = x, 1.0
    return transform


class BoxPublisher:
    FAULTS = ("silent", "nan", "zero_stamp", "old_stamp", "not_a_rotation", "hour_ahead", "two_seconds_ahead",
              "last_stamp")
    AHEAD = {"hour_ahead": 3600.0, "two_seconds_ahead": 2.0, "old_stamp": -100.0}

    def __init__(self, names, topic="/tf"):
        self._names = names
        self._lock = threading.Lock()
        self._history = []  # (time, were the sound ones apart), by time
        self.fault = {}     # by name; none: sound
        self.x = dict(APART)
        self._publisher = rospy.Publisher(topic, TFMessage, queue_size=100)
        self._timer = None

    def heal(self):
        """All are sound from now on."""
        self.fault = {}
        if not self._timer:
            self._timer = rospy.Timer(rospy.Duration(PERIOD), self._publish)

    def stop(self):
        self._timer.shutdown()
        self._timer.join()

    def _publish(self, _):
        fault, x, now = dict(self.fault), dict(self.x), rospy.Time.now()
        message = TFMessage()
        for i, name in enumerate(self._names):
            kind = fault.get(name)
            if kind == "silent":
                continue
            transform = TransformStamped()
            transform.header.frame_id, transform.child_frame_id = "root", name
            transform.header.stamp = now + rospy.Duration(self.AHEAD.get(kind, 0.0))
            if kind == "zero_stamp":
                transform.header.stamp = rospy.Time(0)
            if kind == "last_stamp":
                transform.header.stamp = rospy.Time(2**32 - 1, 999999999)
            transform.transform.translation.x = ELSEWHERE * (i + 1) if kind else x[name]
            transform.transform.rotation.w = {"nan": float("nan"), "not_a_rotation": 0.0}.get(kind, 1.0)
            message.transforms.append(transform)
        sound = sorted(x[name] for name in self._names if name not in fault)
        with self._lock:
            self._history.append((now.to_sec(), all(b - a > 1.0 for a, b in zip(sound, sound[1:]))))
        self._publisher.publish(message)

    def was_free_at(self, time):
        """Whether what was soundly published just before and after that time was apart; between the two TF
        interpolates, and where a box fell silent over up to a second."""
        with self._lock:
            times = [t for t, _ in self._history]
            at = bisect.bisect_left(times, time - 1e-6)
            near = self._history[max(0, at - 1):at + 2]
            return any(free for _, free in near)
