"""generate_srdf as a user meets it: what it switches off, what it keeps, what it refuses."""
import csv
import os
import re
import xml.etree.ElementTree as ET

import pytest
from conftest import DEMO

DEMO_URDF = os.path.join(DEMO, "demo_robot.urdf")
MODELS = {"panda": "panda_model", "ur5": "ur_model", "pr2": "pr2_model"}
# Enough for these bounds: 4,603 trials without contact are needed.
QUICK = ["--samples", "5000", "--max-probability", "1e-3"]


def box(name, size, xyz="0 0 0"):
    return ("<link name='%s'><collision><origin xyz='%s'/><geometry><box size='%s'/></geometry></collision></link>"
            % (name, xyz, size))


def joint(kind, parent, child, xyz, axis="0 0 1", limits="lower='-3' upper='3'"):
    return ("<joint name='to_%s' type='%s'><parent link='%s'/><child link='%s'/><origin xyz='%s'/><axis xyz='%s'/>"
            "<limit %s effort='1' velocity='1'/></joint>" % (child, kind, parent, child, xyz, axis, limits))


# A mast on a base carries an arm, and that a hub with a flange around the arm's end. Two posts
# stand on the base; the nearer one is in the way of the arm, and touches it with all joints at zero.
ROBOT = "<robot name='crane'>" + "".join([
    box("base", "0.2 0.2 0.2"),
    box("mast", "0.1 0.1 0.1"), joint("revolute", "base", "mast", "0 0 0.2"),
    box("arm", "0.6 0.05 0.05", "0.5 0 0"), joint("revolute", "mast", "arm", "0 0 0", "0 1 0", "lower='-1.5' upper='1.5'"),
    box("hub", "0.03 0.03 0.03"), joint("continuous", "arm", "hub", "0.8 0 0", "1 0 0"),
    box("flange", "0.3 0.15 0.15"), joint("revolute", "hub", "flange", "0 0 0", "1 0 0"),
    box("near_post", "0.05 0.05 0.5"), joint("fixed", "base", "near_post", "0.5 0 0"),
    box("far_post", "0.05 0.05 0.5"), joint("fixed", "base", "far_post", "3 0 0"),
]) + "</robot>"
ADJACENT = {"base|mast", "arm|mast", "arm|hub", "flange|hub", "base|near_post", "base|far_post"}
ALWAYS = {"arm|flange"}
SOMETIMES = {"arm|near_post", "flange|near_post", "arm|base"}


@pytest.fixture
def crane(tmp_path):
    path = tmp_path / "crane.urdf"
    path.write_text(ROBOT)
    return path


def generate(run_tool, urdf, *options):
    """The SRDF that is printed, and what is said beside it."""
    done = run_tool("generate_srdf", urdf, *options)
    assert done.returncode == 0, done.stderr
    return done.stdout, done.stderr


def switched_off(srdf):
    """{"a|b": reason}"""
    return {"|".join(sorted((line.get("link1"), line.get("link2")))): line.get("reason")
            for line in ET.fromstring(srdf.encode()).iter("disable_collisions")}


def table(path):
    with open(path) as lines:
        return {row["link1"] + "|" + row["link2"]: row for row in csv.DictReader(lines)}


def test_fcl_finds_the_same_pairs_as_the_native_narrow_phase(run_tool, crane):
    native = generate(run_tool, crane, "--samples", "2000")[0]
    assert generate(run_tool, crane, "--samples", "2000", "--narrow-phase", "fcl")[0] == native
    assert run_tool("generate_srdf", crane, "--narrow-phase", "bullet").returncode == 2


def test_adjacent_always_and_never_pairs_are_switched_off_and_no_others(run_tool, crane, tmp_path):
    srdf, _ = generate(run_tool, crane, "--report", tmp_path / "pairs.csv")
    reasons = switched_off(srdf)
    rows = table(tmp_path / "pairs.csv")
    assert {pair for pair, reason in reasons.items() if reason == "Adjacent"} == ADJACENT
    assert {pair for pair, reason in reasons.items() if reason == "Always"} == ALWAYS
    assert {pair for pair, row in rows.items() if row["switched_off"] == "0"} == SOMETIMES
    assert set(reasons) == set(rows) - SOMETIMES and len(rows) == 21
    for pair, row in rows.items():
        assert row["class"] == reasons.get(pair, "Sometimes")
        assert (0 < int(row["contacts"]) < int(row["trials"])) or pair not in SOMETIMES


