"""check_states as a user meets it: what it prints, what it refuses, what it leaves behind."""
import random

import pytest
from conftest import SRDF, URDF, rows_of, sliding_boxes
from seed import given_seed

HEADER = ["state", "in_collision", "pairs", "min_distance", "nb_pairs", "microseconds"]


def test_verdicts_pairs_and_distance_are_written(run_tool, states, tmp_path):
    out = tmp_path / "out.csv"
    done = run_tool("check_states", URDF, "--srdf", SRDF, "--states", states, "--out", out,
                    "--min-distance")
    assert done.returncode == 0, done.stderr
    rows = rows_of(out)
    assert list(rows[0]) == HEADER
    assert [row["in_collision"] for row in rows] == ["0", "1"]
    assert rows[0]["pairs"] == "" and float(rows[0]["min_distance"]) > 0
    assert "arch|wrist_ball" in rows[1]["pairs"].split(";")
    assert float(rows[1]["min_distance"]) < 0
    assert "gripper" in done.stderr and "free only with them at zero" in done.stderr


def test_many_states_have_the_verdicts_of_each(run_tool, tmp_path):
    path, count = tmp_path / "states.csv", 40000  # so many that the batch stage is in use
    draw = random.Random(given_seed())
    path.write_text("shoulder_pan,shoulder_lift,elbow_flex,wrist_flex,wrist_roll\n" + "".join(
        ",".join("%.6f" % draw.uniform(-1.5, 1.5) for _ in range(5)) + "\n" for _ in range(count)))
    arguments = ("check_states", URDF, "--srdf", SRDF, "--states", path)
    out = [tmp_path / name for name in ("verdicts.csv", "checks.csv", "on_threads.csv", "few.csv")]
    assert run_tool(*arguments, "--verdict-only", "--threads", 1, "--out", out[0]).returncode == 0
    assert run_tool(*arguments, "--out", out[1]).returncode == 0
    verdicts, checks = rows_of(out[0]), rows_of(out[1])
    assert [row["in_collision"] for row in verdicts] == [row["in_collision"] for row in checks]
    assert {row["in_collision"] for row in verdicts} == {"0", "1"}
    for verdict, check in zip(verdicts, checks):
        assert (verdict["pairs"] or None) in check["pairs"].split(";") + [None]
        assert bool(verdict["pairs"]) == bool(check["pairs"])
    assert run_tool(*arguments, "--verdict-only", "--threads", 3, "--out", out[2]).returncode == 0
    listed = [row["pairs"] for row in verdicts]
    assert [row["pairs"] for row in rows_of(out[2])] == listed
    few = 10000
    path.write_text("".join(path.read_text().splitlines(keepends=True)[:few + 1]))
    assert run_tool(*arguments, "--verdict-only", "--out", out[3]).returncode == 0
    one_by_one = [row["pairs"] for row in rows_of(out[3])]
    assert one_by_one != listed[:few], "of several contacts the stage finds another first, or it was not in use"


def test_positions_outside_the_limits_are_said_once_a_joint(run_tool, tmp_path):
    path = tmp_path / "states.csv"
    path.write_text("shoulder_pan,elbow_flex\n0,1.2\n60,1.2\n90,1.2\n")
    done = run_tool("check_states", URDF, "--srdf", SRDF, "--states", path)
    assert done.returncode == 0 and len(done.stdout.splitlines()) == 4
    said = [line for line in done.stderr.splitlines() if "outside its limits" in line]
    assert len(said) == 1 and "'shoulder_pan'" in said[0] and "at 2 states; the first is state 1, where it is 60" in said[0]


def test_a_tolerance_makes_distances_smaller_by_no_more_than_it(run_tool, states):
    def rows(*options):
        done = run_tool("check_states", URDF, "--srdf", SRDF, "--states", states, "--min-distance", *options)
        return [line.split(",") for line in done.stdout.splitlines()[1:]]
    for exact, tolerant in zip(rows(), rows("--tolerance", "0.01")):
        assert tolerant[:3] == exact[:3]
        assert float(exact[3]) - 0.01 <= float(tolerant[3]) <= float(exact[3])


def test_without_srdf_neighbours_are_not_checked(run_tool, states):
    done = run_tool("check_states", URDF, "--states", states)
    assert done.returncode == 0
    assert "arm_base|shoulder" not in done.stdout


