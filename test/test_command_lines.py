"""The command lines of all tools: what --help says, what is refused and how, which words belong to which option."""
import os
import pty
import re
import subprocess

import pytest
from conftest import DEMO, DEMO_BAG, PROJECT
from conftest import TOOLS as LIBRARY

URDF = os.path.join(DEMO, "demo_robot.urdf")
TOOLS = {"check_states": ["ROBOT.urdf", "--states STATES.csv"], "check_motion": ["ROBOT.urdf", "--waypoints WAYPOINTS.csv"],
         "check_bag": ["BAG..."], "generate_srdf": ["ROBOT.urdf"], "measure_stopping": ["BAG"], "merge_bag_checks": ["TABLE.csv..."]}


def documented(tool):
    """The options that docs/tools.md shows for it."""
    with open(os.path.join(PROJECT, "docs/tools.md"), encoding="utf-8") as page:
        calls = re.findall(r"^%s .*?\n(?=\S)" % tool, page.read(), re.MULTILINE | re.DOTALL)
    return re.findall(r"[\[ ]--([a-z-]+)", "".join(calls))


@pytest.fixture
def refused(run_tool):
    """What a tool says on the one line with which it refuses its input."""
    def run(*command):
        done = run_tool(*command)
        assert done.returncode == 2 and len(done.stderr.splitlines()) == 1, (command, done.stderr)
        return done.stderr
    return run


@pytest.mark.parametrize("tool", TOOLS)
def test_help_says_how_the_tool_is_called_and_every_option(run_tool, tool):
    done = run_tool(tool, "--help")
    assert done.returncode == 0 and done.stderr == "" and done.stdout == run_tool(tool, "-h").stdout
    usage = re.search(r"^Usage: (.*)$", done.stdout, re.MULTILINE).group(1)
    assert usage == " ".join([tool] + TOOLS[tool] + ["[OPTIONS]"])
    described = re.findall(r"^  --([a-z-]+)", done.stdout, re.MULTILINE)
    assert len(described) == len(set(described)) and set(documented(tool)) <= set(described)
    assert max(map(len, done.stdout.splitlines())) <= 120


def test_numbers_have_a_point_also_where_the_user_writes_a_comma(run_tool, tmp_path, monkeypatch):
    (tmp_path / "comma.txt").write_text('LC_NUMERIC\ndecimal_point "<U002C>"\nthousands_sep ""\ngrouping -1\nEND LC_NUMERIC\n')
    subprocess.run(["localedef", "--no-archive", "-c", "-i", "comma.txt", str(tmp_path / "comma")], cwd=tmp_path,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)  # ends with 1: it has no other category
    (tmp_path / "states.csv").write_text("shoulder_pan\n0.5\n")
    expected = run_tool("check_states", URDF, "--states", tmp_path / "states.csv")
    monkeypatch.setenv("LOCPATH", str(tmp_path))
    monkeypatch.setenv("LC_NUMERIC", "comma")
    assert subprocess.run(["/usr/bin/printf", "%.1f", "0,5"], stdout=subprocess.PIPE).stdout == b"0,5"  # it is in force
    found = run_tool("check_states", URDF, "--states", tmp_path / "states.csv")
    without_time = [done.stdout.rsplit(",", 1)[0] for done in (found, expected)]
    assert found.returncode == 0 and without_time[0] == without_time[1], found.stderr


OVERWRITING = [
    ("check_bag", ["IN", "--out", "IN"], "--out IN: would overwrite BAG... (IN)"),
    ("check_bag", ["other", "IN", "--record", "FOLDER/../IN"], "--record FOLDER/../IN: would overwrite BAG... (IN)"),
    ("check_bag", ["other", "--out", "new", "--record", "new"], "--record new: would overwrite --out (new)"),
    ("check_bag", ["other", "--out", "FOLDER/index.html", "--report", "FOLDER"],
     "--report FOLDER: would overwrite --out (FOLDER/index.html)"),
    ("merge_bag_checks", ["other", "IN", "--out", "IN"], "--out IN: would overwrite TABLE.csv... (IN)"),
    ("check_states", ["other", "--states", "IN", "--out", "IN"], "--out IN: would overwrite --states (IN)"),
    ("check_motion", ["IN", "--waypoints", "other", "--out", "IN"], "--out IN: would overwrite ROBOT.urdf (IN)"),
    ("generate_srdf", ["other", "--out", "new", "--report", "./new"], "--report ./new: would overwrite --out (new)"),
    *((tool, ["other", *needs, "--out", "IN", option, "IN"], "--out IN: would overwrite %s (IN)" % option)
      for tool, needs, options in (
          ("check_states", ["--states", "other"], ["--srdf", "--world", "--settings"]),
          ("check_motion", ["--waypoints", "other"], ["--srdf", "--world", "--settings"]),
          ("check_bag", [], ["--urdf", "--srdf", "--world", "--settings"])) for option in options),
    ("check_states", ["other", "--states", "other", "--out", "IN", "--voxel-size", "1", "--cloud", "IN"],
     "--out IN: would overwrite --cloud (IN)"),
    ("generate_srdf", ["other", "--srdf", "IN", "--report", "IN"], "--report IN: would overwrite --srdf (IN)"),
    ("measure_stopping", ["IN", "--plot", "IN"], "--plot IN: would overwrite BAG (IN)")]


