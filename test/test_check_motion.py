"""check_motion as a user meets it: what it certifies, what it finds, what it refuses."""
import csv
import io
import os

import pytest
from conftest import DEMO, SRDF, URDF, sliding_boxes

HEADER = ["segment", "verdict", "clearance", "contact_at", "free_until", "pairs", "nb_checks", "microseconds"]
JOINTS = "shoulder_pan,shoulder_lift,upper_arm_roll,elbow_flex,forearm_roll,wrist_flex,wrist_roll,gripper"


def rows_in(text):
    return list(csv.DictReader(io.StringIO(text)))


@pytest.fixture
def waypoints(tmp_path):
    """Through the arch and away from it."""
    path = tmp_path / "waypoints.csv"
    path.write_text(JOINTS + "\n0,-0.3,0,1.2,0,0.9,0,0.02\n0.6,1.1,0,0.6,0,-0.1,1.35,0.02\n"
                    "0,-0.3,0,1.2,0,0.9,0,0.02\n-0.2,-0.4,0,1.2,0,0.9,0,0.02\n")
    return path


def test_free_segments_have_a_clearance_and_others_a_contact(run_tool, waypoints, tmp_path):
    out = tmp_path / "out.csv"
    done = run_tool("check_motion", URDF, "--srdf", SRDF, "--waypoints", waypoints, "--out", out)
    assert done.returncode == 0, done.stderr
    rows = rows_in(out.read_text())
    assert list(rows[0]) == HEADER and [row["segment"] for row in rows] == ["0", "1", "2"]
    assert [row["verdict"] for row in rows] == ["collision", "collision", "free"]
    assert 0.0 < float(rows[0]["contact_at"]) < 1.0 and rows[0]["clearance"] == ""
    until = [float(row["free_until"]) for row in rows]
    assert 0.0 < until[0] <= float(rows[0]["contact_at"]) and until[1:] == [0.0, 1.0]  # the second row is in contact
    assert rows[0]["pairs"] and "|" in rows[0]["pairs"]
    assert float(rows[2]["clearance"]) > 0.0 and rows[2]["contact_at"] == rows[2]["pairs"] == ""
    assert all(int(row["nb_checks"]) >= 1 and float(row["microseconds"]) > 0 for row in rows)


def test_check_states_agrees_about_every_contact(run_tool, tmp_path):
    with open(os.path.join(DEMO, "motion.csv")) as lines:
        rows = list(csv.reader(lines))
    header, states = rows[0], [[float(q) for q in row] for row in rows[1:]]
    states = [[q * scale for q in state] for state in states for scale in (1.0, 1.3)]
    table = tmp_path / "waypoints.csv"
    table.write_text("\n".join([",".join(header)] + [",".join(map(repr, state)) for state in states]) + "\n")
    done = run_tool("check_motion", URDF, "--srdf", SRDF, "--waypoints", table)
    assert done.returncode == 0, done.stderr
    contacts = [row for row in rows_in(done.stdout) if row["verdict"] == "collision"]
    assert len(contacts) >= 3
    at_contacts = []
    for row in contacts:
        a, b = states[int(row["segment"])], states[int(row["segment"]) + 1]
        fraction = float(row["contact_at"])
        at_contacts.append([p + fraction * (q - p) for p, q in zip(a, b)])
    table.write_text("\n".join([",".join(header)] + [",".join(map(repr, q)) for q in at_contacts]) + "\n")
    agreed = rows_in(run_tool("check_states", URDF, "--srdf", SRDF, "--states", table).stdout)
    assert [row["in_collision"] for row in agreed] == ["1"] * len(contacts)
    assert [row["pairs"] for row in agreed] == [row["pairs"] for row in contacts]


def test_a_clearance_that_is_not_kept_is_unresolved_and_names_the_pairs(run_tool, waypoints):
    for clearance, verdict in (("0.01", "free"), ("0.5", "unresolved")):
        done = run_tool("check_motion", URDF, "--srdf", SRDF, "--waypoints", waypoints, "--clearance",
                        clearance)
        row = rows_in(done.stdout)[2]
        assert row["verdict"] == verdict, row
        if verdict == "free":
            assert float(row["clearance"]) >= float(clearance)
        else:
            assert row["clearance"] == "" and row["pairs"]


