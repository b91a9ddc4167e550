"""Robots with a mimic joint without a leader, or with a mesh that is not closed: they are checked, and what that leaves open is
said by the tools and by Python. (The node: test/ros/test_bad_input.py.)"""
import random
import struct
import warnings

import numpy as np
import pytest
from conftest import rows_of
from seed import given_seed

import collision_pairs as cp

LIMIT = '<limit lower="-3" upper="3" effort="1" velocity="1"/>'


def box_link(name, size, x=0.0):
    return ('<link name="%s"><collision><origin xyz="%g 0 0"/><geometry><box size="%g %g %g"/></geometry></collision></link>'
            % (name, x, size, size, size))


def joint(name, parent, child, x, inside=""):
    return ('<joint name="%s" type="revolute"><parent link="%s"/><child link="%s"/><origin xyz="%g 0 0"/><axis xyz="0 0 1"/>%s%s'
            '</joint>' % (name, parent, child, x, LIMIT, inside))


@pytest.fixture
def lost_leader(tmp_path):
    """base, turned about z at its end: arm; at its end: hand, whose joint mimics one that is not there; a post."""
    path = tmp_path / "lost_leader.urdf"
    path.write_text('<robot name="r">' + box_link("base", 0.1) + box_link("arm", 0.1, 0.3) + box_link("hand", 0.1, 0.3)
                    + box_link("post", 0.1) + joint("turn", "base", "arm", 0.1)
                    + joint("grip", "arm", "hand", 0.5, '<mimic joint="nobody" multiplier="2"/>')
                    + '<joint name="stands" type="fixed"><parent link="base"/><child link="post"/>'
                      '<origin xyz="0.1 0.3 0"/></joint></robot>')
    return path


TURNS = [0.0, 0.7, -0.7, 1.5708, 3.0] * 40  # at 1.5708 the arm is in the post; many: the batch is used, too


def test_a_joint_without_its_leader_needs_a_column_in_the_tools(run_tool, lost_leader, tmp_path):
    given, out = tmp_path / "given.csv", tmp_path / "out.csv"
    for tool, option in (("check_states", "--states"), ("check_motion", "--waypoints")):
        given.write_text("turn\n" + "".join("%g\n" % turn for turn in TURNS))
        done = run_tool(tool, lost_leader, option, given, "--out", out)
        assert "joint 'grip' mimics 'nobody', which does not exist" in done.stderr
        assert done.stderr.splitlines()[-1] == (
            "error: %s line 1: joint 'grip' needs a column: the joint that it mimics does not exist" % given)
        assert done.returncode == 2 and not out.exists()
        given.write_text("turn,grip\n" + "".join("%g,0.5\n" % turn for turn in TURNS))
        assert run_tool(tool, lost_leader, option, given, "--out", out).returncode == 0
        if tool == "check_states":
            assert [row["in_collision"] for row in rows_of(out)] == ["1" if turn == 1.5708 else "0" for turn in TURNS]
        out.unlink()


def test_what_a_joint_without_its_leader_moves_is_never_free_in_python(lost_leader):
    with pytest.warns(UserWarning, match="joint 'grip' mimics 'nobody', which does not exist"):
        robot = cp.Robot(str(lost_leader))
    assert robot.joints == ["turn", "grip"]
    detector = cp.Detector(cp.Scene(robot))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for settings in [{}, {"verdict_only": True}]:
            found = detector.check(np.array(TURNS)[:, None], joints=["turn"], **settings)
            assert [cp.Verdict(v) == cp.Verdict.COLLISION for v in found.verdict] == [turn == 1.5708 for turn in TURNS]
            assert cp.Verdict.FREE not in {cp.Verdict(v) for v in found.verdict}
    assert detector.check([0.0, 0.5]).verdict == cp.Verdict.FREE


def write_box(path, half, missing):
    """A binary STL: a box without `missing` of its faces."""
    corners = [np.array([(i & 1) * 2 - 1, (i >> 1 & 1) * 2 - 1, (i >> 2) * 2 - 1]) * half for i in range(8)]
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    triangles = [t for f in faces[missing:] for t in ((f[0], f[1], f[2]), (f[0], f[2], f[3]))]
    with open(path, "wb") as out:
        out.write(b"\0" * 80 + struct.pack("<I", len(triangles)))
        for triangle in triangles:
            out.write(struct.pack("<12fH", 0, 0, 0, *np.concatenate([corners[i] for i in triangle]), 0))


@pytest.fixture
def hollow(tmp_path):
    """A base with a mesh, and a small box wholly inside that mesh."""
    def make(missing, half):
        write_box(tmp_path / "hollow.stl", half, missing)
        path = tmp_path / "hollow.urdf"
        path.write_text('<robot name="r"><link name="base"><collision><geometry><mesh filename="file://%s/hollow.stl"/></geometry>'
                        '</collision></link>' % tmp_path + box_link("between", 0.001, 90) + box_link("inside", 0.02)
                        + joint("a", "base", "between", 0) + joint("b", "between", "inside", 0) + "</robot>")
        return path
    return make


def test_a_mesh_that_does_not_hold_what_is_inside_it_is_named_with_the_share_that_is_missing(run_tool, hollow, tmp_path):
    draw = random.Random(given_seed())
    states, out = tmp_path / "states.csv", tmp_path / "out.csv"
    states.write_text("a,b\n0,0\n")
    for missing in [0, 1, 2]:
        half = np.array([draw.uniform(0.1, 1.0) for _ in range(3)])
        share = missing / half[2] / (2 * sum(1 / half))  # faces 0 and 1 are those across z
        urdf = hollow(missing, half)
        done = run_tool("check_states", urdf, "--states", states, "--out", out)
        told = [line for line in done.stderr.splitlines() if "hollow.stl" in line]
        assert rows_of(out)[0]["in_collision"] == ("0" if missing else "1")
        assert len(told) == (1 if missing else 0), (done.stderr, half)
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            cp.Scene(cp.Robot(str(urdf)))
        in_python = [str(warning.message) for warning in said if "hollow.stl" in str(warning.message)]
        assert [text.replace("warning: ", "") for text in told] == in_python
        if missing:
            assert "'base': about %.0f %% of the surface of mesh" % (100 * share) in told[0]
            assert "a body wholly inside it is not found" in told[0]