@pytest.mark.parametrize("fidelity", ["aabb", "spheres", "obb", "convex", "mesh"])
def test_a_cheaper_rung_misses_no_contact(run_tool, states, fidelity):
    exact = run_tool("check_states", URDF, "--srdf", SRDF, "--states", states).stdout.splitlines()
    rung = run_tool("check_states", URDF, "--srdf", SRDF, "--states", states, "--fidelity",
                    fidelity).stdout.splitlines()
    for line, cheap in zip(exact[1:], rung[1:]):
        assert set(filter(None, line.split(",")[2].split(";"))) <= set(cheap.split(",")[2].split(";"))


def test_a_world_stands_at_the_robots_root(run_tool, states, tmp_path):
    world = tmp_path / "world.urdf"
    world.write_text("<robot name='w'><link name='wall'><collision><origin xyz='0 0 1.4'/><geometry>"
                     "<box size='9 9 0.1'/></geometry></collision></link></robot>")
    done = run_tool("check_states", URDF, "--srdf", SRDF, "--states", states, "--world", world,
                    "--min-distance")
    assert "upper_arm|wall" in done.stdout or "forearm|wall" in done.stdout or "elbow|wall" in done.stdout
    clash = tmp_path / "clash.urdf"
    clash.write_text(world.read_text().replace("'wall'", "'table'"))
    done = run_tool("check_states", URDF, "--states", states, "--world", clash)
    assert done.returncode == 2 and "table" in done.stderr


def test_a_world_of_which_nobody_knows_a_position_is_refused(run_tool, states, tmp_path):
    world = tmp_path / "world.urdf"
    world.write_text("<robot name='w'><link name='o'/><link name='p'><collision><geometry><sphere radius='1'/></geometry></collision>"
                     "</link><joint name='j' type='continuous'><parent link='o'/><child link='p'/><mimic joint='none'/></joint></robot>")
    done = run_tool("check_states", URDF, "--srdf", SRDF, "--states", states, "--world", world)
    assert done.returncode == 2 and "joint 'j' follows one that is not there" in done.stderr


def broken_inputs():
    box = "<collision><geometry><box size='1 1 1'/></geometry></collision>"
    mesh = "<robot name='r'><link name='a'><collision><geometry><mesh filename='%s'/></geometry></collision></link></robot>"
    return {
        "urdf_empty": ("urdf", b"", "empty"),
        "urdf_not_xml": ("urdf", b"\x00\xff\xfe garbage", "zero byte"),
        "urdf_truncated": ("urdf", open(URDF, "rb").read()[:2000], "not well-formed"),
        "urdf_deep": ("urdf", b"<robot name='r'>" + b"<a>" * 200000, "nested too deeply"),
        "urdf_two_roots": ("urdf", b"<robot name='r'><link name='a'/><link name='b'/></robot>", "Two root links found"),
        "urdf_negative": ("urdf", ("<robot name='r'><link name='a'>%s</link></robot>" % box.replace("1 1 1", "1 -1 1")).encode(), "0 or more"),
        "urdf_no_mesh": ("urdf", (mesh % "package://collision_pairs/none.stl").encode(), "none.stl"),
        "urdf_no_package": ("urdf", (mesh % "package://no_such_package/x.stl").encode(), "no_such_package"),
        "urdf_mesh_is_text": ("urdf", (mesh % ("file://" + URDF)).encode(), "demo_robot.urdf"),
        "srdf_truncated": ("srdf", b"<robot name='r'><disable_collisions", "SRDF line 1"),
        "srdf_half_a_pair": ("srdf", b"<robot name='r'><disable_collisions link1='a'/></robot>", "link2"),
        "states_unknown": ("states", b"elbow_joint\n1\n", "elbow_joint"),
        "states_fixed": ("states", b"table_joint\n1\n", "table_joint"),
        "states_text": ("states", b"shoulder_pan\nfast\n", "fast"),
        "states_nan": ("states", b"shoulder_pan\nnan\n", "nan"),
        "states_short": ("states", b"shoulder_pan,elbow_flex\n1\n", "line 2"),
        "states_late": ("states", b"shoulder_pan\n" + b"1\n" * 1000 + b"x\n", "line 1002"),
        "states_empty": ("states", b"", "no header"),
        "states_none": ("states", b"shoulder_pan\n", "it has no states"),
        "world_broken": ("world", b"<robot name='w'><link/></robot>", "world"),
    }


