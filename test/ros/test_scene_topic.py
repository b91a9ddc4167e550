#!/usr/bin/python3
"""What ~scene says: all that is checked, at each change once, and to those who come later."""
import os
import subprocess
import sys
import tempfile
import threading

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rosbag
import rospy
import rostest
import yaml
from std_srvs.srv import Trigger

from collision_pairs.msg import Scene
from node_client import PATIENCE
from scene_client import SceneCase, add_box, attach, clear, detach, move, remove, xyz_of


class SceneTopicTest(SceneCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.received = []
        cls.subscriber = rospy.Subscriber("/node/scene", Scene, cls.received.append)
        cls.reset = rospy.ServiceProxy("/node/reset", Trigger)

    def setUp(self):
        self.stand(0, 3, 6)
        self.scene.apply(clear(), add_box("of " + self.id()))
        self.newest(lambda scene: [listed.name for listed in scene.objects] == ["of " + self.id()])
        self.scene.apply(clear())
        self.newest(lambda scene: not scene.objects)

    def newest(self, is_wanted):
        """Once it has arrived."""
        end = rospy.get_time() + PATIENCE
        while rospy.get_time() < end and not (self.received and is_wanted(self.received[-1])):
            rospy.sleep(0.01)
        return self.received[-1]

    def newest_of(self, revision):
        return self.newest(lambda scene: scene.revision >= revision)

    def do_reset(self):
        reply = self.reset()
        self.assertTrue(reply.success, reply.message)

    def test_each_change_is_published_once_with_the_next_revision(self):
        first = self.received[-1].revision
        self.assertEqual(self.received[-1].objects, [])
        before = len(self.received)
        changes = [add_box("crate", (0, 0, 2)), add_box("tool", (3, 0, 2), touch_links=["c"]), move("crate", (1, 0, 2)),
                   attach("crate", "a", ["b"]), detach("crate"), attach("tool", "b"), remove("crate"), None, clear(), None]
        for count, change in enumerate(changes, 1):
            begin = rospy.Time.now()
            if change:
                objects = list(self.scene.apply(change).values())
            else:
                self.do_reset()
                objects = list(self.scene.apply().values())
            end = rospy.Time.now()
            scene = self.newest_of(first + count)
            self.assertEqual((scene.revision, scene.objects), (first + count, objects), change)
            self.assertTrue(begin <= scene.header.stamp <= end, change)
            # None of these changes the scene.
            self.assertFalse(self.scene.send(move("nothing", (0, 0, 0))).success)
            self.assertFalse(self.scene.send(add_box("crate"), attach("crate", "nowhere")).success)
            self.scene.apply()
            self.assertTrue(self.node.check(links=["a"] if count % 2 else ["b", "c"]).success)
        rospy.sleep(0.2)  # of one too many
        self.assertEqual([scene.revision for scene in self.received[before:]],
                         list(range(first + 1, first + len(changes) + 1)))

    def test_a_recording_that_begins_late_has_the_newest(self):
        objects = self.scene.apply(add_box("crate", (0, 0, 2)), add_box("tool", (3, 0, 2)))
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "scene.bag")
            subprocess.run(["rosbag", "record", "-l", "1", "-O", path, "/node/scene"], check=True, timeout=PATIENCE)
            with rosbag.Bag(path) as bag:
                (_, scene, _), = bag.read_messages()
        self.assertEqual([str(listed) for listed in scene.objects], [str(objects[name]) for name in sorted(objects)])

    def test_it_has_the_robot_and_the_settings(self):
        scene = self.received[-1]
        self.assertEqual(scene.header.frame_id, "root")
        self.assertEqual([(r.prefix, r.urdf, r.srdf) for r in scene.robots],
                         [("", rospy.get_param("/robot_description"), rospy.get_param("/robot_description_semantic"))])
        self.assertEqual((scene.world, scene.cloud_topics), ("", []))
        limits = {"max_pose_age": 1.0, "max_transform_age": 1.0, "clock_tolerance": 0.5}
        self.assertEqual(yaml.safe_load(scene.settings), limits)

    def test_parameters_that_change_count_from_the_reset_on(self):
        world = "<robot name='cell'><link name='cell'/></robot>"
        given = {"/node/padding": 0.1 + 0.2, "/node/clouds": [{"topic": "camera/points", "voxel_size": 0.05}],
                 "/node/pair_rules": [{"deny": ["a", "no*"]}], "/environment_description": world,
                 "/node/max_pose_age": 9.0}  # that one only from the start of the node
        before = self.received[-1]
        for name, value in given.items():
            rospy.set_param(name, value)
        try:
            self.scene.apply(add_box("crate", (0, 0, 2)))
            self.assertEqual(self.newest_of(before.revision + 1).settings, before.settings)
            self.do_reset()
            scene = self.newest_of(before.revision + 2)
        finally:
            for name in given:
                rospy.delete_param(name)
            self.do_reset()
        self.assertEqual(scene.cloud_topics, ["/camera/points"])
        self.assertEqual(scene.world, world)
        expected = {name[6:]: value for name, value in given.items() if name.startswith("/node/")}
        expected.update(max_pose_age=1.0, max_transform_age=1.0, clock_tolerance=0.5)
        self.assertEqual(yaml.safe_load(scene.settings), expected)
        self.assertEqual([listed.name for listed in scene.objects], ["crate"])
        after = self.newest_of(before.revision + 3)
        self.assertEqual((after.settings, after.world, after.cloud_topics), (before.settings, "", []))

    def test_what_is_gripped_while_the_robot_moves_has_its_pose_in_the_link(self):
        self.scene.apply(add_box("crate", (0, 0, 2)))
        moving = threading.Event()
        moving.set()
        begin = rospy.get_time()

        def drive():
            while moving.is_set():
                self.robot.hold([0.5 * (rospy.get_time() - begin), 3, 6])
        driver = threading.Thread(target=drive)
        driver.start()
        try:
            rospy.sleep(0.5)
            listed = self.scene.apply(attach("crate", "a"))["crate"]
            travelled = 0.5 * (rospy.get_time() - begin)
        finally:
            moving.clear()
            driver.join()
        crate = self.newest(lambda scene: scene.objects and scene.objects[0].attached_link).objects[0]
        self.assertEqual(crate, listed)
        self.assertEqual((crate.header.frame_id, crate.attached_link), ("a", "a"))
        x, y, z = xyz_of(crate)
        self.assertTrue(-travelled <= x < -0.02, (x, travelled))
        self.assertEqual((y, z), (0, 2))


if __name__ == "__main__":
    rospy.init_node("test_scene_topic")
    rostest.rosrun("collision_pairs", "scene_topic", SceneTopicTest)
