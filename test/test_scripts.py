"""Each script serves somebody, and starts."""
import fnmatch
import glob
import os
import re
import runpy
import subprocess

import pytest
from conftest import PROJECT

FILES = sorted(name for name in os.listdir(os.path.join(PROJECT, "scripts")) if not name.startswith(("packages", "_")))


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def readers():
    """Of each text that may name a script: its path."""
    for pattern in ("README.md", "docs/*.md", "examples/*/README.md", "scripts/*", ".ci/run", "launch/*", "cmake/*", "CMakeLists.txt"):
        yield from filter(os.path.isfile, glob.glob(os.path.join(PROJECT, pattern)))


def uses(text, name):
    """Whether it names the path of this script, imports it, or sources it."""
    stem = os.path.splitext(name)[0]
    patterns = re.findall(r"`scripts/(\w+\*)`", text)
    return (re.search(r"scripts/%s(?![\w.])|[\"'/]%s(?![\w.])|(?:import|from) %s\b" % ((re.escape(name),) * 2 + (re.escape(stem),)), text)
            or any(fnmatch.fnmatch(name, pattern) for pattern in patterns))


@pytest.mark.parametrize("name", FILES)
def test_each_script_is_named_by_a_page_or_by_what_runs_it(name):
    assert any(uses(read(path), name) for path in readers() if os.path.basename(path) != name), "nobody names scripts/" + name


def test_a_word_is_not_the_name_of_a_script():
    assert uses("run `scripts/test`", "test") and uses('"$(dirname "$0")/common.sh"', "common.sh")
    assert not uses("a test of the demo: scripts/test_more", "test") and not uses("the demo", "demo")


@pytest.mark.parametrize("name", FILES)
def test_each_script_can_be_started(name):
    path = os.path.join(PROJECT, "scripts", name)
    text = read(path)
    if not text.startswith("#!/usr/bin/python3") and not name.endswith(".py"):
        assert subprocess.run(["bash", "-n", path], check=False).returncode == 0
    elif text.startswith("#!") and re.search(r"ArgumentParser\(|parser_of\(", text):
        done = subprocess.run([path, "--help"], stdout=subprocess.PIPE, text=True, timeout=60, check=False)
        assert done.returncode == 0 and "usage" in done.stdout
    else:
        compile(text, path, "exec")


BENCHMARKS = sorted(os.path.relpath(path, PROJECT) for folder in ("benchmark", "test/dynamics")
                    for path in glob.glob(os.path.join(PROJECT, folder, "*.py")))


@pytest.mark.parametrize("name", BENCHMARKS)
def test_the_folders_that_a_benchmark_names_are_there(name, monkeypatch):
    path = os.path.join(PROJECT, name)
    monkeypatch.syspath_prepend(os.path.dirname(path))
    constants = [value for word, value in runpy.run_path(path, run_name="imported").items() if word.isupper() and isinstance(value, str)]
    assert not [value for value in constants if value.startswith("/") and "/build/" not in value and not glob.glob(value + "*")]


def test_a_test_that_crashed_counts_as_failed_beside_one_of_a_longer_name(tmp_path):
    (tmp_path / "python_values.xml").write_text(
        "<testsuite><testcase classname='a' name='b'><failure/></testcase><testcase classname='a' name='c'/></testsuite>")
    failed = tmp_path / "failed.log"
    failed.write_text("170:python\n177:python_values\n")
    done = subprocess.run([os.path.join(PROJECT, "scripts/count_tests.py"), tmp_path, failed], stdout=subprocess.PIPE, text=True, check=False)
    assert (done.returncode, done.stdout.splitlines()[1:]) == (1, ["failed: python ended without a result", "1 passed, 2 failed, 0 skipped"])


def test_the_last_line_says_how_many_were_skipped_and_why(tmp_path):
    (tmp_path / "a.xml").write_text("<testsuite><testcase name='a'/><testcase name='b'><skipped message='no data'/></testcase>"
                                    "<testcase name='c'><skipped>\n no data </skipped></testcase></testsuite>")
    done = subprocess.run([os.path.join(PROJECT, "scripts/count_tests.py"), tmp_path, tmp_path / "none"], stdout=subprocess.PIPE,
                          text=True, check=False)
    assert (done.returncode, done.stdout.splitlines()[-1]) == (0, "1 passed, 0 failed, 2 skipped (no data)")