@pytest.mark.parametrize("tool, words, why", OVERWRITING)
def test_no_output_overwrites_an_input_or_another_output(refused, tmp_path, monkeypatch, tool, words, why):
    monkeypatch.chdir(tmp_path)
    os.mkdir("FOLDER")
    for name in ("IN", "other"):
        (tmp_path / name).write_text(name)
    assert refused(tool, *words) == "error: %s\n" % why
    assert sorted(os.listdir(".")) == ["FOLDER", "IN", "other"] and (tmp_path / "IN").read_text() == "IN"


PROGRESS = {"check_states": [URDF, "--states", "FILE"], "check_motion": [URDF, "--waypoints", "FILE"],
            "check_bag": [DEMO_BAG], "generate_srdf": [URDF, "--samples", "1000", "--searches", "1"]}


@pytest.mark.parametrize("tool", PROGRESS)
def test_progress_is_shown_on_a_terminal_and_erased(tool, tmp_path):
    rows = tmp_path / "states.csv"
    rows.write_text("shoulder_pan\n" + "0.1\n0.2\n" * 100)
    terminal, stderr = pty.openpty()
    command = [os.path.join(LIBRARY, tool)] + [str(rows) if word == "FILE" else word for word in PROGRESS[tool]]
    subprocess.run(command, check=True, timeout=100, stdout=subprocess.DEVNULL, stderr=stderr,
                   env=dict(os.environ, ROS_PACKAGE_PATH=PROJECT + ":/usr/share"))
    os.close(stderr)
    shown = os.read(terminal, 1 << 16).decode()
    drawn = re.findall(r"\r\033\[K(.*?) \[(#* *)\] (\d+) % ", shown)
    assert drawn and "\r\033[K" in shown.rsplit("%", 1)[1], shown
    for title, line, percent in drawn:
        assert title and len(line) == 40 and line.count("#") == 40 * int(percent) // 100 and int(percent) <= 100


DEFAULTS = {
    "check_states": "voxel-size=0 fidelity=mesh broad-phase=auto alarm-distance=0 tolerance=0 time-budget=0 max-hull-vertices=0 threads=0",
    "check_motion": "voxel-size=0 fidelity=mesh clearance=0 resolution=0.001 threads=0",
    "check_bag": "fidelity=mesh broad-phase=auto alarm-distance=0.05 tolerance=0",
    "generate_srdf": "samples=50000 seed=1 threads=0 confidence=0.99 max-probability=0.0001 clearance=0 searches=20 "
                     "narrow-phase=native",
    "merge_bag_checks": "alarm-distance=0.05 max-gap=1"}
BEGINS = {
    "check_states": "Checks recorded joint states of a robot for collisions.\n\nUsage: check_states ROBOT.urdf --states STATES.csv "
                    "[OPTIONS]\n  ROBOT.urdf: the robot's URDF\n\nOptions:\n",
    "check_bag": "Checks the motion of a robot in recorded bags for collisions.\n\nUsage: check_bag BAG... [OPTIONS]\n"
                 "  BAG...: the bags to check\n\nOptions:\n"}


@pytest.mark.parametrize("tool", DEFAULTS)
def test_defaults_are_printed_as_they_are_written(run_tool, tool):
    said = run_tool(tool, "--help").stdout
    assert " ".join("%s=%s" % each for each in re.findall(r"--([a-z-]+) \S+ \(=(\S+)\)", said)) == DEFAULTS[tool]
    assert said.startswith(BEGINS.get(tool, "")), said


