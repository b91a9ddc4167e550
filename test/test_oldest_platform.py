"""Nothing is used that Ubuntu 20.04 lacks: GCC 9, CMake 3.16, Python 3.8. Only newer ones may be at hand to build with."""
import ast
import os
import re

import pytest
from conftest import PROJECT

# Pattern: who has it first. GCC 9 with -std=c++17 refuses most of C++20 itself; these would pass unseen on a newer one.
CXX = {
    r"#include <(bit|compare|concepts|coroutine|ranges|numbers|span|source_location|latch|barrier|semaphore|stop_token"
    r"|format|expected|syncstream)>": "C++20",
    r"\[\[(un)?likely\]\]": "C++20",
    r"__builtin_bit_cast|__has_builtin": "GCC 10 or 11",
    r"_mm(256|512)?_(loadu|storeu)_epi(8|16|32|64)\b": "GCC 10 or 11",
    r"Eigen::(seq|seqN|placeholders|last|all)\b|\.reshaped\(": "Eigen 3.4",
    r"isinstance<py(bind11)?::str>": "pybind11 2.7: before it, bytes are taken for a str"}
LAUNCH = {r"<arg [^>]*value=\"[^\"]*\$\(dirname\)": "roslaunch 1.15.14 (ros_comm issue 1487): $(find collision_pairs)"}
CMAKE = {
    r"\bcmake_path\s*\(": "3.20", r"\bcmake_language\s*\(": "3.18", r"\bblock\s*\(": "3.25", r"\bstring\s*\(\s*JSON": "3.19",
    r"\bfile\s*\(\s*(REAL_PATH|CHMOD)": "3.19", r"\bfile\s*\(\s*(CONFIGURE|ARCHIVE_)": "3.18",
    r"\bfile\s*\(\s*COPY_FILE": "3.21", r"\bfind_(library|path|file|program)\s*\([^)]*\bREQUIRED": "3.18",
    r"\bZIP_LISTS\b": "3.17", r"\bFILE_SET\b": "3.23", r"\bENVIRONMENT_MODIFICATION\b": "3.22",
    r"\bTARGET_DIRECTORY\b": "3.18", r"\bGTest::": "3.20, and GTest::gmock 3.23", r"\btinyxml2::": "not in Debian 11",
    r"\bDevelopment\.Module\b": "3.18", r"\bPROJECT_IS_TOP_LEVEL\b": "3.21", r"\bCMAKE_CURRENT_FUNCTION_": "3.17",
    r"\$<(PATH|TARGET_RUNTIME_DLLS|COMPILE_ONLY)": "3.21 or later", r"\bcheck_source_compiles\b": "3.19"}
COMMANDS = {r"ctest\b.*--test-dir": "CMake 3.20", r"ctest\b.*--output-junit": "CMake 3.21", r"cmake\b.*--preset": "CMake 3.19",
            r"cmake\b.*--fresh": "CMake 3.24", r"cmake\b.*--toolchain": "CMake 3.21", r"cmake\b.* -E (rm|cat)\b": "CMake 3.17"}
PYTHON = {r"\.remove(prefix|suffix)\(": "3.9", r"\bfunctools\.cache\b": "3.9", r"\bzip\(.*strict=": "3.10",
          r"\bpairwise\b": "3.10", r"\bmath\.(lcm|nextafter|ulp)\b": "3.9", r"\brandbytes\(": "3.9", r"\bbit_count\(": "3.10",
          r"\bset_[xy]ticks\(.*\),|layout=\"constrained\"|spines\[\[": "Matplotlib 3.4 or 3.5"}


def project_files():
    """Text files of the project, as paths in it."""
    for folder, folders, names in os.walk(PROJECT):
        folders[:] = [name for name in folders if not name.startswith((".", "build", "corpus_")) and name != "images"]
        for name in names:
            yield os.path.relpath(os.path.join(folder, name), PROJECT)


def text_of(file):
    with open(os.path.join(PROJECT, file), encoding="utf-8", errors="replace") as text:
        return text.read()


def is_python(file):
    return file.endswith(".py") or ("." not in os.path.basename(file) and "python3" in text_of(file).split("\n", 1)[0])


def is_shell(file):
    return file.endswith(".sh") or ("." not in os.path.basename(file) and "bash" in text_of(file).split("\n", 1)[0])


def files(kind):
    is_kind = {"launch": lambda file: file.endswith((".launch", ".test")), "c++": lambda file: file.endswith((".h", ".cpp")), "python": is_python, "shell": is_shell,
               "cmake": lambda file: os.path.basename(file) == "CMakeLists.txt" or file.endswith((".cmake", ".cmake.em"))}[kind]
    found = sorted(file for file in project_files() if is_kind(file))
    assert found, "no file of " + kind
    return found


def uses(kind, newer):
    """What of `newer` these files use; comments of CMake and shell apart."""
    return ["%s: %s needs %s" % (file, match.group(0), newer[pattern])
            for file in files(kind) if file != "test/test_oldest_platform.py"
            for text in [re.sub(r"(^|\s)#.*", "", text_of(file)) if kind in ("cmake", "shell") else text_of(file)]
            for pattern in newer for match in [re.search(pattern, text)] if match]


@pytest.mark.parametrize("kind, newer", [("c++", CXX), ("cmake", CMAKE), ("launch", LAUNCH), ("shell", COMMANDS),
                                         ("python", COMMANDS), ("python", PYTHON)])
def test_nothing_newer_is_used(kind, newer):
    assert uses(kind, newer) == []


def test_cmake_is_asked_for_no_more_than_3_16():
    asked = [version for file in files("cmake") for version in re.findall(r"cmake_minimum_required\(VERSION ([\d.]+)", text_of(file))]
    assert asked and set(asked) == {"3.16"}


def test_numbers_are_read_by_from_chars_only_where_the_compiler_ensures_that_they_are_whole():
    # For floating point it came with GCC 11.
    for file in files("c++"):
        text = re.sub(r"//.*", "", text_of(file))
        calls = len(re.findall(r"\b(from|to)_chars\(", text))
        assert calls <= text.count("static_assert(std::is_integral_v<"), file


def test_python_is_that_of_3_8():
    for file in files("python"):
        tree = ast.parse(text_of(file), file, feature_version=(3, 8))
        for node in ast.walk(tree):
            if isinstance(node, ast.Subscript) and isinstance(node.value, ast.Name):
                assert node.value.id not in ("list", "dict", "set", "tuple", "type"), "%s:%d" % (file, node.lineno)
