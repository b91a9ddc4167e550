"""The launch files say the same of the node, whichever of them is started."""
import glob
import os
import xml.etree.ElementTree as ElementTree

import pytest
import rosbag
import rospy
from collision_pairs.msg import Scene, SceneObject
from conftest import PROJECT
from std_msgs.msg import String

roslaunch = pytest.importorskip("roslaunch.config")
RLException = pytest.importorskip("roslaunch").RLException

LAUNCH = os.path.join(PROJECT, "launch")
ARGUMENTS = {"limiter.launch": ["limiter:=%s/config/demo/node_limit.yaml" % PROJECT],
             "replay.launch": ["%s:=%s/config/demo/%s" % (argument, PROJECT, name)
                               for argument, name in (("bag", "demo.bag"), ("urdf", "demo_robot.urdf"))]}
NAMES = sorted(map(os.path.basename, glob.glob(LAUNCH + "/*.launch")))


def loaded(name, *arguments):
    """As roslaunch reads it."""
    return roslaunch.load_config_default([(os.path.join(LAUNCH, name), ARGUMENTS.get(name, []) + list(arguments))], None,
                                         verbose=False, assign_machines=False)


def tags(name, kind):
    return list(ElementTree.parse(os.path.join(LAUNCH, name)).iter(kind))


# What an argument cannot change: rviz and print_collision_pairs know the node by its default name, and the demo is its robot's.
FIXED = {"demo.launch": {"name", "urdf", "srdf"}, "replay.launch": {"name"}}


@pytest.mark.parametrize("name", sorted(set(NAMES) - {"collision_pairs.launch"}))
def test_each_argument_of_the_node_is_one_of_the_files_that_include_it(name):
    """roslaunch ignores an argument that a file does not declare, and a file that is included gets what is passed on."""
    node = {argument.get("name") for argument in tags("collision_pairs.launch", "arg")}
    declared = {argument.get("name") for argument in ElementTree.parse(os.path.join(LAUNCH, name)).getroot().findall("arg")}
    [include] = tags(name, "include")
    assert include.get("file").endswith("/collision_pairs.launch")
    passed = {argument.get("name"): argument.get("value") for argument in include.findall("arg")}
    given = FIXED.get(name, set())
    assert node - given <= declared
    assert {key: passed.get(key) for key in node - given} == {key: "$(arg %s)" % key for key in node - given}


@pytest.mark.parametrize("name", NAMES)
def test_an_environment_is_loaded_by_each_of_them(name):
    cell = os.path.join(PROJECT, "test/ros/cell.urdf")
    with open(cell, encoding="utf-8") as text:
        assert loaded(name, "environment:=" + cell).params["/environment_description"].value == text.read()


@pytest.mark.parametrize("name", NAMES)
def test_required_takes_the_place_of_respawn(name):
    def ends(*arguments):
        return [(node.required, node.respawn) for node in loaded(name, *arguments).nodes if node.type == "collision_pairs_node"]
    assert (ends(), ends("required:=true"), ends("respawn:=false")) == ([(False, True)], [(True, False)], [(False, False)])


def test_a_bag_is_found_from_the_folder_where_roslaunch_is_called(monkeypatch):
    """roslaunch starts programs elsewhere, in ROS_HOME."""
    folder = os.path.join(PROJECT, "config/demo")
    monkeypatch.chdir(folder)
    monkeypatch.setenv("PWD", folder)
    for bag in ("demo.bag", os.path.join(folder, "demo.bag")):
        nodes = {node.name: node for node in loaded("replay.launch", "bag:=" + bag).nodes}
        assert "'%s'" % bag in nodes["replay_bag"].args
        assert nodes["replay_bag"].launch_prefix == "env -C '%s'" % folder
        assert nodes["replay_bag"].required


def replayed(tmp_path, messages, *arguments):
    """The parameters that replay.launch sets for a bag with these (topic, message)."""
    path = tmp_path / "some.bag"
    with rosbag.Bag(str(path), "w") as bag:
        for topic, message in messages:
            bag.write(topic, message, rospy.Time(10))
    config = roslaunch.load_config_default([(os.path.join(LAUNCH, "replay.launch"), ["bag:=%s" % path, *arguments])], None,
                                           verbose=False, assign_machines=False)
    return {name: parameter.value for name, parameter in config.params.items()}


def test_a_replay_takes_the_robot_as_check_bag_does_and_leaves_nothing_of_an_earlier_one(tmp_path):
    urdf, srdf = String(data="<robot name='r'><link name='a'/></robot>"), String(data="<robot name='r'/>")
    semantic = "/robot_description_semantic"
    found = replayed(tmp_path, [("/robot_description", urdf)])
    assert found["/robot_description"] == urdf.data and found[semantic] == ""
    assert replayed(tmp_path, [("/robot_description", urdf), (semantic, srdf)])[semantic] == srdf.data
    assert replayed(tmp_path, [("/left/robot_description", urdf), (semantic, srdf)])[semantic] == "", "of another robot"
    given = tmp_path / "given.urdf"
    given.write_text(urdf.data)
    own = "/collision_pairs_node/robot_description_semantic"  # found before the other
    assert replayed(tmp_path, [(semantic, srdf)], "urdf:=%s" % given)[own] == "", "of another robot"
    assert replayed(tmp_path, [(semantic, srdf)], "urdf:=%s" % given, "srdf:=%s" % given)[semantic] == urdf.data
    with pytest.raises(RLException):
        replayed(tmp_path, [("/left/robot_description", urdf), ("/right/robot_description", urdf)])


def test_with_a_urdf_alone_an_srdf_of_an_earlier_launch_is_not_found(tmp_path):
    given = tmp_path / "given.urdf"
    given.write_text("<robot name='r'><link name='a'/></robot>")
    for arguments, expected in (([], None), (["urdf:=%s" % given], ""), (["urdf:=%s" % given, "srdf:=%s" % given], None)):
        own = loaded("collision_pairs.launch", *arguments).params.get("/collision_pairs_node/robot_description_semantic")
        assert (own and own.value) == expected


def test_where_the_recorded_node_had_objects_the_one_of_a_replay_knows_that_it_lacks_them(tmp_path):
    urdf = ("/robot_description", String(data="<robot name='r'><link name='a'/></robot>"))
    for scenes, expected in (([], False), ([Scene()], False), ([Scene(), Scene(objects=[SceneObject(name="box")])], True),
                             ([Scene(objects_are_lost=True)], True)):
        found = replayed(tmp_path, [urdf] + [("/node/scene", scene) for scene in scenes])
        assert found["/collision_pairs_node/has_objects"] is expected


@pytest.mark.parametrize("name", NAMES)
def test_no_parameter_of_an_earlier_launch_stays(name):
    config = loaded(name)
    ours = [node.namespace + node.name + "/" for node in config.nodes
            if node.type in ("collision_pairs_node", "limited_command_guard")]
    assert ours and set(ours) <= set(config.clear_params)
