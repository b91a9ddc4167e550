"""What becomes of the tables of check_bag: parts put together, and the page for a browser."""
import base64
import re
import shutil
import subprocess

import pytest
from conftest import DEMO_BAG


def run_parts(run_tool, tmp_path, count, *arguments):
    parts = [tmp_path / ("part%d.csv" % i) for i in range(1, count + 1)]
    for i, part in enumerate(parts, 1):
        done = run_tool("check_bag", *arguments, "--shard", "%d/%d" % (i, count), "--out", part)
        assert done.returncode == 0, done.stderr
    return parts


def test_parts_of_other_options_or_of_changed_files_are_not_merged(run_tool, tmp_path):
    settings = tmp_path / "settings.yaml"
    others = (["--settings", settings, "--alarm-distance", "0.1"], ["--settings", settings, "--verdict-only"],
              ["--settings", settings, "--fidelity", "obb"], [])
    for arguments in ([], *others):
        settings.write_text("max_pose_age: 1\n")
        first, second = run_parts(run_tool, tmp_path, 2, DEMO_BAG, *arguments)
        for changed in [other for other in others if other != arguments] + [arguments] * (settings in arguments):
            settings.write_text("max_pose_age: 2\n")
            assert run_tool("check_bag", DEMO_BAG, *changed, "--shard", "2/2", "--out", second).returncode == 0
            done = run_tool("merge_bag_checks", first, second, "--out", tmp_path / "merged.csv")
            assert done.returncode == 2 and not (tmp_path / "merged.csv").exists(), (arguments, changed)
            assert "is a part of another run: its options are " in done.stderr
            assert all(word in done.stderr for word in changed[-1:] + arguments[-1:]), (changed, arguments, done.stderr)


def test_the_order_of_options_and_the_name_of_the_output_make_no_other_run(run_tool, tmp_path):
    options = [["--tolerance", "0.01"], ["--verdict-only"], ["--max-gap", "2"]]
    parts = [tmp_path / "a.csv", tmp_path / "b.csv"]
    for i, (part, groups) in enumerate(zip(parts, (options, options[::-1])), 1):
        words = [word for group in groups for word in group]
        assert run_tool("check_bag", DEMO_BAG, *words, "--out", part, "--shard", "%d/2" % i).returncode == 0
    assert run_tool("merge_bag_checks", *parts, "--out", tmp_path / "merged.csv").returncode == 0


@pytest.mark.parametrize("count", [1, 2, 3, 7])
def test_parts_merge_to_the_bytes_of_one_run(run_tool, make_bag, tmp_path, count):
    bags = [DEMO_BAG, make_bag("second.bag", "--rate", "1.5"), make_bag("third.bag", "--rate", "3")]
    whole, merged = tmp_path / "whole.csv", tmp_path / "merged.csv"
    one = run_tool("check_bag", *bags, "--out", whole)
    parts = run_parts(run_tool, tmp_path, count, *bags)
    done = run_tool("merge_bag_checks", *reversed(parts), "--out", merged)
    assert done.returncode == 0, done.stderr
    assert merged.read_bytes() == whole.read_bytes()
    assert done.stdout == one.stdout
    assert run_tool("merge_bag_checks", *parts).stdout == whole.read_text()


def test_tables_of_single_bags_merge_to_the_bytes_of_one_run(run_tool, make_bag, tmp_path):
    bags = [make_bag("a.bag", "--rate", "3"), make_bag("b.bag", "--rate", "2")]
    tables = [tmp_path / "a.csv", tmp_path / "b.csv"]
    for bag, table in zip(bags, tables):
        run_tool("check_bag", bag, "--out", table)
    run_tool("check_bag", *bags, "--out", tmp_path / "whole.csv")
    run_tool("merge_bag_checks", *tables, "--out", tmp_path / "merged.csv")
    assert (tmp_path / "merged.csv").read_bytes() == (tmp_path / "whole.csv").read_bytes()