def test_each_line_tells_its_trials_contacts_and_bound(run_tool, crane):
    srdf, said = generate(run_tool, crane, "--samples", "60000", "--seed", "7")
    comment = re.search(r"<!-- (.*) -->\s*<disable_collisions link1=\"hub\" link2=\"mast\"", srdf).group(1)
    assert "0 of 60000 states" in comment
    bound = float(re.search(r"below ([-0-9.e]+)", comment).group(1))
    assert 0 <= bound - (1 - 0.01 ** (1 / 60000)) < 1e-7  # rounded up
    nearest = float(re.search(r"nearest found ([0-9.]+) mm", comment).group(1))
    assert nearest == pytest.approx(800 - 50 * 2 ** 0.5 - 15, abs=0.1)  # towards an edge of the mast
    always = re.search(r"<!-- (.*) -->\s*<disable_collisions link1=\"arm\" link2=\"flange\"", srdf).group(1)
    assert "60000 of 60000" in always and "apart below %.3g" % bound in always
    assert "on one rigid body: apart" in srdf
    assert "seed 7" in said and "seed 7" in srdf


def test_too_few_samples_are_refused_as_proof(run_tool, crane):
    srdf, said = generate(run_tool, crane, "--samples", "400")
    reasons = switched_off(srdf)
    assert set(reasons) == ADJACENT | {"far_post|near_post"}  # of one body: no statistics
    assert "--samples 46050 are needed" in said and "hub|mast (0 of 400)" in said
    assert re.search(r"checked: hub\|mast: .*46050 are needed", srdf)
    assert set(switched_off(generate(run_tool, crane, "--samples", "46049")[0])) == set(reasons)
    assert len(switched_off(generate(run_tool, crane, "--samples", "46050")[0])) > len(reasons)


def test_bytes_depend_on_the_seed_and_not_on_the_threads(run_tool, crane, tmp_path):
    outputs = {}
    for seed, threads in ((1, 1), (1, 2), (1, 5), (1, 0), (2, 0)):
        report = tmp_path / "pairs.csv"
        srdf, said = generate(run_tool, crane, *QUICK, "--seed", seed, "--threads", threads, "--report", report)
        outputs.setdefault(seed, set()).add((srdf, said, report.read_text()))
    assert len(outputs[1]) == 1 and not outputs[1] & outputs[2]


def test_pairs_nearer_than_the_clearance_stay_checked(run_tool, crane):
    options = [crane, *QUICK]
    assert switched_off(generate(run_tool, *options)[0])["hub|mast"] == "Never"
    srdf, _ = generate(run_tool, *options, "--clearance", "0.8")
    assert "hub|mast" not in switched_off(srdf) and "checked: hub|mast" in srdf


def test_pairs_that_touch_at_zero_are_switched_off_only_when_asked(run_tool, crane):
    srdf, said = generate(run_tool, crane, *QUICK)
    assert "arm|near_post" not in switched_off(srdf)
    assert "all joints at zero" in said and "arm|near_post" in said and "--disable-default" in said
    srdf, said = generate(run_tool, crane, *QUICK, "--disable-default")
    assert switched_off(srdf)["arm|near_post"] == "Default" and "all joints at zero" not in said
    assert "flange|near_post" not in switched_off(srdf)  # touches, but not there


def test_a_contact_at_zero_alone_is_one(run_tool, tmp_path):
    # Two fingers that touch with closed jaws only, the very end of their range.
    urdf = tmp_path / "jaws.urdf"
    urdf.write_text("<robot name='jaws'>" + "".join([
        "<link name='palm'/>", box("left", "0.1 0.1 0.1"), box("right", "0.1 0.1 0.1"),
        joint("prismatic", "palm", "left", "0 0 0", "0 0 1", "lower='0' upper='0.3'"),
        joint("prismatic", "palm", "right", "0 0 -0.1", "0 0 1", "lower='-0.3' upper='0'")]) + "</robot>")
    srdf, said = generate(run_tool, urdf, "--searches", "0", "--report", tmp_path / "pairs.csv")
    row = table(tmp_path / "pairs.csv")["left|right"]
    assert (row["contacts"], row["class"], row["contact_state"]) == ("0", "Sometimes", "to_left=0;to_right=0")
    assert not switched_off(srdf) and "but in contact with all joints at zero" in srdf and "left|right" in said
    assert switched_off(generate(run_tool, urdf, "--disable-default")[0]) == {"left|right": "Default"}


