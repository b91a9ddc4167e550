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
