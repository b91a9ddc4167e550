"""The launch files say the same of the node, whichever of them is started."""
import glob
import os
import xml.etree.ElementTree as ElementTree

import pytest
from conftest import PROJECT

roslaunch = pytest.importorskip("roslaunch.config")

LAUNCH = os.path.join(PROJECT, "launch")
ARGUMENTS = {"limiter.launch": ["limiter:=%s/config/demo/node_limit.yaml" % PROJECT],
             "replay.launch": ["bag:=%s/config/demo/demo.bag" % PROJECT]}
NAMES = sorted(map(os.path.basename, glob.glob(LAUNCH + "/*.launch")))


def loaded(name, *arguments):
    """As roslaunch reads it."""
    return roslaunch.load_config_default([(os.path.join(LAUNCH, name), ARGUMENTS.get(name, []) + list(arguments))], None,
                                         verbose=False, assign_machines=False)


def tags(name, kind):
    return list(ElementTree.parse(os.path.join(LAUNCH, name)).iter(kind))


@pytest.mark.parametrize("name", NAMES)
def test_no_parameter_of_an_earlier_launch_stays(name):
    config = loaded(name)
    ours = [node.namespace + node.name + "/" for node in config.nodes
            if node.type in ("collision_pairs_node", "limited_command_guard")]
    assert ours and set(ours) <= set(config.clear_params)