GIVEN = """<?xml version="1.0" ?>
<!-- by hand -->
<robot name="crane">
    <group name="all">
        <chain base_link="base" tip_link="flange"/>
    </group>
    <group_state name="home" group="all">
        <joint name="to_arm" value="-0.5"/>
    </group_state>
    <!-- the operator sees this one -->
    <disable_collisions link1="near_post" link2="arm" reason="User"/>
    <enable_collisions link1="hub" link2="mast"/>
    <enable_collisions link1="base" link2="mast"/>
</robot>
"""


def test_a_given_srdf_is_kept_and_only_added_to(run_tool, crane, tmp_path):
    given = tmp_path / "given.srdf"
    given.write_text(GIVEN)
    srdf, said = generate(run_tool, crane, "--srdf", given, *QUICK)
    head = GIVEN[:GIVEN.index("</robot>")].splitlines()[1:]
    lines = srdf.splitlines()
    assert lines[1:1 + len(head)] == head
    reasons = switched_off(srdf)
    assert reasons["arm|near_post"] == "User" and srdf.count('link2="arm" reason="User"') == 1
    assert not {"hub|mast", "base|mast"} & set(reasons)  # switched on: not ours to switch off
    assert reasons["arm|flange"] == "Always" and reasons["arm|mast"] == "Adjacent"
    assert "21 pairs:" in said and " 1 disabled as given," in said
    assert int(re.search(r"(\d+) stay checked", said).group(1)) == 21 - len(reasons)
    assert "that the given SRDF disables" in said and re.search(r"arm\|near_post \(\d+ of 5000\)", said)


def test_links_that_are_off_by_default_are_decided_already(run_tool, crane, tmp_path):
    given = tmp_path / "given.srdf"
    given.write_text("<robot name='crane'><disable_default_collisions link='hub'/></robot>")
    reasons = switched_off(generate(run_tool, crane, "--srdf", given, *QUICK)[0])
    assert not [pair for pair in reasons if "hub" in pair.split("|")]
    assert reasons["arm|flange"] == "Always"


@pytest.mark.parametrize("options", [QUICK, ["--samples", "400"]], ids=["enough", "too_few"])
def test_a_second_run_on_its_own_output_adds_nothing(run_tool, crane, tmp_path, options):
    first = tmp_path / "first.srdf"
    generate(run_tool, crane, *options, "--out", first)
    again, _ = generate(run_tool, crane, *options, "--srdf", first)
    assert again == first.read_text()


def test_a_file_may_be_given_and_written_at_once(run_tool, crane, tmp_path):
    path = tmp_path / "crane.srdf"
    path.write_text(GIVEN)
    generate(run_tool, crane, *QUICK, "--srdf", path, "--out", path)
    assert "arm|flange" in switched_off(path.read_text()) and "by hand" in path.read_text()


def check_contact_states(run_tool, urdf, rows, tmp_path, **options):
    """Every state of contact in the table is one, by check_states with all pairs switched on."""
    states = {pair: dict(word.split("=") for word in row["contact_state"].split(";"))
              for pair, row in rows.items() if row["contact_state"]}
    joints = sorted({name for state in states.values() for name in state})
    (tmp_path / "states.csv").write_text("\n".join([",".join(joints)] + [
        ",".join(state.get(name, "0") for name in joints) for state in states.values()]) + "\n")
    (tmp_path / "all_on.srdf").write_text("<robot name='r'/>")
    done = run_tool("check_states", urdf, "--srdf", tmp_path / "all_on.srdf", "--states", tmp_path / "states.csv",
                    **options)
    assert done.returncode == 0, done.stderr
    found = [set(line.split(",")[2].split(";")) for line in done.stdout.splitlines()[1:]]
    assert len(found) == len(states)
    assert [pair for pair, pairs in zip(states, found) if pair not in pairs] == []
    return len(states)


def test_the_table_shows_a_state_of_contact_for_each_pair_that_has_one(run_tool, tmp_path):
    generate(run_tool, DEMO_URDF, *QUICK, "--report", tmp_path / "pairs.csv")
    rows = table(tmp_path / "pairs.csv")
    assert check_contact_states(run_tool, DEMO_URDF, rows, tmp_path) > 20
    for row in rows.values():
        assert bool(row["contact_state"]) <= (int(row["contacts"]) > 0 or row["found_by_search"] == "1")


