"""Publishes the transforms of boxes a, b, c along x, each well or with a fault of its own."""
import rospy
from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage

APART = {"a": 0.0, "b": 3.0, "c": 6.0}
TOUCHING = {"a": 0.0, "b": 0.9, "c": 6.0}
ELSEWHERE = 100.0  # m between boxes of messages with a fault: what is wrong must not read as apart
PERIOD = 0.02      # s


def box_at(name, x, stamp=None):
    transform = TransformStamped()
    transform.header.frame_id, transform.child_frame_id = "root", name
    transform.header.stamp = rospy.Time.now() if stamp is None else stamp
    transform.transform.translation.x, transform.transform.rotation.w = x, 1.0
    return transform


class BoxPublisher:
    def __init__(self, names, topic="/tf"):
        self._names = names
        self.fault = {}  # by name; none: sound
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
            stamp = now + rospy.Duration(2.0 if kind == "two_seconds_ahead" else 0.0)
            if kind == "last_stamp":
                stamp = rospy.Time(2**32 - 1, 999999999)
            transform = box_at(name, ELSEWHERE * (i + 1) if kind else x[name], stamp)
            if kind == "nan":
                transform.transform.rotation.w = float("nan")
            message.transforms.append(transform)
        self._publisher.publish(message)
