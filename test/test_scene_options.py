"""What the tools take of a scene: settings as the node's, a group, links."""
import csv
import io
import os

import pytest
from conftest import PROJECT, SRDF, URDF

SHIPPED = os.path.join(PROJECT, "config/collision_pairs_node.yaml")


@pytest.fixture
def check(run_tool, states, tmp_path):
    """Runs check_states with these options and this YAML; the process, and a dictionary a state."""
    def run(*options, settings=None):
        if settings is not None:
            path = tmp_path / "settings.yaml"
            path.write_text(settings)
            options += ("--settings", path)
        done = run_tool("check_states", URDF, "--srdf", SRDF, "--states", states, "--min-distance", *options)
        lines = [line.split(",") for line in done.stdout.splitlines()]
        return done, [dict(zip(lines[0], line)) for line in lines[1:]] if lines else []
    return run


def pairs(row):
    return set(filter(None, row["pairs"].split(";")))


def test_the_nodes_own_file_changes_nothing(check):
    plain = check()[1]
    shipped = check("--settings", SHIPPED)[1]
    assert [(row["pairs"], row["min_distance"]) for row in plain] == \
        [(row["pairs"], row["min_distance"]) for row in shipped]


def test_settings_that_only_the_node_follows_are_named_in_a_warning(check, tmp_path):
    cloud = "clouds: [{topic: camera/points, voxel_size: 0.02}]\n"
    robots = "robots: [{description: other, prefix: other}]\n"
    floor = "floor: {height: -1.0}\nfixed_frame: map\n"
    warned = "ignored, so a state may be free only without them: "
    assert warned + "robots, fixed_frame, cloud 'camera/points'" in check(settings=cloud + robots + floor)[0].stderr
    assert warned not in check("--settings", SHIPPED)[0].stderr
    assert warned not in check(settings="fixed_frame: map\nrobots: []")[0].stderr
    world = tmp_path / "world.urdf"
    world.write_text("<robot name='w'><link name='far'><collision><origin xyz='90 0 0'/><geometry><sphere radius='1'/></geometry>"
                     "</collision></link></robot>")
    assert warned + "fixed_frame" in check("--world", world, settings="fixed_frame: map")[0].stderr


EMPTY = {"there is no pair to check": "ignored_links: ['*']\n",
         "group and links leave no pair to check": "links: ['nothing_*']\n"}
BARE = "<robot name='bare'><link name='a'/><link name='b'/><joint name='j' type='revolute'><parent link='a'/>" \
       "<child link='b'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint></robot>"


@pytest.mark.parametrize("allowed", [False, True])
@pytest.mark.parametrize("words", list(EMPTY) + ["the robot has no collision geometry"])
def test_a_scene_without_pairs_is_free_nowhere_unless_that_is_allowed(run_tool, make_bag, tmp_path, words, allowed):
    settings, states, box = tmp_path / "settings.yaml", tmp_path / "states.csv", tmp_path / "box.urdf"
    settings.write_text(EMPTY.get(words, "") + "allow_empty_scene: %s" % str(allowed).lower())
    box.write_text("<robot name='box'><link name='around'><collision><geometry><box size='9 9 9'/></geometry></collision></link></robot>")
    robot, states_of = URDF, "shoulder_lift\n0\n0.1\n"
    if words not in EMPTY:
        robot, states_of = tmp_path / "bare.urdf", "j\n0\n0.1\n"
        robot.write_text(BARE)
    states.write_text(states_of)
    extra = () if words in EMPTY else ("--world", box)

    def rows_of(*command):
        done = run_tool(*command, *extra, "--settings", settings)
        assert done.returncode == 0 and words + ": " in done.stderr, done.stderr
        return list(csv.DictReader(io.StringIO(done.stdout)))
    for option in ([], ["--verdict-only"], ["--min-distance"], ["--time-budget", "1e6"]):
        assert [row["in_collision"] for row in rows_of("check_states", robot, "--states", states, *option)] == \
            ["0" if allowed else "1"] * 2
    assert [(row["verdict"], row["clearance"]) for row in rows_of("check_motion", robot, "--waypoints", states)] == \
        [("free" if allowed else "unresolved", "")]
    if words in EMPTY:  # no pose is asked of the bag, so there is no stamp to report
        done = run_tool("check_bag", make_bag("demo.bag"), "--settings", settings)
        assert done.returncode == 2 and words + ": " in done.stderr and len(done.stdout.splitlines()) == 1