def test_joints_without_a_range_are_named(run_tool, tmp_path):
    urdf = tmp_path / "free.urdf"
    urdf.write_text("<robot name='free'>" + box("a", "1 1 1") + box("b", "1 1 1") +
                    "<joint name='anywhere' type='floating'><parent link='a'/><child link='b'/>"
                    "<origin xyz='3 0 0'/></joint></robot>")
    _, said = generate(run_tool, urdf, *QUICK)
    assert "taken as zero: anywhere" in said


@pytest.mark.parametrize("which, content, says", [
    ("urdf", b"", "empty"), ("urdf", b"<robot name='r'><link/></robot>", "bad_urdf"),
    ("urdf", b"<robot name='r'><link name='a'><collision><geometry><mesh filename='package://collision_pairs/no.stl'/>"
             b"</geometry></collision></link></robot>", "no.stl"),
    ("srdf", b"<robot name='r'><disable_collisions", "SRDF line 1"),
    ("srdf", b"<robot name='r'><enable_collisions link1='a'/></robot>", "link2"),
    ("srdf", b"", "empty"),
])
def test_wrong_input_is_one_line_and_exit_code_2(run_tool, crane, tmp_path, which, content, says):
    bad = tmp_path / ("bad_" + which)
    bad.write_bytes(content)
    files = {"urdf": crane, "srdf": None, which: bad}
    out, report = tmp_path / "out.srdf", tmp_path / "out.csv"
    options = ["--srdf", files["srdf"]] if files["srdf"] else []
    done = run_tool("generate_srdf", files["urdf"], *options, *QUICK, "--out", out, "--report", report)
    assert done.returncode == 2 and len(done.stderr.splitlines()) == 1, done.stderr
    assert says in done.stderr and "bad_" + which in done.stderr
    assert done.stdout == "" and not list(tmp_path.glob("out*"))


@pytest.mark.parametrize("options, says", [
    (["--samples", "0"], "--samples"), (["--samples", "-5"], "--samples"), (["--samples", "many"], "--samples"),
    (["--seed", "x"], "--seed"), (["--searches", "-1"], "--searches"), (["--threads", "-1"], "--threads"),
    (["--confidence", "1"], "--confidence"), (["--confidence", "nan"], "--confidence"),
    (["--max-probability", "0"], "--max-probability"), (["--clearance", "-0.1"], "--clearance"),
    (["--clearance", "inf"], "--clearance"), (["--srdf", "none.srdf"], "none.srdf"), (["--speed", "3"], "--speed"),
    (["--out", "/none/out.srdf"], "/none/out.srdf"), (["--report", "/none/pairs.csv"], "/none/pairs.csv"),
])
def test_wrong_options_are_one_line_and_exit_code_2(run_tool, crane, options, says):
    done = run_tool("generate_srdf", crane, *([] if "--samples" in options else ["--samples", "100"]), *options)
    assert done.returncode == 2 and says in done.stderr and len(done.stderr.splitlines()) == 1, done.stderr
    assert done.stdout == ""


@pytest.mark.parametrize("robot", MODELS)
def test_no_pair_of_the_reference_collisions_is_switched_off(run_tool, shared, tmp_path, robot):
    urdf = "%s/robots/%s/urdf/%s.urdf" % (shared, MODELS[robot], robot)
    packages = os.path.join(shared, "robots")
    done = run_tool("generate_srdf", urdf, *QUICK, "--searches", "1", "--out", tmp_path / "out.srdf", "--report",
                    tmp_path / "pairs.csv", packages=packages)
    assert done.returncode == 0, done.stderr
    reasons = switched_off((tmp_path / "out.srdf").read_text())
    with open("%s/reference/reference_%s.csv" % (shared, robot)) as lines:
        collided = {pair for row in csv.DictReader(lines) for pair in row["self_pairs"].split(";") if pair}
    assert len(collided) > 5 and not collided & set(reasons)
    assert {"Adjacent", "Never"} <= set(reasons.values())
    check_contact_states(run_tool, urdf, table(tmp_path / "pairs.csv"), tmp_path, packages=packages)
