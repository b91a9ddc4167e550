"""Each script serves somebody, and starts."""
import fnmatch
import glob
import os
import re
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


@pytest.mark.parametrize("name", FILES)
def test_each_script_is_named_by_a_page_or_by_what_runs_it(name):
    stem = os.path.splitext(name)[0]
    for path in readers():
        if os.path.basename(path) == name:
            continue
        text = read(path)
        patterns = re.findall(r"`scripts/(\w+\*)`", text)
        if re.search(r"\b%s\b" % re.escape(stem), text) or any(fnmatch.fnmatch(name, pattern) for pattern in patterns):
            return
    raise AssertionError("nobody names scripts/" + name)


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


def test_a_test_that_crashed_counts_as_failed_beside_one_of_a_longer_name(tmp_path):
    (tmp_path / "python_values.xml").write_text(
        "<testsuite><testcase classname='a' name='b'><failure/></testcase><testcase classname='a' name='c'/></testsuite>")
    failed = tmp_path / "failed.log"
    failed.write_text("170:python\n177:python_values\n")
    done = subprocess.run([os.path.join(PROJECT, "scripts/count_tests.py"), tmp_path, failed], stdout=subprocess.PIPE, text=True, check=False)
    assert (done.returncode, done.stdout.splitlines()[1:]) == (1, ["failed: python ended without a result", "1 passed, 2 failed, 0 skipped"])