def test_a_merge_that_is_not_complete_is_refused(run_tool, make_bag, tmp_path):
    bag = make_bag("a.bag", "--rate", "3")
    one, two, three = run_parts(run_tool, tmp_path, 3, bag)
    other = tmp_path / "other"
    other.mkdir()
    stranger = run_parts(run_tool, other, 3, make_bag("b.bag", "--rate", "2"))[2]
    cut = tmp_path / "cut.csv"
    cut.write_bytes(three.read_bytes()[:-200])
    lines = three.read_text().splitlines(keepends=True)
    rows = [i for i, line in enumerate(lines) if line.startswith(str(bag))]
    twice = tmp_path / "twice.csv"
    twice.write_text("".join(lines[rows[0]] if i == rows[1] else line for i, line in enumerate(lines)))
    misspelt = tmp_path / "misspelt.csv"
    misspelt.write_text(three.read_text().replace(",free", ",fre"))
    assert misspelt.read_text() != three.read_text()
    whole = tmp_path / "whole.csv"
    run_tool("check_bag", bag, "--out", whole)
    merged = tmp_path / "merged.csv"
    for tables, says in (((one, two), "3/3 is missing"), ((one, three), "2/3 is missing"), ((one, one, two), "twice"),
                         ((one, two, stranger), "another run"), ((one, two, cut), "cut.csv"),
                         ((one, two, twice), "is missing"), ((one, two, misspelt), "'fre' is not a verdict"),
                         ((one, whole), "mixed"), ((one, two, bag), "a.bag"),
                         ((tmp_path / "none",), "none")):
        done = run_tool("merge_bag_checks", *tables, "--out", merged)
        assert done.returncode == 2 and says in done.stderr and len(done.stderr.splitlines()) == 1, done.stderr
        assert not merged.exists()


HEADER = "bag,state,stamp,in_collision,pairs,min_distance,nb_pairs,distances,left_out,verdict,unknown_because"


def table_of(bag, rows):
    """Of (seconds, verdict, {pair: (distance, in contact)}, links left out)."""
    lines = []
    for state, (seconds, verdict, pairs, left_out) in enumerate(rows):
        closest = "%r" % min(distance for distance, _ in pairs.values()) if pairs else ""
        lines.append(",".join([
            bag, str(state), "%.9f" % seconds, "01"[verdict != "free"],
            ";".join(pair for pair, (_, touches) in pairs.items() if touches), closest, "7",
            ";".join("%s=%r" % (pair, distance) for pair, (distance, _) in pairs.items()), ";".join(left_out), verdict,
            "no pose" if verdict == "unknown" else ""]))
    return "".join(line + "\n" for line in lines)


def summary_of(run_tool, tmp_path, tables, *options):
    table, merged = tmp_path / "table.csv", tmp_path / "merged.csv"
    table.write_text(HEADER + "\n" + "".join(tables))
    done = run_tool("merge_bag_checks", table, "--out", merged, *options)
    assert done.returncode == 0 and done.stderr == "", done.stderr
    assert merged.read_text() == table.read_text()
    return done.stdout


def test_the_summary_of_a_table_is_these_lines(run_tool, tmp_path):
    one = table_of("one.bag", [
        (100.0, "free", {"a|b": (0.01, False)}, []),
        (100.5, "collision", {"a|b": (-0.002, True), "c|d": (0.03, False)}, []),
        (101.25, "unknown", {}, ["e", "f"]),
        (102.0, "free", {}, []),
        (103.5, "collision", {"a|b": (-0.005, True), "c|d": (-0.001, True)}, []),
        (103.75, "collision", {"c|d": (-0.001, True)}, []),
        (106.25, "unknown", {"c|d": (0.02, False)}, ["e"]),  # after a gap
        (108.25, "free", {"a|b": (0.04, False)}, [])])  # after just as long as is none
    assert summary_of(run_tool, tmp_path, [one, table_of("two.bag", [(5.0, "free", {}, [])])], "--max-gap", "2") == """\
one.bag: 8 stamps over 8.250 s
  in contact        1.000 s, 3 stamps
  unknown           2.750 s, 2 stamps
  near only         0.500 s
  closest         -0.0050 m at +3.500 s
  closest approach of each pair:
      -0.0050 m at +3.500 s  a|b  (in contact 1.000 s)
      -0.0010 m at +3.500 s  c|d  (in contact 0.250 s)
  gaps longer than 2 s:
    2.500 s after +3.750 s
  left out (no pose; clouds: too old or incomplete):
    e  at 2 stamps
    f  at 1 stamps
two.bag: 1 stamps over 0.000 s
  in contact        0.000 s, 0 stamps
  unknown           0.000 s, 0 stamps
  near only         0.000 s
  closest       beyond the alarm distance (--min-distance finds it)
  no gap longer than 2 s
"""


