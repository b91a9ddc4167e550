#!/usr/bin/python3
"""The scene as it is modelled, drawn when somebody comes to look and when it changes, and not in between."""
import os
import subprocess
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import rostest
from dynamic_reconfigure.msg import Config, StrParameter
from dynamic_reconfigure.srv import Reconfigure
from visualization_msgs.msg import Marker, MarkerArray

from node_client import PATIENCE
from scene_client import SceneCase, add, add_box, clear, tetrahedron


class Viewer:
    """Looks at the markers from now on."""

    def __init__(self):
        self.arrays = []  # each of which differs from the one before
        self.times = []  # of all
        self._subscriber = rospy.Subscriber("/node/scene_markers", MarkerArray, self._keep)

    def _keep(self, array):
        self.times.append(rospy.get_time())
        if not self.arrays or array != self.arrays[-1]:
            self.arrays.append(array)

    def wait_for(self, nb_arrays):
        end = rospy.get_time() + PATIENCE
        while rospy.get_time() < end and len(self.arrays) < nb_arrays:
            rospy.sleep(0.01)
        return self.arrays[nb_arrays - 1]

    def close(self):
        self._subscriber.unregister()


def drawn(array):
    """[(namespace, frame, type, scale)] of what is drawn."""
    return sorted((m.ns, m.header.frame_id, m.type, tuple(round(s, 9) for s in (m.scale.x, m.scale.y, m.scale.z)))
                  for m in array.markers if m.action == Marker.ADD)


# In a process of its own, for subscribers of one process share a connection.
COUNT_MARKERS = """
import rospy
from visualization_msgs.msg import MarkerArray
rospy.init_node("late_viewer")
print(len(rospy.wait_for_message("/node/scene_markers", MarkerArray, %g).markers))
""" % PATIENCE

UNIT = (1.0, 1.0, 1.0)
LINKS = [("links", link, Marker.CUBE, UNIT) for link in "abc"]


class SceneMarkersTest(SceneCase):
    def setUp(self):
        self.scene.apply(clear())
        self.stand(0, 3, 6)
        self.viewer = Viewer()

    def tearDown(self):
        self.viewer.close()

    def test_01_everyone_who_comes_late_sees_the_scene_again_after_two_and_four_seconds_more(self):
        begin, times = rospy.get_time(), self.viewer.times
        self.assertEqual(drawn(self.viewer.wait_for(1)), LINKS)
        end = begin + PATIENCE
        while rospy.get_time() < end and len(times) < 3:
            rospy.sleep(0.1)
        self.assertGreater(times[0] - begin, 0.9, "a second, for rviz to know the frames")
        self.assertGreater(times[1] - times[0], 1.8, "for who missed it")
        self.assertGreater(times[2] - times[1], 3.8, "for who missed it again")
        self.assertEqual(len(self.viewer.arrays), 1)
        late = subprocess.run([sys.executable, "-c", COUNT_MARKERS], check=True, stdout=subprocess.PIPE, text=True)
        self.assertEqual(int(late.stdout), 1 + len(LINKS))  # what clears the old ones, too

    def test_a_change_is_drawn_once_in_place_of_what_was_there(self):
        self.viewer.wait_for(1)
        self.scene.apply(add_box("box", (0, 0, 3), size=(0.1, 0.2, 0.3)))
        array = self.viewer.wait_for(2)
        self.assertEqual(array.markers[0].action, Marker.DELETEALL)
        self.assertEqual(drawn(array), LINKS + [("standing", "root", Marker.CUBE, (0.1, 0.2, 0.3))])
        self.assertEqual(len({(m.ns, m.id) for m in array.markers[1:]}), 4)
        self.scene.apply(clear())
        self.assertEqual(drawn(self.viewer.wait_for(3)), LINKS)
        nb_seen = len(self.viewer.times)
        self.scene.apply()  # who asks for the list changes nothing
        rospy.sleep(0.5)
        if rospy.get_time() - self.viewer.times[nb_seen - 1] < 1.9:  # then it is shown again
            self.assertEqual(len(self.viewer.times), nb_seen)

    def test_another_fidelity_is_drawn_at_once(self):
        self.viewer.wait_for(1)
        self.scene.apply(add("mesh", (1, 5, 2), meshes=[tetrahedron(0.25)]))
        self.viewer.wait_for(2)
        set_parameters = rospy.ServiceProxy("/node/set_parameters", Reconfigure)
        for nb_arrays, (fidelity, drawn_as) in enumerate((("obb", Marker.CUBE), ("mesh", Marker.TRIANGLE_LIST)), 3):
            set_parameters(Config(strs=[StrParameter("fidelity", fidelity)]))
            mesh = [m for m in self.viewer.wait_for(nb_arrays).markers if m.ns == "standing"][0]
            self.assertEqual(mesh.type, drawn_as)


if __name__ == "__main__":
    rospy.init_node("test_scene_markers")
    rostest.rosrun("collision_pairs", "scene_markers", SceneMarkersTest)