@pytest.mark.parametrize("name", broken_inputs())
def test_wrong_input_is_one_line_and_exit_code_2(run_tool, states, tmp_path, name):
    which, content, says = broken_inputs()[name]
    path = tmp_path / ("bad_" + which)
    path.write_bytes(content)
    files = {"urdf": URDF, "srdf": SRDF, "states": states, "world": None, which: path}
    out = tmp_path / "out.csv"
    arguments = [files["urdf"], "--srdf", files["srdf"], "--states", files["states"], "--out", out]
    if files["world"]:
        arguments += ["--world", files["world"]]
    done = run_tool("check_states", *arguments)
    assert done.returncode == 2
    errors = [line for line in done.stderr.splitlines() if not line.startswith("warning: ")]
    assert len(errors) == 1 and says in errors[0] and "bad_" + which in errors[0], done.stderr
    assert not out.exists() and not list(tmp_path.glob("out*"))


@pytest.mark.parametrize("arguments, says", [
    (["--states", "none.csv"], "none.csv"), ([], "--states"), (["--states", "x", "--speed", "3"], "--speed"),
    (["--states", "x", "--fidelity", "exact"], "exact"), (["--states", "x", "--alarm-distance", "-1"], "alarm"),
    (["--states", "x", "--tolerance", "-1"], "tolerance"), (["--states", "x", "--tolerance", "nan"], "tolerance"),
    (["--states", "x", "--alarm-distance", "nan"], "alarm"), (["--states", "x", "--alarm-distance", "far"], "alarm"),
])
def test_wrong_options_are_one_line_and_exit_code_2(run_tool, arguments, says):
    done = run_tool("check_states", URDF, *arguments)
    assert done.returncode == 2 and says in done.stderr and len(done.stderr.splitlines()) == 1


def test_windows_line_ends_and_byte_order_marks_are_accepted(run_tool, states, tmp_path):
    plain = run_tool("check_states", URDF, "--srdf", SRDF, "--states", states).stdout
    windows = tmp_path / "windows.csv"
    windows.write_bytes(b"\xef\xbb\xbf" + states.read_bytes().replace(b"\n", b"\r\n") + b"\r\n\r\n")
    urdf = tmp_path / "bom.urdf"
    urdf.write_bytes(b"\xef\xbb\xbf" + open(URDF, "rb").read().replace(b"\n", b"\r\n"))
    srdf = tmp_path / "bom.srdf"
    srdf.write_bytes(b"\xef\xbb\xbf" + open(SRDF, "rb").read())
    done = run_tool("check_states", urdf, "--srdf", srdf, "--states", windows)
    assert done.returncode == 0, done.stderr
    strip = lambda text: [line.rsplit(",", 1)[0] for line in text.splitlines()]
    assert strip(done.stdout) == strip(plain)


def test_a_pipe_is_written_in_place(run_tool, states, tmp_path):
    pipe = tmp_path / "pipe"  # which may be replaced: not the system's own
    pipe.symlink_to("/dev/stdout")
    done = run_tool("check_states", URDF, "--states", states, "--out", pipe)
    assert done.returncode == 0 and done.stdout.startswith("state,")
    assert pipe.is_symlink() and len(list(tmp_path.glob("pipe*"))) == 1


def test_a_state_without_time_is_in_collision_unless_its_boxes_are_apart(run_tool, states, tmp_path):
    out = tmp_path / "out.csv"
    done = run_tool("check_states", URDF, "--srdf", SRDF, "--states", states, "--out", out,
                    "--time-budget", "0.001", "--min-distance")
    assert done.returncode == 0, done.stderr
    hurried = rows_of(out)
    run_tool("check_states", URDF, "--srdf", SRDF, "--states", states, "--out", out)
    for fast, exact in zip(hurried, rows_of(out)):
        assert fast["in_collision"] >= exact["in_collision"]
        assert set(exact["pairs"].split(";")) - {""} <= set(fast["pairs"].split(";"))
        assert fast["min_distance"] == ""


@pytest.mark.parametrize("option, value", [("--time-budget", "-1"), ("--max-hull-vertices", "3")])
def test_a_trade_that_is_none_is_refused(run_tool, states, option, value):
    done = run_tool("check_states", URDF, "--states", states, option, value)
    assert done.returncode == 2
    assert option.strip("-").replace("-", "_") in done.stderr.replace("-", "_")


def write_pcd(path, points):
    lines = ["FIELDS x y z", "SIZE 4 4 4", "TYPE F F F", "POINTS %d" % len(points), "DATA ascii"]
    path.write_text("\n".join(lines + ["%r %r %r" % tuple(point) for point in points]) + "\n")
    return path


def write_world(path, cells, size):
    boxes = "".join("<collision><origin xyz='%r %r %r'/><geometry><box size='%r %r %r'/></geometry></collision>"
                    % (*[(k + 0.5) * size for k in cell], size, size, size) for cell in cells)
    path.write_text("<robot name='world'><link name='cloud'>%s</link></robot>" % boxes)
    return path