def test_no_time_passes_where_stamps_go_back(run_tool, tmp_path):
    """As where no pose is known at first, and the rows have the times of the recording."""
    back = table_of("back.bag", [
        (5100.0, "unknown", {}, ["e"]), (100.0, "free", {}, []), (100.5, "collision", {"a|b": (-0.002, True)}, []),
        (101.5, "free", {}, [])])
    said = summary_of(run_tool, tmp_path, [back], "--max-gap", "2")
    for line in ("4 stamps over 5000.000 s", "unknown           0.000 s, 1 stamps", "in contact        1.000 s, 1 stamps",
                 "closest         -0.0020 m at +0.500 s", "    back by 5000.000 s after +5000.000 s\n"):
        assert line in said, said


def test_a_bag_that_comes_twice_is_summed_up_twice(run_tool, tmp_path):
    once = table_of("one.bag", [(100.0 + 0.25 * i, "free", {"a|b": (0.01, False)}, []) for i in range(9)])
    summary = summary_of(run_tool, tmp_path, [once])
    assert "near only         2.000 s" in summary
    assert summary_of(run_tool, tmp_path, [once, once]) == 2 * summary


@pytest.mark.parametrize("seconds", ["nan", "-1", "0", "inf"])
def test_a_gap_is_a_finite_number_above_0(run_tool, tmp_path, seconds):
    (tmp_path / "table.csv").write_text(HEADER + "\n" + table_of("one.bag", [(1.0, "free", {}, [])]))
    done = run_tool("merge_bag_checks", tmp_path / "table.csv", "--max-gap", seconds)
    assert done.returncode == 2 and done.stderr.startswith("error: --max-gap must be a finite number, above 0")


@pytest.mark.parametrize("count", [20, 22])
def test_of_pairs_gaps_and_links_twenty_are_listed_and_the_rest_is_counted(run_tool, tmp_path, count):
    pairs = {"a|b%02d" % i: (0.001 * i, False) for i in range(count)}
    rows = [(10.0 + 2 * i, "unknown", pairs, ["l%02d" % k for k in range(count)]) for i in range(count + 1)]
    said = summary_of(run_tool, tmp_path, [table_of("many.bag", rows)], "--max-gap", "1.5")
    for line in (r"      \+0\.0\d\d0 m at \+0\.000 s  a\|b\d\d", r"    2\.000 s after \+\d+\.000 s", r"    l\d\d  at %d stamps" % (count + 1)):
        listed = re.findall("^" + line + "$", said, re.MULTILINE)
        assert len(listed) == 20 and listed == sorted(listed, key=lambda text: (len(text), text)), said
    assert said.count("    and 2 more\n") == said.count(" more") == (3 if count == 22 else 0)


ROW = "a.bag,1,100.000000000,1,a|b,-0.01,3,a|b=-0.01;c|d=0.5,e;f,collision,"
BROKEN = [  # the column, what it becomes, why it is refused
    (1, "x", "'x' is not a number"), (1, "-1", "'-1' is not a number"), (1, "1.0", "'1.0' is not a number"),
    (1, "", "'' is not a number"), (2, "100", "'100' is not a stamp"), (2, "100.12345678", "'100.12345678' is not a stamp"),
    (2, "100.1234567890", "'100.1234567890' is not a stamp"), (2, "x.000000000", "'x' is not a number"),
    (2, "1.00000000x", "'00000000x' is not a number"), (5, "near", "'near' is not a number"), (6, "3x", "'3x' is not a number"),
    (7, "a|b", "'a|b' is not a distance of a pair"), (7, "a|b=0;c|d=far", "'far' is not a number"),
    (9, "fre", "'fre' is not a verdict"), (9, "", "'' is not a verdict"), (9, "free,", "it has 12 fields, not 11"),
    (10, '"', "a quotation mark is not closed")]


def refusal(run_tool, tmp_path, *tables):
    """Of the tables table0.csv, ... with these lines after the header."""
    paths = [tmp_path / ("table%d.csv" % i) for i in range(len(tables))]
    for path, lines in zip(paths, tables):
        path.write_text("\n".join([HEADER, *lines]) + "\n")
    done = run_tool("merge_bag_checks", *paths, "--out", tmp_path / "out.csv")
    assert done.returncode == 2 and not (tmp_path / "out.csv").exists()
    return done.stderr.replace("error: %s/" % tmp_path, "")