def test_a_world_and_a_restriction_are_heeded(run_tool, waypoints, tmp_path):
    world = tmp_path / "world.urdf"
    world.write_text("<robot name='w'><link name='plate'><collision><origin xyz='0 0 1.2'/><geometry>"
                     "<box size='9 9 0.002'/></geometry></collision></link></robot>")
    done = run_tool("check_motion", URDF, "--srdf", SRDF, "--waypoints", waypoints, "--world", world)
    assert rows_in(done.stdout)[2]["verdict"] == "collision"
    assert "plate" in rows_in(done.stdout)[2]["pairs"]
    done = run_tool("check_motion", URDF, "--srdf", SRDF, "--waypoints", waypoints, "--world", world,
                    "--links", "table")
    assert done.returncode == 0 and "plate" not in done.stdout


def test_any_number_of_threads_gives_the_same_output(run_tool, tmp_path):
    table = tmp_path / "many.csv"
    table.write_text("shoulder_pan,shoulder_lift,elbow_flex\n" + "".join(
        "%.3f,%.3f,%.3f\n" % ((i * 0.37) % 4 - 2, (i * 0.23) % 2 - 1, (i * 0.61) % 3 - 1.5) for i in range(60)))
    outputs = [[line.rsplit(",", 1)[0] for line in
                run_tool("check_motion", URDF, "--srdf", SRDF, "--waypoints", table, "--threads",
                         threads).stdout.splitlines()] for threads in (1, 2, 5, 0)]
    assert len(outputs[0]) == 60 and all(output == outputs[0] for output in outputs)


def test_joints_outside_their_limits_are_warned_of(run_tool, tmp_path):
    table = tmp_path / "waypoints.csv"
    table.write_text("shoulder_pan\n0\n3.5\n-3.6\n")
    done = run_tool("check_motion", URDF, "--srdf", SRDF, "--waypoints", table)
    assert done.returncode == 0 and len(rows_in(done.stdout)) == 2
    assert "shoulder_pan" in done.stderr and "2 waypoints" in done.stderr and "waypoint 1" in done.stderr
    assert "gripper" in done.stderr and "free only with them at zero" in done.stderr


@pytest.mark.parametrize("content, words", [
    ("shoulder_pan\n0\n", ["waypoints.csv", "1 waypoints", "two"]),
    ("shoulder_pan\n", ["waypoints.csv", "0 waypoints"]),
    ("", ["waypoints.csv", "header"]),
    ("no_joint\n0\n1\n", ["line 1", "'no_joint'"]),
    ("shoulder_pan\n0\nnan\n", ["line 3", "'shoulder_pan'", "finite"]),
    ("shoulder_pan\n0\n1,2\n", ["line 3", "fields"]),
])
def test_wrong_waypoints_are_refused_by_line_and_leave_no_output(run_tool, tmp_path, content, words):
    table, out = tmp_path / "waypoints.csv", tmp_path / "out.csv"
    table.write_text(content)
    done = run_tool("check_motion", URDF, "--srdf", SRDF, "--waypoints", table, "--out", out)
    assert done.returncode == 2 and len(done.stderr.splitlines()) == 1
    assert all(word in done.stderr for word in words), done.stderr
    assert os.listdir(tmp_path) == ["waypoints.csv"]


@pytest.mark.parametrize("option, value", [
    ("--clearance", "-1"), ("--clearance", "nan"), ("--clearance", "inf"), ("--resolution", "0"),
    ("--resolution", "nan"), ("--fidelity", "fine"), ("--threads", "-1"), ("--links", "nobody")])
def test_wrong_options_are_refused_in_one_line(run_tool, waypoints, option, value):
    done = run_tool("check_motion", URDF, "--srdf", SRDF, "--waypoints", waypoints, option, value)
    assert done.returncode == 2 and done.stdout == "" and len(done.stderr.splitlines()) == 1
    assert option.strip("-") in done.stderr or value in done.stderr


def test_a_missing_mesh_is_refused(run_tool, waypoints, tmp_path):
    urdf = tmp_path / "broken.urdf"
    with open(URDF) as text:
        urdf.write_text(text.read().replace("palm.stl", "no_palm.stl"))
    done = run_tool("check_motion", urdf, "--srdf", SRDF, "--waypoints", waypoints)
    assert done.returncode == 2 and "no_palm.stl" in done.stderr