def test_of_a_robot_without_geometry_generate_srdf_says_so(run_tool, tmp_path):
    robot = tmp_path / "bare.urdf"
    robot.write_text(BARE)
    done = run_tool("generate_srdf", robot)
    assert done.returncode == 0 and "the robot has no collision geometry: no pair is counted" in done.stderr


FIXED = '''<robot name="fixed"><link name="a"><collision><geometry><box size="1 1 1"/></geometry></collision></link>
<link name="m"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
<link name="b"><collision><geometry><box size="1 1 1"/></geometry></collision></link>
<joint name="am" type="fixed"><parent link="a"/><child link="m"/><origin xyz="0.7 0 0"/></joint>
<joint name="mb" type="fixed"><parent link="m"/><child link="b"/><origin xyz="%s 0 0"/></joint></robot>'''


def columns_of(done, name):
    assert done.returncode == 0, done.stderr
    return [row[name] for row in csv.DictReader(io.StringIO(done.stdout))]


@pytest.mark.parametrize("x, touches", [(2.0, False), (0.2, True)])
def test_a_robot_whose_joints_are_all_fixed_can_be_checked(run_tool, tmp_path, x, touches):
    robot, blank = tmp_path / "fixed.urdf", tmp_path / "blank.csv"
    robot.write_text(FIXED % x)
    blank.write_text("\n\n\n")  # a header without names, and two states
    assert columns_of(run_tool("check_states", robot, "--states", blank), "in_collision") == [str(int(touches))] * 2
    assert columns_of(run_tool("check_motion", robot, "--waypoints", blank), "verdict") == ["collision" if touches else "free"]
    blank.write_text("")
    done = run_tool("check_states", robot, "--states", blank)
    assert done.returncode == 2 and "no header" in done.stderr


def test_a_scene_with_pairs_is_not_warned_of(check):
    assert "no pair" not in check()[0].stderr


def test_padding_is_taken_from_the_distance(check):
    free = float(check()[1][0]["min_distance"])
    for padding in (0.25 * free, free):
        row = check(settings="padding: %.17g" % padding)[1][0]
        assert float(row["min_distance"]) == pytest.approx(free - 2 * padding, abs=1e-9)
        assert row["in_collision"] == ("1" if 2 * padding > free else "0")


def test_rules_floor_and_ignored_links_change_the_pairs(check):
    before = pairs(check()[1][1])
    assert "arch|wrist_ball" in before
    assert "arch|wrist_ball" not in pairs(check(settings="pair_rules: [{deny: [arch, 'wrist*']}]")[1][1])
    assert not any("arch" in pair for pair in pairs(check(settings="ignored_links: [arch]")[1][1]))
    floor = pairs(check(settings="floor: {height: 1.0, touch_links: [table, post]}")[1][1])
    assert {"arm_base|floor", "crate|floor"} & floor and "floor|table" not in floor


def test_either_broad_phase_finds_the_same_pairs(check):
    auto, sweep = (check("--alarm-distance", 0.1, "--broad-phase", name)[1] for name in ("auto", "sweep"))
    for one, other in zip(auto, sweep):
        assert int(one["nb_pairs"]) > 0 and dict(one, microseconds="") == dict(other, microseconds="")


def test_an_unknown_broad_phase_is_refused(run_tool, tmp_path):
    done = run_tool("check_states", "none.urdf", "--states", "none.csv", "--broad-phase", "grid")
    assert done.returncode == 2 and "unknown broad phase 'grid'; known are auto and sweep" in done.stderr


