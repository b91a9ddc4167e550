"""Programs of many test files: ctest runs the tests of one, and no test is left out."""
import glob
import os
import re
import subprocess

import pytest
from conftest import PROJECT, TOOLS

with open(os.path.join(PROJECT, "cmake/tests.cmake"), encoding="utf-8") as file:
    REGISTERED = re.findall(r"^collision_pairs_test\((\w+)(?: (\w+))?\)", file.read(), re.MULTILINE)
LIBRARIES = sorted({library or "collision_pairs" for _, library in REGISTERED})


def program_of(library):
    return os.path.join(TOOLS, "unit_tests_of_" + library)


# Nothing that is started here writes over the results of the tests themselves.
@pytest.fixture(autouse=True)
def no_results(monkeypatch):
    monkeypatch.delenv("GTEST_OUTPUT", raising=False)


def listed_in(*command):
    """As gtest lists them: "Suite.", and the tests of the suite below, indented."""
    done = subprocess.run([*command, "--gtest_list_tests"], stdout=subprocess.PIPE, text=True, check=True, timeout=60)
    suite, tests = "", []
    for line in done.stdout.splitlines():
        word = line.split("#")[0].strip()
        if not line.startswith(" "):
            suite = word
        else:
            tests.append(suite + word)
    return tests


@pytest.mark.parametrize("library", LIBRARIES)
def test_each_test_is_that_of_one_file(library):
    if not os.path.exists(program_of(library)):
        pytest.skip("skipped: %s is not built" % program_of(library))
    of_files = []
    for name, its_library in REGISTERED:
        if (its_library or "collision_pairs") == library:
            tests = listed_in(program_of(library), "test_" + name)
            assert tests, name
            of_files += tests
    assert sorted(of_files) == sorted(listed_in(program_of(library)))


def test_a_file_that_is_not_there_is_an_error():
    program = program_of(LIBRARIES[0])
    if not os.path.exists(program):
        pytest.skip("skipped: %s is not built" % program)
    done = subprocess.run([program, "test_no_such_file"], stderr=subprocess.PIPE, text=True, timeout=60, check=False)
    assert done.returncode == 1 and "no test in a file test_no_such_file.cpp" in done.stderr


def test_each_file_of_tests_is_registered_and_its_names_are_in_a_namespace_of_its_own():
    with open(os.path.join(PROJECT, "cmake/tests.cmake"), encoding="utf-8") as file:
        text = file.read()
    for path in glob.glob(os.path.join(PROJECT, "test", "test_*.cpp")):
        name = os.path.basename(path)[len("test_"):-len(".cpp")]
        assert re.search(r"collision_pairs_test(_alone)?\(%s\b" % name, text), name + " is in no program"
        if name in dict(REGISTERED):  # others may have the same names
            with open(path, encoding="utf-8") as file:
                assert re.search(r"^namespace collision_pairs::test_%s \{" % name, file.read(), re.MULTILINE), name