def test_what_is_wrong_with_a_row_is_said_with_its_line(run_tool, tmp_path):
    good = ROW.split(",")
    assert summary_of(run_tool, tmp_path, [ROW + "\n"]).startswith("a.bag: 1 stamps")
    for column, becomes, why in BROKEN:
        bad = good[:column] + [becomes] + good[column + 1:]
        assert refusal(run_tool, tmp_path, [ROW, ",".join(bad)]) == "table0.csv line 3: %s\n" % why
    assert refusal(run_tool, tmp_path, [ROW, ",".join(good[1:])]) == "table0.csv line 3: it has 10 fields, not 11\n"


def test_what_is_wrong_with_a_part_is_said_with_its_line(run_tool, tmp_path):
    for part in ("# part 1", "# part 0/2", "# part 3/2", "# part 1/2x", "# part x/2", "#"):
        assert refusal(run_tool, tmp_path, [part]) == "table0.csv line 2: '%s' does not say which part it is\n" % part
    row = ROW.replace(",1,", ",0,", 1)
    bag = "# bag a.bag 1"
    for line in ("# bog a.bag 1", "# bag a.bag", "# bag  1", "# bag a.bag x", "# bag a.bag 2", "# bag b.bag 1", "# end"):
        assert refusal(run_tool, tmp_path, ["# part 1/1", row, line]) == (
            "table0.csv line 4: '%s' does not end a bag of 1 rows\n" % line)
    for lines, where in (([], 2), ([row], 3), ([row, bag], 4)):
        assert refusal(run_tool, tmp_path, ["# part 1/1"] + lines) == (
            "table0.csv line %d: it is incomplete; its process may have been stopped\n" % where)
    for lines, where in (([ROW], 0), ([row, ROW.replace("a.bag", "b.bag")], 1), ([row, row], 1)):
        assert refusal(run_tool, tmp_path, ["# part 1/1", *lines, "# bag a.bag 2", "# end"]) == (
            "table0.csv line %d: state %d is missing; is it a part of another run?\n" % (2 + len(lines), where))
    end = ["# end"]
    assert refusal(run_tool, tmp_path, ["# part 1/1", *end, row]) == "table0.csv line 4: '%s' after its end\n" % row
    assert refusal(run_tool, tmp_path, ["# part 1/2", row, bag, "# end"], ["# part 2/2", "# bag b.bag 1", "# end"]) == (
        "table0.csv line 4: is a part of another run (expected '# bag b.bag 1')\n")
    assert refusal(run_tool, tmp_path, ["# part 1/2"] + end, ["# part 2/3"] + end) == (
        "table1.csv line 2: is a part of another run\n")
    assert refusal(run_tool, tmp_path, ["# part 2/2"] + end, ["# part 2/2"] + end).endswith("part 1/2 is missing\n")
    assert refusal(run_tool, tmp_path, ["# part 1/2"] + end, ["# part 1/2"] + end) == "table1.csv line 2: this part is given twice\n"
    assert refusal(run_tool, tmp_path, ["# part 1/3"] + end, ["# part 2/3"] + end).endswith("part 3/3 is missing\n")


@pytest.fixture
def page(run_tool, tmp_path):
    folder = tmp_path / "report"
    done = run_tool("check_bag", DEMO_BAG, "--report", folder)
    assert done.returncode == 0, done.stderr
    assert [path.name for path in folder.iterdir()] == ["index.html"]
    return folder / "index.html"


def test_the_page_needs_no_other_file_and_names_the_closest_pair(page):
    text = page.read_text()
    assert set(re.findall(r'(?:src|href)="([^,"]*)', text)) <= {"data:image/png;base64", "data:"}
    assert "http" not in re.sub(r'base64,[^"]*', "", text)
    assert text.count("<img") == 2 and "ball – right_finger" in text


