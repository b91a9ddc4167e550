"""Publishes point clouds, well and badly, and learns what the node says of them."""
import contextlib
import struct
import threading

import rospy
from diagnostic_msgs.msg import DiagnosticArray
from sensor_msgs.msg import PointCloud2, PointField
from std_srvs.srv import Trigger

PATIENCE = 20.0  # s


def cloud_of(points, frame, stamp=None):
    """Packed float32 x y z, as most drivers publish them."""
    cloud = PointCloud2(height=1, width=len(points), point_step=12, row_step=12 * len(points), is_dense=True)
    cloud.header.frame_id, cloud.header.stamp = frame, stamp or rospy.Time.now()
    cloud.fields = [PointField(name, 4 * i, PointField.FLOAT32, 1) for i, name in enumerate("xyz")]
    cloud.data = b"".join(struct.pack("<3f", *point) for point in points)
    return cloud


@contextlib.contextmanager
def other_clouds(node):
    """Gives the settings of its cloud, and what resets the node with others; in the end it has its own again."""
    given = rospy.get_param(node + "/clouds")
    reset = rospy.ServiceProxy(node + "/reset", Trigger)

    def use(*clouds):
        rospy.set_param(node + "/clouds", list(clouds))
        return reset()
    try:
        yield given[0], use
    finally:
        assert use(*given).success


class CloudPublisher:
    """Keeps publishing the same points, stamped now; `spoil` may change each message before it goes."""

    def __init__(self, topic, frame, rate=20.0):
        self.points, self.frame, self.spoil, self.silent = [], frame, None, False
        self._publisher = rospy.Publisher(topic, PointCloud2, queue_size=1)
        self._lock = threading.Lock()
        self._timer = rospy.Timer(rospy.Duration(1.0 / rate), self._publish)

    def _publish(self, _):
        with self._lock:
            if self.silent:
                return
            cloud = cloud_of(self.points, self.frame)
            if self.spoil:
                self.spoil(cloud)
            self._publisher.publish(cloud)

    def send(self, cloud):
        self._publisher.publish(cloud)

    def heal(self, points, frame):
        with self._lock:
            self.points, self.frame, self.spoil, self.silent = points, frame, None, False

    def stop(self):
        self._timer.shutdown()
        self._timer.join()


def cloud_diagnosis(condition):
    """The next status of the point clouds that meets the condition, as a dictionary with its message; or None."""
    found = []

    def keep(array):
        for status in array.status:
            if status.name.endswith("point clouds"):
                values = dict({v.key: v.value for v in status.values}, message=status.message)
                if condition(values):
                    found.append(values)
    subscriber = rospy.Subscriber("/diagnostics", DiagnosticArray, keep)
    end = rospy.get_time() + PATIENCE
    while rospy.get_time() < end and not found:
        rospy.sleep(0.1)
    subscriber.unregister()
    return found[0] if found else None
