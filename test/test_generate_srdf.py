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
    (["--confidence", "1"], "--confidence"), (["--confidence", "nan"], "--confidence"), (["--speed", "3"], "--speed"),
    (["--max-probability", "0"], "--max-probability"), (["--max-probability", "1e-20"], "--max-probability"),
    (["--clearance", "-0.1"], "--clearance"), (["--clearance", "inf"], "--clearance"), (["--srdf", "none.srdf"], "none.srdf"),
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


def comments_of(srdf):
    """By pair: what is said above its line; and what is said of pairs that stay checked."""
    off = {"|".join(sorted((a, b))): text for text, a, b in re.findall(
        r'<!-- ([^>]*) -->\s*<disable_collisions link1="(\w+)" link2="(\w+)"', srdf)}
    return off, dict(re.findall(r"<!-- checked: (\w+\|\w+): ([^>]*) -->", srdf))


RIGID = {"base|near_post", "base|far_post", "far_post|near_post"}
ALL_OPTIONS = ["--samples", "700", "--seed", "7", "--searches", "3", "--confidence", "0.9", "--max-probability", "0.05",
               "--clearance", "0.45"]


@pytest.mark.parametrize("options, header", [
    (QUICK, "5000 random states, seed 1, 20 searches; bounds at confidence 0.99, never and always up to probability 0.001, "
            "clearance 0 m"),
    (["--samples", "400"], "400 random states, seed 1, 20 searches; bounds at confidence 0.99, never and always up to probability "
                           "0.0001, clearance 0 m"),
    (ALL_OPTIONS, "700 random states, seed 7, 3 searches; bounds at confidence 0.9, never and always up to probability 0.05, "
                  "clearance 0.45 m")], ids=["enough", "too_few", "all"])
def test_comments_summary_and_table_say_the_same(run_tool, crane, tmp_path, options, header):
    srdf, said = generate(run_tool, crane, *options, "--disable-default", "--report", tmp_path / "pairs.csv")
    assert srdf.count("<!-- generate_srdf: %s -->" % header) == 1
    samples = int(header.split()[0])
    confidence = float(re.search(r"confidence (\S+),", header).group(1))
    off, checked = comments_of(srdf)
    rows, reasons = table(tmp_path / "pairs.csv"), switched_off(srdf)
    assert set(off) == set(reasons) == {pair for pair, row in rows.items() if row["switched_off"] == "1"}
    for pair, row in rows.items():
        if pair in RIGID:
            assert off[pair] == "on one rigid body: apart"
            continue
        contacts, trials = int(row["contacts"]), int(row["trials"])
        assert trials == samples or 0 < contacts < trials or pair in ADJACENT  # enough to tell
        above, below = float(row["probability_above"]), float(row["probability_below"])
        assert row["given"] == ""
        assert above <= contacts / trials <= below and (above == 0) == (contacts == 0) and (below == 1) == (contacts == trials)
        count = "in contact in %d of %d states" % (contacts, trials)
        text = off.get(pair) or checked.get(pair)
        if pair in checked:
            if row["class"] == "Unproven":
                assert text.startswith(count + ", which are too few; ") and text.endswith(" are needed")
            elif row["class"] == "Near":
                assert text == count + ", but came as close as %.1f mm" % (1e3 * float(row["nearest"]))
            else:
                assert contacts == 0 and row["found_by_search"] == "1" and text == count + ", but a search found a contact"
        elif text is None:
            assert 0 < contacts < trials
        elif contacts == trials:
            bound = 1 - (1 - confidence) ** (1 / trials)
            told = re.fullmatch(count + r"; probability of being apart below (\S+)", text).group(1)
            assert bound <= float(told) < 1.01 * bound and len(told.split("e")[0].strip("0.")) <= 3
        else:
            told = re.fullmatch(count + r"; probability below ([-0-9.e]+?)(?:; nearest found (\S+) mm)?", text)
            assert below * 0.999 <= float(told.group(1)) < 1.01 * below
            assert (told.group(2) is None) == (contacts > 0 or pair in ADJACENT)
            assert told.group(2) is None or float(told.group(2)) == pytest.approx(1e3 * float(row["nearest"]), abs=0.051, rel=1e-3)
    assert float(rows["hub|mast"]["nearest"]) == pytest.approx(0.8 - 0.05 * 2 ** 0.5 - 0.015, abs=2e-3)
    added = [" %d %s," % (list(reasons.values()).count(reason), reason) for reason in sorted(set(reasons.values()))]
    open_rows = [row for row in rows.values() if row["switched_off"] == "0"]
    seed = re.search(r"seed (\d+),", header).group(1)
    assert said.splitlines()[-1] == "seed %s, 21 pairs:%s %d stay checked, of which %d were found in contact by search only" % (
        seed, "".join(added), len(open_rows), sum(row["found_by_search"] == "1" for row in open_rows))