def test_the_page_fits_a_phone(page):
    """Of what is wider than a phone there is a narrow form, or it is scrolled by itself."""
    text = page.read_text()
    assert '<meta name="viewport" content="width=device-width' in text
    narrow = re.search(r"^@media \(max-width: 40em\) \{\n(.*?)^\}", text, re.MULTILINE | re.DOTALL).group(1)
    assert "tr { display: flex; flex-wrap: wrap" in narrow and "th { display: none }" in narrow, "rows are folded there"
    images = re.findall(r"<(source|img) [^>]*?(?:srcset|src)=\"data:image/png;base64,([^\"]+)", text)
    widths = [(kind, int.from_bytes(base64.b64decode(data)[16:20], "big")) for kind, data in images]
    assert [kind for kind, _ in widths] == ["source", "img", "img"]
    assert widths[0][1] <= 600 < widths[1][1]
    assert '<div class="wide"><img' in text


def test_a_browser_opens_the_page_without_a_word_on_its_console(page, tmp_path):
    browser = shutil.which("chromium")
    if not browser:
        pytest.skip("no chromium")
    done = subprocess.run([browser, "--headless", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr",
                           "--user-data-dir=%s" % (tmp_path / "profile"), "--dump-dom", page.as_uri()],
                          timeout=120, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert "Contacts and near pairs" in done.stdout
    assert "CONSOLE" not in done.stderr


def test_a_page_is_made_of_merged_parts_and_of_bags_without_anything_near(run_tool, make_bag, tmp_path):
    bag = make_bag("a.bag", "--rate", "3")
    parts = run_parts(run_tool, tmp_path, 2, bag)
    done = run_tool("merge_bag_checks", *parts, "--report", tmp_path / "merged")
    assert done.returncode == 0 and not done.stdout.startswith("bag,"), done.stderr
    done = run_tool("check_bag", bag, "--report", tmp_path / "whole")
    assert (tmp_path / "merged/index.html").read_text() == (tmp_path / "whole/index.html").read_text()
    done = run_tool("check_bag", bag, "--alarm-distance", "0", "--report", tmp_path / "zero")
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("folder_is_there", [False, True])
def test_a_report_that_fails_leaves_no_folder_that_was_not_there(run_tool, tmp_path, folder_is_there):
    folder = tmp_path / "report"
    if folder_is_there:
        folder.mkdir()
    broken = tmp_path / "table.csv"
    broken.write_text("no table")
    done = run_tool("merge_bag_checks", broken, "--report", folder)
    assert done.returncode == 2 and folder.exists() == folder_is_there
    assert not folder_is_there or not list(folder.iterdir())


def test_where_table_and_summary_go(run_tool, tmp_path):
    table = tmp_path / "table.csv"
    whole = HEADER + "\n" + table_of("a.bag", [(1.0, "free", {"a|b": (0.25, False)}, [])])
    table.write_text(whole)
    summary = run_tool("merge_bag_checks", table).stderr
    assert summary.startswith("a.bag: 1 stamps")
    file, report = ["--out", tmp_path / "out.csv"], ["--report", tmp_path / "report"]
    for options, stdout, stderr in (([], whole, summary), (["--out", "-"], whole, summary), (file, summary, ""),
                                    (report + ["--out", "-"], whole, summary)):
        done = run_tool("merge_bag_checks", table, *options)
        assert (done.returncode, done.stdout, done.stderr) == (0, stdout, stderr), options
        assert (tmp_path / "out.csv").exists() == (options == file)
        if options == file:
            assert (tmp_path / "out.csv").read_text() == whole
            (tmp_path / "out.csv").unlink()
    done = run_tool("check_bag", DEMO_BAG, "--record", tmp_path / "recorded.bag")
    assert done.stdout.startswith(DEMO_BAG + ": ") and done.stderr == "", "what is recorded needs no table"


def test_the_page_is_made_with_the_alarm_distance_and_the_gap_of_the_options(run_tool, tmp_path):
    rows = [(seconds, "free", {}, []) for seconds in (1.0, 2.125, 3.5)]
    (tmp_path / "table.csv").write_text(HEADER + "\n" + table_of("a.bag", rows))
    options = ["--alarm-distance", "0.375", "--max-gap", "1.25", "--report", tmp_path / "report"]
    done = run_tool("merge_bag_checks", tmp_path / "table.csv", *options)
    assert (done.returncode, done.stderr) == (0, "") and done.stdout.startswith("a.bag: 3 stamps"), "and no table"
    text = (tmp_path / "report/index.html").read_text()
    assert "No pair came within the alarm distance of 0.375 m." in text
    assert re.findall("no data for .*? s after .*? s", text) == ["no data for 1.375 s after 1.125 s"]