def test_an_option_is_suggested_for_two_edits_and_not_for_three(refused):
    words = "error: unrecognised option '%s'%s; see check_states --help\n"
    for given, near in (("--stat", "; did you mean '--states'?"), ("--sta", ""), ("--verdict", ""), ("--tolerances", "; did you mean "
                                                                                                    "'--tolerance'?")):
        assert refused("check_states", URDF, "--states", "x", given) == words % (given, near)


def test_a_count_below_zero_is_refused_in_these_words(refused):
    for tool, option in (("generate_srdf", "--samples"), ("generate_srdf", "--threads"), ("check_states", "--threads")):
        assert refused(tool, URDF, option, "-1") == "error: %s -1: must be 0 or more; see %s --help\n" % (option, tool)


@pytest.mark.parametrize("command, says", [
    (["check_states", URDF], "'--states' is required"), (["check_states", URDF, "--states"], "argument for option '--states'"),
    (["check_states", "--states", "x"], "ROBOT.urdf is missing"), (["check_bag"], "BAG... is missing"),
    (["check_states", URDF, "two.urdf", "--states", "x"], "'two.urdf': only one ROBOT.urdf"),
    (["check_states", URDF, "--states", "x", "--states", "y"], "'--states' cannot be specified more than once"),
    (["check_states", URDF, "--states", "x", "--fidelty", "obb"], "'--fidelty'; did you mean '--fidelity'?"),
    (["check_states", URDF, "--stat", "x"], "unrecognised option '--stat'; did you mean '--states'?"),  # no abbreviations
    (["check_states", URDF, "--states", "x", "--cloud", "y"], "--cloud requires --voxel-size"),
    (["check_states", URDF, "--states", "x", "--voxel-size", "1"], "--voxel-size requires --cloud"),
    (["check_states", URDF, "--states", "x", "--min-distance=no"], "'--min-distance' does not take"),
    (["check_states", URDF, "--states", "x", "--links"], "argument for option '--links'"),
    (["generate_srdf", URDF, "-x"], "'-x'"), (["merge_bag_checks"], "TABLE.csv... is missing")])
def test_a_wrong_command_line_is_refused_by_name_with_the_way_to_help(refused, command, says):
    said = refused(*command)
    assert says in said and said.endswith("see %s --help\n" % command[0]), said


@pytest.mark.parametrize("value", ["far", "1x", "", "1e999", "0x", "1,5", "--", "1 2"])
def test_a_word_that_is_no_number_is_refused_with_its_option(refused, value):
    assert "--tolerance" in refused("check_states", URDF, "--states", "x", "--tolerance", value)


@pytest.mark.parametrize("value", ["-1", "-0", "1.5", "x", "", " 1", "18446744073709551616", "1e3"])
def test_what_is_no_count_is_refused_and_never_wraps_around(refused, value):
    for option in ("--threads", "--samples", "--seed", "--searches"):
        assert option in refused("generate_srdf", URDF, option, value)


@pytest.mark.parametrize("option", [["--alarm-distance", "-1"], ["--alarm-distance=-1"], ["--alarm-distance", "-1e-3"]])
def test_a_negative_number_is_the_value_of_the_option_before_it(refused, option):
    assert "--alarm-distance must be a finite number" in refused("check_states", URDF, "--states", "x", *option)


def test_a_value_may_begin_with_a_dash(refused):
    for option in (["--states", "-s.csv"], ["--states=-s.csv"]):
        assert "-s.csv: cannot be opened" in refused("check_states", URDF, *option)
    assert "--a.csv: cannot be opened" in refused("merge_bag_checks", "--", "--a.csv")


@pytest.mark.parametrize("words", [
    ["--links", "first", "second", "--", URDF], ["--links", "first", "second", "--tolerance", "0", URDF],
    [URDF, "--links", "first", "--tolerance", "0", "--links", "second"], ["--", URDF]])
def test_several_words_of_an_option_end_at_the_next_option_or_two_dashes(refused, tmp_path, words):
    said = refused("check_states", "--states", tmp_path / "none.csv", *words)
    assert ("'first'" in said) if "--links" in words else ("none.csv" in said), said


def test_a_long_word_is_cut_and_control_bytes_are_not_printed(refused):
    for words in (["--" + 100000 * "y"], ["--tolerance", 100000 * "y"], [100000 * "y"]):
        assert len(refused("check_states", URDF, "--states", "x", *words)) < 1100
    for words in (["--a\x1b[31mb"], ["--tolerance", "a\x1b[31mb"], ["a\x1b[31mb\n"]):
        assert re.search(r"[\x00-\x09\x0b-\x1f]", refused("check_states", URDF, "--states", "x", *words)) is None
