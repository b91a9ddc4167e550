#!/usr/bin/python3
"""Every line of the node's log that a user would read, by the situation that it tells of."""
import os
import re
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from dynamic_reconfigure.msg import Config, DoubleParameter, StrParameter
from dynamic_reconfigure.srv import Reconfigure
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger

from cloud_client import CloudPublisher
from collision_pairs.srv import CheckCollisions
from node_client import PATIENCE, diagnosis_of
from program import NODE, ProgramCase, wait_until

HERE = os.path.dirname(os.path.abspath(__file__))
SHEET = ("solid sheet\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
         "endloop\nendfacet\nendsolid sheet\n")
BOX = "<collision><geometry><box size='1 1 1'/></geometry></collision>"
BARE = "<robot name='bare'><link name='root'/></robot>"


def link(name, *collisions):
    return "<link name='%s'>%s</link>" % (name, "".join(collisions))


def joint(kind, parent, child, more=""):
    return ("<joint name='to_%s' type='%s'><parent link='%s'/><child link='%s'/>%s<limit lower='-9' upper='9' effort='1' "
            "velocity='1'/></joint>" % (child, kind, parent, child, more))


def file_of(name):
    with open(os.path.join(HERE, name)) as file:
        return file.read()


class LogTest(ProgramCase):
    def start_node(self, ns, robot=None, srdf=None, **parameters):
        """A node of its own namespace, with these descriptions and private parameters."""
        for key, value in (("robot_description", robot), ("robot_description_semantic", srdf)):
            if value is not None:
                rospy.set_param("/%s/%s" % (ns, key), value)
        for key, value in parameters.items():
            rospy.set_param("/%s/node/%s" % (ns, key), value)
        return self.start(NODE, "__name:=node", "__ns:=/" + ns)

    def service(self, ns, name, kind):
        rospy.wait_for_service("/%s/node/%s" % (ns, name), PATIENCE)
        return rospy.ServiceProxy("/%s/node/%s" % (ns, name), kind)

    def test_what_a_scene_is_made_of_and_what_of_its_descriptions_has_no_effect(self):
        with tempfile.NamedTemporaryFile("w", suffix=".stl") as mesh:
            mesh.write(SHEET)
            mesh.flush()
            sheet = "<collision><geometry><mesh filename='file://%s'/></geometry></collision>" % mesh.name
            robot = ("<robot name='boxes'>" + link("root") + link("a", BOX, BOX) + link("b", BOX) + link("c", sheet) +
                     joint("prismatic", "root", "a") + joint("prismatic", "root", "b") +
                     joint("fixed", "b", "c", "<mimic joint='to_a'/>") + "</robot>")
            srdf = "<robot name='boxes'><disable_collisions link1='zz' link2='b'/></robot>"
            # As far from a name as may be meant for it (one in six letters, and one more), and further.
            misspelt = {"max_pos_age": "max_pose_age", "rat": "rate", "raeter": "rate", "mxx_pxse_xge": "max_pose_age"}
            node = self.start_node("made", robot, srdf, ratio=2.0, **{name: 2.0 for name in misspelt})
            node.wait_for("robot 'boxes': 3 links with geometry to check, 4 elements, 2 moving bodies, ready after 0.")
            node.wait_for("'c': about 50 % of the surface of mesh")
            node.wait_for("left out, no usable transform: link 'a': ")
        said = node.said()
        self.assertIn("parameter /made/robot_description: ", said)
        self.assertIn("mimic on a fixed joint has no effect", said)
        self.assertIn("parameter /made/robot_description_semantic: 'zz' is not a link of the robot", said)
        self.assertNotIn("'b' is not a link", said)
        words = "parameter /made/node/%s is not a parameter of this node"
        for name, meant in misspelt.items():
            self.assertIn(words % name + "; did you mean '%s'?" % meant, said)
        self.assertIn(words % "ratio" + "\n", said.replace("\x1b[0m", ""))

    def test_descriptions_may_be_parameters_of_the_node_itself(self):
        world = "<robot name='world'>" + link("post", BOX) + "</robot>"
        node = self.start_node("own", robot_description=file_of("sliding_boxes.urdf"), robot_description_semantic="<robot name='r'/>",
                          environment_description=world)
        node.wait_for("4 links with geometry to check")
        node.wait_for("left out, no usable transform")
        self.assertNotIn("is not a parameter", node.said())

    RULES = {"alarm_distance": ("-1", "a number from 0.000000 to 1000000.000000", "0.05"),
             "tolerance": ("-1", "a number from 0.000000 to 1000000.000000", "0"),
             "time_budget": ("-1", "a number from 0.000000 to 1000000.000000", "0"),
             "rate": ("0.01", "a number from 0.100000 to 10000.000000", "50"),
             "max_pose_age": ("-1", "a number from 0.000000 to 1000000000.000000", "1"),
             "max_transform_age": ("-1", "a number from 0.000000 to 1000000000.000000", "1"),
             "clock_tolerance": ("-1", "a number from 0.000000 to 1000000000.000000", "0.5"),
             "verdict_only": ("5", "true or false", "false"),
             "min_distance": ("5", "true or false", "false"),
             "allow_paused": ("5", "true or false", "false"),
             "show_only_investigated_boxes": ("5", "true or false", "false"),
             "fixed_frame": ("5", "text", ""),
             "reload": ("sometimes", "manual or auto", "manual"),
             "trigger": ("bell", "rate or tf", "rate"),
             "fidelity": ("exact", "aabb, spheres, obb, convex or mesh", "mesh")}

    def test_each_parameter_that_cannot_be_used_is_named_with_its_rule_and_the_default_in_its_place(self):
        given = {}
        for name, (value, _, _) in self.RULES.items():
            given[name] = float(value) if value.strip("-.0123456789") == "" else value
        node = self.start_node("refused", file_of("sliding_boxes.urdf"), **given)
        node.wait_for("left out, no usable transform")
        lines = node.said().split("\n")
        for name, (value, rule, default) in self.RULES.items():
            [line] = [line for line in lines if "parameter /refused/node/%s is " % name in line]
            self.assertIn(value, line)
            self.assertNotIn("<value>", line)
            self.assertIn(", but must be %s; using %s" % (rule, default), line)
            if isinstance(given[name], float):
                in_words = {"": 0.0, "false": 0.0}
                self.assertEqual(float(rospy.get_param("/refused/node/" + name) or 0),
                                 float(in_words.get(default, default)), name)
            else:
                self.assertEqual(rospy.get_param("/refused/node/" + name), default)

    def test_the_smallest_and_the_largest_numbers_of_a_range_are_in_it(self):
        numbers = [name for name, (_, rule, _) in self.RULES.items() if "number" in rule]
        for ns, which, words in (("least", 3, {"reload": "manual", "trigger": "rate"}),
                                 ("most", 5, {"reload": "auto", "trigger": "tf"})):
            given = {name: float(self.RULES[name][1].split()[which]) for name in numbers}
            node = self.start_node(ns, BARE, **words, **given)
            node.wait_for("the robot has no collision geometry")
            self.assertNotIn("must be", node.said())
            for name, value in given.items():
                self.assertEqual(rospy.get_param("/%s/node/%s" % (ns, name)), value)

    def test_a_robot_that_leaves_nothing_to_check(self):
        words = "the robot has no collision geometry: the verdict "
        self.start_node("bare", BARE).wait_for(words + "is never FREE unless ~allow_empty_scene permits it")
        self.assertEqual(self.service("bare", "reset", Trigger)().message,
                         "the robot was reloaded; the robot has no collision geometry")
        self.start_node("allowed", BARE, allow_empty_scene=True).wait_for(words + "can be FREE because of ~allow_empty_scene")
        status = diagnosis_of("allowed/node")
        while status.level == DiagnosticStatus.ERROR:  # until the first cycle
            status = diagnosis_of("allowed/node")
        self.assertEqual({v.key: v.value for v in status.values}["transform age [s]"], "0", "nothing is asked of TF")

    def test_a_description_that_is_missing_is_said_once(self):
        node = self.start_node("nobody", robots=[{"description": "nowhere"}])
        words = "there is no parameter nowhere; load the robot's URDF into it, for example with <param name=\"nowhere\" textfile="
        node.wait_for(words)
        rospy.sleep(2.5)  # it is looked for each 2 s
        rospy.set_param("/nobody/nowhere", "<robot")
        node.wait_for("parameter /nobody/nowhere: ")
        self.assertEqual(node.said().count(words), 1)

    def test_a_warning_beside_an_error_is_said_once_too(self):
        words = "alarm_distanc is not a parameter of this node; did you mean 'alarm_distance'?"
        node = self.start_node("beside", file_of("sliding_boxes.urdf"), alarm_distanc=0.1, ignored_links=["nobody"])
        node.wait_for("ignored_links names 'nobody'")
        rospy.sleep(2.5)  # it is tried each 2 s
        rospy.set_param("/beside/node/ignored_links", ["a"])
        node.wait_for("ready after")
        self.assertEqual(node.said().count(words), 1)

    def test_a_link_that_cannot_be_read_is_said_once_a_robot(self):
        node = self.start_node("broken", file_of("broken_mesh.urdf"))
        words = "link 'broken' is left out: "
        node.wait_for(words)
        node.wait_for("ready after")
        check = self.service("broken", "check_collisions", CheckCollisions)
        self.assertTrue(check(joint_state=JointState(), links=["broken"]).success)  # builds a scene of its own
        self.assertEqual(node.said().count(words), 1)
        self.assertTrue(self.service("broken", "reset", Trigger)().success)
        node.wait_for("no_such_mesh.stl")
        self.assertEqual(node.said().count(words), 2)

    def test_descriptions_that_have_changed_are_said_once_and_a_cloud_that_is_refused_every_five_seconds(self):
        boxes = file_of("sliding_boxes.urdf")
        cloud = self.start_node("cloud", boxes, clouds=[{"topic": "/cloud/points"}])
        camera = CloudPublisher("/cloud/points", "root")
        camera.points = [(1.0, 2.0, 3.0)]

        def without_z(message):
            del message.fields[2]
        camera.spoil = without_z
        cloud.wait_for("cloud 'cloud/points': a message was refused: ")
        cloud.wait_for("no field 'z'")
        try:
            self.expect_changes_to_be_said_once(boxes)
            wait_until(lambda: cloud.said().count("a message was refused") > 1, "the second time")
            first, second = re.findall(r"\[(\d+\.\d+)\]: cloud 'cloud/points': a message was refused", cloud.said())[:2]
            self.assertGreater(float(second) - float(first), 4.9)
        finally:
            camera.stop()

    def expect_changes_to_be_said_once(self, boxes):
        srdf = "<robot name='sliding_boxes'><disable_collisions link1='a' link2='%s'/></robot>"
        nodes = [self.start_node("manual", boxes, srdf % "b"), self.start_node("auto", boxes, srdf % "b", reload="auto")]
        for node in nodes:
            node.wait_for("ready after")
        for ns in ("manual", "auto"):
            rospy.set_param("/%s/robot_description" % ns, boxes.replace("1 1 1", "2 1 1"))
            rospy.set_param("/%s/robot_description_semantic" % ns, srdf % "c")
        both = "/%s/robot_description, /%s/robot_description_semantic"
        changed = both % ("manual", "manual") + " have changed since the robot was loaded: the old one is checked until ~reset is called"
        nodes[1].wait_for(both % ("auto", "auto") + " changed: the robot was reloaded")
        nodes[0].wait_for(changed)
        rospy.sleep(3.2)  # they look every 3 s
        self.assertNotIn("until ~reset is called", nodes[1].said())
        self.assertEqual((nodes[0].said().count(changed), nodes[1].said().count("was reloaded")), (1, 1))

    def test_a_reconfiguration_that_is_refused_names_the_value_and_the_reply_has_what_stays(self):
        stays = {"alarm_distance": 0.25, "rate": 40.0, "tolerance": 0.125, "time_budget": 0.5, "fidelity": "obb"}
        flags = {"verdict_only": True, "min_distance": True, "show_only_investigated_boxes": True}
        node = self.start_node("set", BARE, **stays, **flags)
        change = self.service("set", "set_parameters", Reconfigure)
        for name in ("alarm_distance", "rate", "tolerance", "time_budget", "fidelity"):
            wrong = Config()
            wrong.doubles = [DoubleParameter(key, float("nan") if key == name else 1.0)
                             for key in stays if key != "fidelity"]
            wrong.strs = [StrParameter("fidelity", "exact" if name == "fidelity" else "mesh")]
            config = change(wrong).config
            node.wait_for("reconfigure: " + (name + " is not finite" if name != "fidelity" else "unknown fidelity 'exact'"))
            found = {p.name: p.value for kind in (config.doubles, config.strs, config.bools) for p in kind}
            self.assertEqual(found, dict(stays, **flags), name)
        self.assertEqual(node.said().count("; nothing is changed"), 5)

    def test_a_limiter_has_counted_nothing_at_first(self):
        first = []
        subscriber = rospy.Subscriber("/diagnostics", DiagnosticArray, lambda array: first.extend(
            status for status in array.status
            if status.name == "counts/node: velocity limiter" and status.message != "Node starting up"))  # of diagnostic_updater
        self.start_node("counts", BARE, velocity_limiter={"command": "/jog", "joints": ["a"], "deceleration": 1.0})
        wait_until(lambda: first, "a diagnosis")
        subscriber.unregister()
        self.assertEqual((first[0].level, first[0].message), (DiagnosticStatus.OK, "no commands on /jog"))
        values = {pair.key: pair.value for pair in first[0].values}
        self.assertRegex(values.pop("real-time scheduling"), "^(yes|not asked for yet|no real-time .*limits.conf.* rtprio .*)$")
        self.assertEqual(values,
                         {"commands": "0", "overruns": "0", "longest decision [s]": "0", "scale": "0", "reason": "no command yet"})

    def test_a_limiter_that_cannot_be_had(self):
        node = self.start_node("wrong", BARE, velocity_limiter={"joints": ["a"]})
        node.wait_for("nothing is limited, and no command is passed: velocity_limiter has no command: the topic to limit")
        status = diagnosis_of("wrong/node: velocity limiter")
        self.assertEqual(status.level, DiagnosticStatus.ERROR)
        self.assertIn("velocity_limiter has no command", status.message)


if __name__ == "__main__":
    rospy.init_node("test_log")
    rostest.rosrun("collision_pairs", "log", LogTest)