def test_a_cloud_is_the_same_as_its_voxels_as_a_world(run_tool, states, tmp_path):
    size, cells = 0.05, [(x, y, z) for x in range(4, 12) for y in range(-6, 6) for z in (7, 8, 20)]
    cloud = write_pcd(tmp_path / "cloud.pcd", [[(k + 0.3) * size for k in cell] for cell in cells])
    world = write_world(tmp_path / "world.urdf", cells, size)
    common = ["check_states", URDF, "--srdf", SRDF, "--states", states, "--min-distance"]
    as_cloud = run_tool(*common, "--cloud", cloud, "--voxel-size", size, "--out", tmp_path / "a.csv")
    as_world = run_tool(*common, "--world", world, "--out", tmp_path / "b.csv")
    assert as_cloud.returncode == as_world.returncode == 0, as_cloud.stderr + as_world.stderr
    found, wanted = rows_of(tmp_path / "a.csv"), rows_of(tmp_path / "b.csv")
    assert any("cloud" in row["pairs"] for row in wanted)
    for row, same in zip(found, wanted):
        assert row["in_collision"] == same["in_collision"] and row["pairs"] == same["pairs"]
        assert float(row["min_distance"]) == pytest.approx(float(same["min_distance"]), abs=1e-9)


@pytest.mark.parametrize("cloud,options,why", [
    ("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n0 0 0\n", ["--voxel-size", "0"], "voxel size"),
    ("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n0 0 0\n", [], "--voxel-size"),
    ("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 0\nDATA ascii\n", ["--voxel-size", "0.05"], "it has no finite point"),
    ("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\nnan 0 0\n", ["--voxel-size", "0.05"], "it has no finite point"),
    (None, ["--voxel-size", "0.05"], "cannot be opened"),
])
def test_a_cloud_that_cannot_be_used_is_refused_by_name(run_tool, states, tmp_path, cloud, options, why):
    path, out = tmp_path / "cloud.pcd", tmp_path / "out.csv"
    if cloud is not None:
        path.write_text(cloud)
    done = run_tool("check_states", URDF, "--states", states, "--cloud", path, *options, "--out", out)
    assert done.returncode == 2 and why in done.stderr and not out.exists()


@pytest.fixture
def check_boxes(run_tool, tmp_path):
    """Of unit boxes a, b and c on the x-axis at the positions of each state: the process, and a row each."""
    def run(states, *options, robot=sliding_boxes("abc")):
        urdf, given = tmp_path / "boxes.urdf", tmp_path / "given.csv"
        urdf.write_text(robot)
        given.write_text("\n".join(["slide_a,slide_b,slide_c"] + [",".join(map(repr, state)) for state in states]) + "\n")
        done = run_tool("check_states", urdf, "--states", given, "--out", tmp_path / "out.csv", *options)
        return done, rows_of(tmp_path / "out.csv") if done.returncode == 0 else []
    return run


def test_every_column_is_that_of_its_state_and_its_option(check_boxes):
    states = [(0.0, 1.25, 5.0), (0.0, 0.5, 5.0), (0.0, 1.0, 2.0), (-7.0, 0.0, 7.0)]
    pairs, distances = ["", "a|b", "a|b;b|c", ""], [0.25, -0.5, 0.0, 6.0]

    def told(*options):
        done, rows = check_boxes(states, *options)
        assert done.returncode == 0 and done.stderr == "", done.stderr
        assert [row["state"] for row in rows] == ["0", "1", "2", "3"]
        assert [row["in_collision"] for row in rows] == ["0", "1", "1", "0"]
        assert all(0 < float(row["microseconds"]) < 1e6 for row in rows)
        return [[row[name] for row in rows] for name in ("pairs", "min_distance", "nb_pairs")]
    assert told() == [pairs, [""] * 4, ["0", "1", "2", "0"]]
    assert told("--alarm-distance", "0.3") == [pairs, [""] * 4, ["1", "1", "2", "0"]]
    assert told("--verdict-only")[1:] == [[""] * 4] * 2
    _, found, _ = told("--verdict-only", "--min-distance")  # of a contact only the verdict is known
    assert [distance == "" for distance in found] == [False, True, True, False]
    assert [float(found[i]) for i in (0, 3)] == pytest.approx([distances[i] for i in (0, 3)], abs=1e-12)
    listed, found, _ = told("--min-distance")
    assert listed == pairs and [float(distance) for distance in found] == pytest.approx(distances, abs=1e-12)
    assert told("--tolerance", "0.1")[0] == pairs
    for threads in ("2", "5", "0"):
        assert told("--threads", threads, "--min-distance") == told("--min-distance")


