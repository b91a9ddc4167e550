"""What users rely on by name stays: the recorded list is what is there, and the release is called the same everywhere."""
import importlib.machinery
import importlib.util
import os
import re
import xml.etree.ElementTree as ElementTree

import pytest
from conftest import PROJECT, TOOLS

import collision_pairs as cp


def recorder():
    path = os.path.join(PROJECT, "scripts/record_public_names")
    loader = importlib.machinery.SourceFileLoader("record_public_names", path)
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("record_public_names", loader))
    loader.exec_module(module)
    return module


def read(path):
    with open(os.path.join(PROJECT, path), encoding="utf-8") as file:
        return file.read()


def test_no_public_name_is_taken_away_and_new_ones_are_recorded():
    there, recorded = set(recorder().public_names(TOOLS)), set(read("docs/data/public_names.txt").splitlines())
    gone, new = sorted(recorded - there), sorted(there - recorded)
    assert gone == [], "taken away or changed: restore it, or say so in CHANGELOG.rst and run scripts/record_public_names"
    assert new == [], "run scripts/record_public_names"


def test_the_list_has_names_of_each_kind_that_the_page_promises():
    recorded = read("docs/data/public_names.txt")
    for line in ("CollisionPairs: uint8 UNKNOWN=2", "CheckCollisions request: bool verdict_only", "topic ~in_collision",
                 "service ~update_scene", "parameter ~alarm_distance: 0.05", "parameter ~clouds/source_timeout",
                 "parameter ~velocity_limiter/stop_distance", "argument collision_pairs.launch/overlay:=",
                 "option check_bag --out", "column check_bag unknown_because", "column check_states min_distance",
                 "column check_motion contact_at", "CMake target collision_pairs::core", "plugin CollisionPairs",
                 "check_settings.h: CheckSettings: double time_budget",
                 "collision_pairs.Detector.__init__(scene", "collision_pairs.watchdog.Watchdog"):
        assert re.search("^%s" % re.escape(line), recorded, re.MULTILINE), line


def test_of_a_header_the_public_part_is_listed_and_nothing_else():
    text = """
    #pragma once
    // class Comment { void no(); };
    namespace n {
    class Forward;
    struct A {
      /// Says; with braces {}.
      double x = 1.0, y;
      explicit A(int i = f({})) : x(i) { if (i) { x = 2; } }
      bool operator==(const A& other) const { return x == other.x; }
     private:
      int hidden_;
      void hide();
    };
    enum class E : char { ONE = 1, TWO };
    inline int f(const B& b) { return 0; }
    template <class T> T g(T t);
    constexpr int SIZE = 3;
    namespace detail { void internal(); }
    }  // namespace n
    class C {
      int also_hidden_;
     public:
      static C make();
      ~C() = default;
    };"""
    names = recorder()
    found = [scope + ": " + line for scope, line in names.declarations(names.without_comments(text), "")]
    assert found == [": struct A", "struct A: double x", "struct A: A(int i = f({}))",
                     "struct A: bool operator==(const A& other) const", "enum E: ONE = 1", "enum E: TWO",
                     ": int f(const B& b)", ": template <class T> T g(T t)", ": int SIZE", ": class C",
                     "class C: static C make()", "class C: ~C()"]


def test_the_version_is_the_same_everywhere():
    package = ElementTree.fromstring(read("package.xml")).find("version").text
    cmake = re.search(r"^project\(collision_pairs VERSION ([\d.]+) ", read("CMakeLists.txt"), re.MULTILINE).group(1)
    released = re.search(r"^(\d+\.\d+\.\d+) \(\d{4}-\d\d-\d\d\)\n-+$", read("CHANGELOG.rst"), re.MULTILINE).group(1)
    assert package == cmake == released == cp.__version__


def test_the_newest_release_is_read_in_two_minutes():
    """What it is, can and cannot, at 200 words a minute; what only users of an earlier commit need comes after it."""
    newest = re.search(r"^\d+\.\d+\.\d+ \(.*?\)\n-+\n(.*?)\*\*For users of an earlier", read("CHANGELOG.rst"), re.MULTILINE | re.DOTALL)
    assert len(newest.group(1).split()) <= 400
    assert re.findall(r"^\*\*(.*)\*\*$", newest.group(1), re.MULTILINE) == ["What it is", "What it can", "What it cannot"]


def test_the_changelog_is_one_that_catkin_reads():
    changelog = pytest.importorskip("catkin_pkg.changelog")
    pytest.importorskip("docutils")
    versions = [version for version, _, _ in changelog.get_changelog_from_path(os.path.join(PROJECT, "CHANGELOG.rst")).foreach_version()]
    assert versions[-1] == cp.__version__
