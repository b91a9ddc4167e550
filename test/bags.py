"""Bags that the tests write: others with changes, and the transforms in them."""
import rosbag
import rospy
from conftest import DEMO_BAG
from geometry_msgs.msg import TransformStamped


def copied(path, change=lambda messages: messages, source=DEMO_BAG, **options):
    """Writes what `change` makes of another bag's messages, each (topic, message, recorded); returns the path."""
    with rosbag.Bag(str(source)) as bag:
        messages = list(bag.read_messages())
    with rosbag.Bag(str(path), "w", **options) as target:
        for topic, message, recorded in change(messages):
            target.write(topic, message, recorded)
    return path


def in_order(messages):
    return sorted(messages, key=lambda m: m[2])


def stamped_transform(parent, child, seconds, xyz=(0.0, 0.0, 0.0)):
    """Without a rotation."""
    made = TransformStamped()
    made.header.stamp, made.header.frame_id, made.child_frame_id = rospy.Time.from_sec(seconds), parent, child
    made.transform.rotation.w = 1.0
    made.transform.translation.x, made.transform.translation.y, made.transform.translation.z = xyz
    return made