def test_the_demo_s_own_motion_is_as_its_postures_say(run_tool):
    """The demo goes through contacts on purpose; between free postures that are near it is free."""
    done = run_tool("check_motion", URDF, "--srdf", SRDF, "--waypoints", os.path.join(DEMO, "motion.csv"))
    verdicts = {row["verdict"] for row in rows_in(done.stdout)}
    assert done.returncode == 0 and verdicts <= {"free", "collision", "unresolved"}
    assert {"free", "collision"} <= verdicts


def test_a_cloud_is_an_obstacle_of_motions(run_tool, tmp_path):
    path = tmp_path / "waypoints.csv"
    path.write_text(JOINTS + "\n0,-0.3,0,1.2,0,0.9,0,0.02\n-0.2,-0.4,0,1.2,0,0.9,0,0.02\n")
    header = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS %d\nDATA ascii\n"
    far, near = tmp_path / "far.pcd", tmp_path / "near.pcd"
    far.write_text(header % 1 + "5 5 5\n")
    points = ["%r %r %r" % (0.1 * x, 0.1 * y, 0.1 * z)
              for x in range(-10, 11) for y in range(-10, 11) for z in range(3, 8)]
    near.write_text(header % len(points) + "\n".join(points) + "\n")
    common = ["check_motion", URDF, "--srdf", SRDF, "--waypoints", path, "--voxel-size", "0.1", "--cloud"]
    assert rows_in(run_tool(*common, far).stdout)[0]["verdict"] == "free"
    row = rows_in(run_tool(*common, near).stdout)[0]
    assert row["verdict"] == "collision" and "cloud" in row["pairs"]


@pytest.fixture
def check_balls(run_tool, tmp_path):
    """Of balls a, b and c of half a metre on the x-axis at the positions of each waypoint: a row each segment."""
    def run(waypoints, *options):
        urdf, given, out = tmp_path / "balls.urdf", tmp_path / "given.csv", tmp_path / "out.csv"
        urdf.write_text(sliding_boxes("abc", "<sphere radius='0.5'/>"))
        given.write_text("\n".join(["slide_a,slide_b,slide_c"] + [",".join(map(repr, state)) for state in waypoints]) + "\n")
        done = run_tool("check_motion", urdf, "--waypoints", given, "--out", out, *options)
        assert done.returncode == 0 and done.stderr == "", done.stderr
        return rows_in(out.read_text())
    return run


def test_every_column_is_that_of_its_segment_and_its_option(check_balls):
    apart, near, past = (0.0, 3.0, 9.0), (0.0, 1.5, 9.0), (4.0, 1.5, 2.25)
    waypoints = [apart, near, past, past]
    for options in ([], ["--clearance", "0"], ["--threads", "2"], ["--fidelity", "obb"]):
        free, hit, rest = check_balls(waypoints, *options)
        assert [row["segment"] for row in (free, hit, rest)] == ["0", "1", "2"]
        assert [row["verdict"] for row in (free, hit, rest)] == ["free", "collision", "collision"]
        assert 0 < float(free["clearance"]) <= 0.5 + 1e-9 and hit["clearance"] == rest["clearance"] == ""
        assert free["contact_at"] == free["pairs"] == "" and free["free_until"] == "1"
        # a meets b when it has gone half a metre of four; then c, which comes to b, meets a.
        assert 1 / 8 - 1e-9 <= float(hit["contact_at"]) <= 1 and set(hit["pairs"].split(";")) <= {"a|b", "a|c", "b|c"}
        assert 0.9 / 8 < float(hit["free_until"]) <= 1 / 8
        assert (float(rest["free_until"]), rest["pairs"]) == (0, "b|c") and 0 <= float(rest["contact_at"]) <= 1
        assert all(int(row["nb_checks"]) > 0 and 0 < float(row["microseconds"]) < 1e6 for row in (free, hit, rest))
    kept, (lost, *_) = check_balls(waypoints, "--clearance", "0.49")[0], check_balls(waypoints, "--clearance", "0.51")
    assert kept["verdict"] == "free" and 0.49 <= float(kept["clearance"]) <= 0.5 + 1e-9
    assert (lost["verdict"], lost["clearance"], lost["contact_at"], lost["pairs"]) == ("unresolved", "", "", "a|b")
    assert 0.98 < float(lost["free_until"]) < 1
    coarse = check_balls(waypoints, "--clearance", "0.49", "--resolution", "100")[0]
    assert int(coarse["nb_checks"]) < int(kept["nb_checks"]) and coarse["verdict"] == "unresolved"
