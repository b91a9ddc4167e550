"""Robots with a mimic joint without a leader, or with a mesh that is not closed: they are checked, and what that leaves open is
said by the tools and by Python. (The node: test/ros/test_bad_input.py.)"""
import os
import random
import shutil
import struct
import subprocess
import warnings

import numpy as np
import pytest
from conftest import TOOLS, rows_of
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


ANSWERS = [  # what the program that reads meshes writes, its status, and what is said of it
    ("printf ''", "ended without an answer, status 0"), ("exit 3", "ended without an answer, status 3"),
    ("printf X", "ended without an answer, status 0"), ("printf Rwhy", "why"), ("printf R", ""), ("kill -KILL $$", "crashed on it (Killed)")]
COUNTS = [(3, 1), (4, 1), (3, 2), (2, 1), (3, 0), (2**60, 1), (3, 2**60), (2**61, 2**61)]


def test_whatever_the_program_that_reads_meshes_answers_is_a_mesh_or_refused(tmp_path):
    """A program of our own in its place: it is looked for beside the library."""
    library, fake = tmp_path / "lib/libcollision_pairs_io.so", tmp_path / "lib/collision_pairs/read_mesh_file"
    fake.parent.mkdir(parents=True)
    shutil.copy(os.path.join(TOOLS, "..", library.name), library)
    mesh, urdf, states = tmp_path / "mesh.gltf", tmp_path / "robot.urdf", tmp_path / "states.csv"
    mesh.write_text("not read")
    states.write_text("turn\n0\n")
    urdf.write_text('<robot name="r"><link name="base"><collision><geometry><mesh filename="file://%s"/></geometry></collision></link>'
                    % mesh + box_link("post", 0.1) + joint("turn", "base", "post", 5.0) + "</robot>")

    def said(script):
        fake.unlink(missing_ok=True)
        if script is not None:
            fake.write_text("#!/bin/sh\n%s\n" % script)
            fake.chmod(0o755)
        done = subprocess.run([os.path.join(TOOLS, "check_states"), str(urdf), "--states", str(states)], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, env=dict(os.environ, LD_LIBRARY_PATH="%s:%s" % (library.parent, os.environ.get("LD_LIBRARY_PATH", ""))), timeout=60)
        error = [line for line in done.stderr.splitlines() if line.startswith("error")]
        assert (done.returncode, len(error)) in ((0, 0), (2, 1)), done.stderr
        return (error or [""])[0]
    begin = "error: %s: URDF: link 'base': mesh 'file://%s': " % (urdf, mesh)
    assisted = "assimp, which reads this format, "
    for script, why in ANSWERS:
        is_ours = why and not why.startswith("why")
        assert said(script) == begin + (assisted if is_ours else "") + why
    corners, triangle = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0), struct.pack("<3I", 0, 1, 2)
    for nb_vertices, nb_triangles in COUNTS:
        (tmp_path / "answer").write_bytes(b"M" + struct.pack("<2Q", nb_vertices, nb_triangles) + corners + triangle)
        right = (nb_vertices, nb_triangles) == (3, 1)
        assert said("cat %s/answer" % tmp_path) == ("" if right else begin + assisted + "ended without an answer, status 0")
    whole = b"M" + struct.pack("<2Q", 3, 1) + corners + triangle
    for size in (1, 5, 9, 16, 17, 28, 53, 60, len(whole) - 1):
        (tmp_path / "answer").write_bytes(whole[:size])
        assert said("cat %s/answer" % tmp_path) == begin + assisted + "ended without an answer, status 0"
    assert said(None) == begin + "read_mesh_file, which reads this format, could not be started: No such file or directory"


@pytest.mark.parametrize("words", [[], ["one", "two"]])
def test_the_program_that_reads_meshes_takes_one_file(words):
    done = subprocess.run([os.path.join(TOOLS, "read_mesh_file"), *words], stdout=subprocess.PIPE)
    assert (done.returncode, done.stdout) == (2, b"")
