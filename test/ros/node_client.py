"""How the rostests talk to the node: its topics and services, each with a patience of seconds."""
import threading

import rospy
import tf2_msgs.msg
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TransformStamped
from std_msgs.msg import Bool
from visualization_msgs.msg import Marker, MarkerArray

from collision_pairs.msg import CollisionPairs
from collision_pairs.srv import CheckCollisions

PATIENCE = 60.0  # s: a busy machine takes its time


class NodeClient:
    """Collects what a node publishes and calls its service."""

    def __init__(self, name):
        self._name = name
        self._lock = threading.Lock()
        self.reports, self.verdicts, self.marker_arrays = [], [], []
        self.received = {}  # id of a message: when
        rospy.Subscriber(name + "/collision_pairs", CollisionPairs, self._keep(self.reports))
        rospy.Subscriber(name + "/in_collision", Bool, self._keep(self.verdicts))
        rospy.Subscriber(name + "/markers", MarkerArray, self._keep(self.marker_arrays))
        rospy.wait_for_service(name + "/check_collisions", PATIENCE)
        self.check = rospy.ServiceProxy(name + "/check_collisions", CheckCollisions)

    def _keep(self, where):
        def keep(message):
            with self._lock:
                self.received[id(message)] = rospy.get_time()
                where.append(message)
        return keep

    def next(self, where, condition=lambda message: True):
        """The next message that meets the condition; None if patience ends first."""
        start = len(where)
        end = rospy.get_time() + PATIENCE
        while rospy.get_time() < end:
            for message in where[start:]:
                if condition(message):
                    return message
            rospy.sleep(0.01)
        return None

    def wait_for(self, verdict, *words):
        """The next report with this verdict, and these words among its reasons."""
        report = self.next(self.reports, lambda r: r.verdict == verdict and all(
            word in " ".join(r.unknown_because) for word in words))
        assert report, "no report %d with %s; the last: %s" % (verdict, words, self.reports[-1:])
        return report

    def report_since(self, stamp, condition=lambda report: True):
        """A report of poses later than the stamp."""
        return self.next(self.reports, lambda r: r.header.stamp > stamp and condition(r))


def diagnosis_of(node):
    """The next status that a node gives of itself; `node` without a leading slash."""
    found = []

    def keep(message):
        found.extend(status for status in message.status if status.name.startswith(node))
    subscriber = rospy.Subscriber("/diagnostics", DiagnosticArray, keep)
    end = rospy.get_time() + PATIENCE
    while rospy.get_time() < end and not found:
        rospy.sleep(0.1)
    subscriber.unregister()
    return found[-1]


class JointPublisher:
    """Keeps publishing one posture until it is given another."""

    def __init__(self, names, rate=50.0, topic="joint_states"):
        from sensor_msgs.msg import JointState
        self._message = JointState(name=names, position=[0.0] * len(names))
        self._publisher = rospy.Publisher(topic, JointState, queue_size=1)
        self._timer = rospy.Timer(rospy.Duration(1.0 / rate), self._publish)

    def _publish(self, _):
        self._message.header.stamp = rospy.Time.now()
        self._publisher.publish(self._message)

    def stop(self):
        self._timer.shutdown()
        self._timer.join()

    def hold(self, position):
        """Returns the time from which on the robot surely stands there."""
        self._message.position = list(position)
        rospy.sleep(0.1)
        return rospy.Time.now()


def publish_transform(publisher, parent, child, xyz=(0, 0, 0), xyzw=(0, 0, 0, 1)):
    transform = TransformStamped()
    transform.header.stamp = rospy.Time.now()
    transform.header.frame_id, transform.child_frame_id = parent, child
    t, q = transform.transform.translation, transform.transform.rotation
    t.x, t.y, t.z = xyz
    q.x, q.y, q.z, q.w = xyzw
    publisher.publish(tf2_msgs.msg.TFMessage([transform]))


def boxes_by_namespace(array):
    """{namespace: {element id: (lower corner, upper corner)}} of the boxes in a marker array."""
    boxes = {}
    for marker in array.markers:
        if marker.action == Marker.ADD and marker.type == Marker.CUBE:
            p, s = marker.pose.position, marker.scale
            center, size = (p.x, p.y, p.z), (s.x, s.y, s.z)
            boxes.setdefault(marker.ns, {})[marker.id] = (
                [c - d / 2 for c, d in zip(center, size)], [c + d / 2 for c, d in zip(center, size)])
    return boxes


def gap(a, b):
    """Euclidean distance of two boxes."""
    return sum(max(0.0, b[0][i] - a[1][i], a[0][i] - b[1][i]) ** 2 for i in range(3)) ** 0.5