def test_the_mesh_of_a_link_that_is_ignored_is_not_read(run_tool, tmp_path):
    urdf = tmp_path / "robot.urdf"
    ball = "<link name='%s'><collision><geometry><sphere radius='0.1'/></geometry></collision></link>"
    urdf.write_text("<robot name='r'>" + ball % "a" + ball % "b" +
                    "<link name='c'><collision><geometry><mesh filename='none.stl'/></geometry></collision></link>"
                    "<joint name='x' type='prismatic'><parent link='c'/><child link='b'/><axis xyz='1 0 0'/>"
                    "<limit lower='-1' upper='1' effort='1' velocity='1'/></joint>"
                    "<joint name='f' type='fixed'><parent link='c'/><child link='a'/></joint></robot>")
    states, settings = tmp_path / "states.csv", tmp_path / "settings.yaml"
    states.write_text("x\n0\n1\n")
    done = run_tool("check_states", urdf, "--states", states)
    assert done.returncode == 2 and "there is no file %s" % (tmp_path / "none.stl") in done.stderr
    settings.write_text("ignored_links: [c]\n")
    done = run_tool("check_states", urdf, "--states", states, "--settings", settings)
    assert done.returncode == 0, done.stderr
    assert [line.split(",")[1] for line in done.stdout.splitlines()[1:]] == ["1", "0"]


def test_fcl_by_option_or_by_setting_gives_the_same_pairs_and_distances(check):
    native = check()[1]
    for done, rows in (check("--narrow-phase", "fcl"), check(settings="narrow_phase: fcl")):
        assert "answered natively" in done.stderr  # the depth of the contact
        for row, expected in zip(rows, native):
            assert pairs(row) == pairs(expected)
            assert float(row["min_distance"]) == pytest.approx(float(expected["min_distance"]), abs=1e-6)
    done, _ = check("--narrow-phase", "native", settings="narrow_phase: fcl")
    assert "answered natively" not in done.stderr


def test_links_and_patterns_restrict_the_pairs(check):
    of_wrist = {pair for pair in pairs(check()[1][1]) if "wrist_ball" in pair.split("|")}
    assert of_wrist
    assert pairs(check("--links", "wrist_ball")[1][1]) == of_wrist
    assert pairs(check("--links", "wrist_[b]*", "nothing_*")[1][1]) == of_wrist


@pytest.mark.parametrize("options, settings, says", [
    ((), "padding: -1", "padding is -1"), ((), "pading: 1", "'padding'?"),
    ((), "pair_rules: [{deny: [arhc, table]}]", "'arch'?"), ((), "[", "settings.yaml"),
    (("--links", "wrist_bal"), None, "'wrist_ball'?"), (("--links", "none_*"), None, "no pair to check"),
    (("--narrow-phase", "bullet"), None, "known are native and fcl"), ((), "narrow_phase: 3", "native or fcl"),
    (("--group", "arm"), None, "no group 'arm'"), (("--settings", "nowhere.yaml"), None, "nowhere.yaml"),
])
def test_what_is_wrong_is_one_line_and_exit_code_2(check, options, settings, says):
    done, rows = check(*options, settings=settings)
    assert done.returncode == 2 and rows == []
    assert says in done.stderr and len(done.stderr.splitlines()) == 1


def test_bags_take_the_same(run_tool, make_bag, tmp_path):
    bag = make_bag("demo.bag")
    settings = tmp_path / "settings.yaml"
    settings.write_text("ignored_links: [arch]")
    whole = run_tool("check_bag", bag).stdout
    without = run_tool("check_bag", bag, "--settings", settings).stdout
    linked = run_tool("check_bag", bag, "--links", "arch").stdout
    assert "arch|" in whole and "ball|left_finger" in whole
    assert "arch|" not in without and "ball|left_finger" in without
    assert "arch|" in linked and "ball|left_finger" not in linked
