"""How the rostests write changes of the scene and send them to update_scene."""
import unittest

import rospy
from geometry_msgs.msg import Point, Pose, Quaternion
from shape_msgs.msg import Mesh, MeshTriangle, SolidPrimitive

from collision_pairs.msg import SceneChange, SceneObject
from collision_pairs.srv import UpdateScene
from node_client import PATIENCE, JointPublisher, NodeClient


def pose(xyz=(0, 0, 0), xyzw=(0, 0, 0, 1)):
    return Pose(position=Point(*xyz), orientation=Quaternion(*xyzw))


def box(*size):
    return SolidPrimitive(type=SolidPrimitive.BOX, dimensions=size)


def tetrahedron(size):
    """Its corner is the origin, its edges there lie along the axes."""
    corners = [(0, 0, 0), (size, 0, 0), (0, size, 0), (0, 0, size)]
    faces = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]
    return Mesh(vertices=[Point(*corner) for corner in corners],
                triangles=[MeshTriangle(vertex_indices=face) for face in faces])


def change(operation, name="", xyz=(0, 0, 0), frame="", **fields):
    """`fields` are those of SceneObject; they may replace the pose that xyz gives."""
    made = SceneObject(name=name, pose=pose(xyz))
    made.header.frame_id = frame
    for field, value in fields.items():
        getattr(made, field)  # a wrong name is our own mistake
        setattr(made, field, value)
    return SceneChange(operation=operation, object=made)


def add(name, xyz=(0, 0, 0), frame="", **fields):
    return change(SceneChange.ADD, name, xyz, frame, **fields)


def add_box(name, xyz=(0, 0, 0), size=(0.2, 0.2, 0.2), frame="", **fields):
    return add(name, xyz, frame, primitives=[box(*size)], **fields)


def move(name, xyz, frame="", **fields):
    return change(SceneChange.MOVE, name, xyz, frame, **fields)


def remove(name):
    return change(SceneChange.REMOVE, name)


def attach(name, link, touch_links=()):
    return change(SceneChange.ATTACH, name, attached_link=link, touch_links=list(touch_links))


def detach(name):
    return change(SceneChange.DETACH, name)


def clear():
    return change(SceneChange.CLEAR)


def xyz_of(listed):
    p = listed.pose.position
    return p.x, p.y, p.z


class SceneClient:
    def __init__(self, node):
        rospy.wait_for_service(node + "/update_scene", PATIENCE)
        self._update = rospy.ServiceProxy(node + "/update_scene", UpdateScene)

    def send(self, *changes, **fields):
        """The reply, whatever it is."""
        return self._update(changes=list(changes), **fields)

    def apply(self, *changes):
        """{name: object} after changes that must succeed."""
        reply = self.send(*changes)
        assert reply.success, reply.message
        return {listed.name: listed for listed in reply.objects}


class SceneCase(unittest.TestCase):
    """Three sliding boxes, the node that checks them, and its scene."""
    @classmethod
    def setUpClass(cls):
        cls.robot = JointPublisher(["slide_a", "slide_b", "slide_c"])
        cls.node = NodeClient("/node")
        cls.scene = SceneClient("/node")

    def stand(self, *positions):
        """A report of then."""
        since = self.robot.hold(positions)
        report = self.node.report_since(since, lambda r: not r.left_out)
        self.assertIsNotNone(report)
        return report