def test_two_links_of_one_rigid_body_may_be_in_contact(run_tool, tmp_path):
    urdf = tmp_path / "welded.urdf"
    urdf.write_text("<robot name='welded'>" + box("a", "1 1 1") + box("m", "0.1 0.1 0.1") + box("b", "1 1 1") +
                    joint("fixed", "a", "m", "0 0 0") + joint("fixed", "m", "b", "0.5 0 0") + "</robot>")
    assert comments_of(generate(run_tool, urdf, "--samples", "10")[0])[0]["a|b"] == "on one rigid body: in contact"


def warnings_in(said):
    """(how many, what of them, those that are named with their count) a line."""
    lines = re.findall(r"^warning: (\d+) (pairs? .*?): ([^:]*)$", said, re.MULTILINE)
    return [(int(count), what, names.split(", ")) for count, what, names in lines]


def test_of_pairs_that_are_warned_of_ten_are_named_and_those_most_often_in_contact_first(run_tool, crane, tmp_path):
    said = generate(run_tool, crane, "--samples", "400", "--report", tmp_path / "pairs.csv")[1]
    (few,) = [each for each in warnings_in(said) if "too few" in each[1]]
    assert few[1] == ("pairs stay checked because there are too few states to conclude never or always; --samples 46050 are needed for "
                      "--max-probability 0.0001")
    assert few[0] > 10 and len(few[2]) == 10 and few[2][9].endswith(" (0 of 400) and %d more" % (few[0] - 10))
    assert few[2][0] == "arm|flange (400 of 400)" and all(name.endswith(" (0 of 400)") for name in few[2][1:9])
    one = [each for each in warnings_in(generate(run_tool, crane, *QUICK)[1]) if "at zero" in each[1]]
    assert [(count, what) for count, what, _ in one] == [
        (1, "pair stay checked although they touch with all joints at zero, because in other states they do not "
            "(--disable-default disables them)")] and one[0][2][0].startswith("arm|near_post (")
    given = tmp_path / "given.srdf"
    unproven = [pair for pair, row in table(tmp_path / "pairs.csv").items() if row["class"] == "Unproven"]
    assert len(unproven) == few[0]
    given.write_text("<robot name='crane'>%s</robot>" % "".join(
        "<disable_collisions link1='%s' link2='%s' reason='User'/>" % tuple(pair.split("|")) for pair in unproven[10:]))
    (ten,) = [each for each in warnings_in(generate(run_tool, crane, "--samples", "400", "--srdf", given)[1]) if "too few" in each[1]]
    assert ten[0] == 10 and {name.split()[0] for name in ten[2]} == set(unproven[:10])
    for first in range(2):  # of three pairs that are sometimes in contact, in whatever order
        pairs = sorted(SOMETIMES)[first:] + sorted(SOMETIMES)[:first]
        given.write_text("<robot name='crane'>%s</robot>" % "".join(
            "<disable_collisions link1='%s' link2='%s' reason='User'/>" % tuple(pair.split("|")) for pair in pairs))
        (kept,) = warnings_in(generate(run_tool, crane, *QUICK, "--srdf", given)[1])
        assert kept[:2] == (3, "pairs that the given SRDF disables are in contact in some states; they stay disabled")
        counts = [int(re.search(r"\((\d+) of 5000\)", name).group(1)) for name in kept[2]]
        assert counts == sorted(counts, reverse=True) and {name.split()[0] for name in kept[2]} == SOMETIMES


def test_what_is_given_is_told_apart_in_the_table(run_tool, crane, tmp_path):
    given = tmp_path / "given.srdf"
    given.write_text(GIVEN)
    generate(run_tool, crane, "--srdf", given, *QUICK, "--report", tmp_path / "pairs.csv")
    told = {pair: (row["given"], row["switched_off"]) for pair, row in table(tmp_path / "pairs.csv").items() if row["given"]}
    assert told == {"arm|near_post": ("off", "1"), "hub|mast": ("on", "0"), "base|mast": ("on", "0")}
    given.write_text("<robot name='crane'><disable_collisions link1='nobody' link2='mast'/></robot>")
    assert "warning: %s: not links of the robot, ignored: nobody\n" % given in generate(run_tool, crane, "--srdf", given, *QUICK)[1]