def test_a_state_without_a_pose_is_refused_by_its_number_and_link(check_boxes):
    far = ("<link name='far'/><joint name='away' type='fixed'><parent link='root'/><child link='far'/>"
           "<origin xyz='1.7e308 0 0'/></joint>")
    robot = sliding_boxes("abc", more=far).replace("<parent link='root'/><child link='c'/>", "<parent link='far'/><child link='c'/>")
    done, _ = check_boxes([(0.0, 2.0, 4.0), (0.0, 2.0, 1.7e308)], robot=robot)
    errors = [line for line in done.stderr.splitlines() if line.startswith("error")]
    assert done.returncode == 2 and len(errors) == 1 and errors[0].startswith("error: state 1: link 'c' "), done.stderr


def test_hulls_of_few_vertices_are_larger(run_tool, states, tmp_path):
    settings = tmp_path / "settings.yaml"

    def distances(*options, limit=0):
        settings.write_text("max_hull_vertices: %d" % limit)
        done = run_tool("check_states", URDF, "--srdf", SRDF, "--states", states, "--out", tmp_path / "out.csv", "--min-distance",
                        "--links", "palm", "--fidelity", "convex", "--settings", settings, *options)
        assert done.returncode == 0, done.stderr
        return [float(row["min_distance"]) for row in rows_of(tmp_path / "out.csv")]
    exact, few = distances(), distances("--max-hull-vertices", "4")
    assert few != exact and all(a <= b + 1e-9 for a, b in zip(few, exact))
    assert distances(limit=4) == distances("--max-hull-vertices", "0", limit=4) == few == distances("--max-hull-vertices", "4", limit=9)


def test_what_is_said_of_a_cloud_names_its_file_and_its_numbers(check_boxes, tmp_path):
    cloud, nan, far = tmp_path / "cloud.pcd", float("nan"), 1e6
    state = [(0.0, 2.0, 4.0)]
    write_pcd(cloud, [(0.0, 5.0, 5.0), (nan, 0.0, 0.0), (0.0, 0.0, nan)])
    done, rows = check_boxes(state, "--cloud", cloud, "--voxel-size", "0.5")
    assert rows[0]["in_collision"] == "0"
    assert done.stderr == "warning: %s: 2 of 3 points are not finite and were ignored\n" % cloud
    write_pcd(cloud, [(far, 0.0, 0.0), (0.0, -far, 0.0), (1.0, 1.0, 1.0)])
    done, _ = check_boxes(state, "--cloud", cloud, "--voxel-size", "0.5")
    assert done.stderr == ("error: %s: 2 points are more than 2^20 voxels of 0.500000 m from the robot's root; increase --voxel-size "
                           "or remove them\n" % cloud)
    cloud.write_text("FIELDS x y z\n")
    done, _ = check_boxes(state, "--cloud", cloud, "--voxel-size", "0.5")
    assert done.stderr == "error: %s: it has no DATA line: it is not a PCD file, or is truncated\n" % cloud
    done, _ = check_boxes(state, "--cloud", tmp_path / "none.pcd", "--voxel-size", "0.5")
    assert done.stderr == "error: %s/none.pcd: cannot be opened: No such file or directory\n" % tmp_path


@pytest.mark.parametrize("restricted", [False, True])
def test_a_mesh_that_is_missing_is_said_with_the_file_and_the_link_that_need_it(check_boxes, tmp_path, restricted):
    mesh = "<link name='%s'><collision><geometry><mesh filename='file:///none.stl'/></geometry></collision></link>"
    world = tmp_path / "world.urdf"
    world.write_text("<robot name='w'>" + mesh % "wall" + "</robot>")
    options = ["--links", "a"] if restricted else []
    fixed = mesh % "d" + "<joint name='fixed' type='fixed'><parent link='root'/><child link='d'/></joint>"
    for done, of in ((check_boxes([(0, 2, 4)], "--world", world, *options)[0], (world, "wall")),
                     (check_boxes([(0, 2, 4)], *options, robot=sliding_boxes("abc", more=fixed))[0], (tmp_path / "boxes.urdf", "d"))):
        error = done.stderr.splitlines()[-1]
        assert done.returncode == 2 and error == "error: %s: URDF: link '%s': mesh 'file:///none.stl': there is no file /none.stl" % of
