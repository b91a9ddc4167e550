"""Dependency rules: which module may know which other and which library."""
import os
import re
import subprocess

import pytest
from conftest import PROJECT, TOOLS

LIBRARY = os.path.join(os.path.dirname(TOOLS), "libcollision_pairs.so")


def included_in(folder):
    """(file, what it includes) for every source file below a folder of the project."""
    for path, _, names in os.walk(os.path.join(PROJECT, folder)):
        for name in names:
            if name.endswith((".h", ".cpp")):
                file = os.path.join(path, name)
                for line in open(file):
                    found = re.match(r'\s*#include\s*[<"]([^>"]+)[>"]', line)
                    if found:
                        yield os.path.relpath(file, PROJECT), found.group(1)


def test_the_core_links_no_ros_library():
    needed = subprocess.run(["readelf", "-d", LIBRARY], check=True, stdout=subprocess.PIPE, text=True).stdout
    libraries = re.findall(r"\(NEEDED\).*\[(.*?)\]", needed)
    assert any(name.startswith("libfcl") for name in libraries)
    ros = re.compile(r"lib(ros|tf2?|geometric_shapes|resource_retriever|urdf\.|cpp_common|xmlrpcpp|rostime|dynamic_)")
    assert [name for name in libraries if ros.match(name)] == []


def test_the_core_includes_no_ros_header():
    ros = re.compile(r"(ros|tf2?|tf2_ros|.*_msgs|std_srvs|geometric_shapes|diagnostic_updater|dynamic_reconfigure)/")
    assert [pair for folder in ("include", "src/core") for pair in included_in(folder) if ros.match(pair[1])] == []


def test_public_headers_include_std_eigen_and_themselves_only():
    own = re.compile(r"(collision_pairs|Eigen)/|[a-z_0-9]+$")
    others = {what for _, what in included_in("include") if not own.match(what)}
    assert all(what.startswith("ompl/") for what in others), others
    assert {file for file, what in included_in("include") if what in others} == {"include/collision_pairs/ompl.h"}


def test_one_file_knows_fcl():
    files = {file for folder in ("include", "src") for file, what in included_in(folder) if what.startswith("fcl/")}
    assert len(files) == 1, files


def test_only_the_detector_for_moveit_knows_moveit():
    knowing = {file for folder in ("include", "src", "test") for file, what in included_in(folder)
               if what.startswith("moveit/")}
    assert knowing and all(file.startswith("src/planners/moveit/") for file in knowing), knowing
    # What can be tested without MoveIt stands in files without it.
    assert not knowing & {"src/planners/moveit/moveit_%s" % name
                          for name in ("octree.h", "octree.cpp", "scene.h", "scene.cpp", "shapes.h", "shapes.cpp")}


def headers_below(folder):
    return {name for _, _, names in os.walk(os.path.join(PROJECT, folder)) for name in names if name.endswith(".h")}


def assert_modules_know_only(below):
    """below: {module: the modules whose headers it may include}."""
    headers = {module: headers_below(module) for module in below}
    for module, allowed in below.items():
        for file, what in included_in(module):
            for other in headers:
                if what in headers[other] and what not in headers[module]:
                    assert other in allowed, "%s includes %s of %s" % (file, what, other)


def test_layers_know_only_the_layers_below():
    assert_modules_know_only({"src/core": set(), "src/transforms": {"src/core"}, "src/io": {"src/transforms", "src/core"},
                              "src/messages": {"src/core"},
                              "src/monitor": {"src/messages", "src/io", "src/transforms", "src/core"},
                              "src/tools": {"src/monitor", "src/messages", "src/io", "src/transforms", "src/core"},
                              "src/planners": {"src/messages", "src/core"},
                              "src/python": {"src/io", "src/transforms", "src/core"},
                              "src/ros": {"src/monitor", "src/messages", "src/io", "src/transforms", "src/core"},
                              "src/demo": {"src/ros", "src/monitor", "src/messages", "src/io", "src/transforms", "src/core"}})


def test_the_monitor_has_no_threads_clocks_or_nodes():
    threads = {"thread", "mutex", "atomic", "condition_variable"}
    foreign = {(file, what) for file, what in included_in("src/monitor")
               if what in threads or (what.startswith("ros/") and what != "ros/time.h")}
    assert not foreign, foreign
    reads_a_clock = re.compile(r"Time::now\(\)|ROS_[A-Z]+_STREAM|NodeHandle")
    for file in {file for file, _ in included_in("src/monitor")}:
        assert not reads_a_clock.search(open(os.path.join(PROJECT, file)).read()), file


def test_one_file_knows_the_buffer_of_tf2():
    files = {file for folder in ("include", "src") for file, what in included_in(folder) if what.startswith("tf2/")}
    assert files == {"src/transforms/transform_buffer.cpp"}, files


# From the ground up. Public headers lie together in include/, so a module is also asked for the
# files that implement what it includes.
CORE_MODULES = {"base": set(), "geometry": {"base"}, "broad_phase": {"base", "geometry"},
                "convex_pairs": {"base", "geometry"}, "mesh_solid": {"base", "geometry"},
                "mesh_surface": {"base", "geometry", "convex_pairs", "mesh_solid"},
                "narrow_phase": {"base", "geometry", "convex_pairs", "mesh_solid", "mesh_surface"},
                "spheres": {"geometry", "convex_pairs", "mesh_solid", "mesh_surface", "narrow_phase"},
                "robot": {"base", "geometry"},
                "scene": {"base", "geometry", "broad_phase", "convex_pairs", "narrow_phase", "spheres", "robot"},
                "clouds": {"base", "geometry", "broad_phase", "convex_pairs", "narrow_phase", "robot", "scene"},
                "pair_query": {"base", "geometry", "convex_pairs", "narrow_phase", "spheres", "robot", "scene", "clouds"},
                "check": {"base", "geometry", "broad_phase", "narrow_phase", "robot", "scene", "clouds", "pair_query"},
                "batch_model": {"base", "geometry", "broad_phase", "convex_pairs", "narrow_phase", "spheres", "robot", "scene"},
                "batch": {"base", "geometry", "broad_phase", "narrow_phase", "spheres", "robot", "scene", "pair_query", "check",
                          "batch_model"},
                "motion": {"base", "geometry", "broad_phase", "convex_pairs", "narrow_phase", "robot", "scene", "clouds",
                           "pair_query", "check", "batch_model", "batch"},
                "derivatives": {"base", "geometry", "convex_pairs", "narrow_phase", "robot", "scene", "motion"},
                "pair_statistics": {"base", "geometry", "narrow_phase", "robot", "scene", "pair_query", "check", "batch_model", "batch"},
                "limiter": {"base", "robot", "scene", "check", "motion", "derivatives", "pair_statistics"}}


def test_modules_of_the_core_know_only_the_modules_below():
    assert_modules_know_only({"src/core/" + module: {"src/core/" + other for other in below}
                              for module, below in CORE_MODULES.items()})


def test_public_headers_of_a_module_are_included_from_the_modules_above_only():
    module_of = {os.path.splitext(name)[0]: module for module in CORE_MODULES
                 for name in os.listdir(os.path.join(PROJECT, "src/core", module))}
    for module, below in CORE_MODULES.items():
        for file, what in included_in("src/core/" + module):
            if what.startswith("collision_pairs/"):
                other = module_of.get(os.path.splitext(os.path.basename(what))[0], module)
                assert other in below | {module}, "%s includes %s of %s" % (file, what, other)


def test_every_file_of_the_core_stands_in_a_module():
    assert sorted(os.listdir(os.path.join(PROJECT, "src/core"))) == sorted(CORE_MODULES)


def test_no_folder_has_more_than_twenty_files_and_no_file_more_than_400_lines():
    for path, _, names in os.walk(os.path.join(PROJECT, "src")):
        assert len(names) <= 20, path
        for name in names:
            with open(os.path.join(path, name), encoding="utf-8") as text:
                assert len(text.readlines()) <= 400, name


def test_the_drawing_of_the_modules_is_of_this_code():
    drawn = subprocess.run([os.path.join(PROJECT, "scripts/draw_modules"), "--dot"], check=True,
                           stdout=subprocess.PIPE, text=True).stdout
    with open(os.path.join(PROJECT, "docs/modules.dot")) as drawing:
        assert drawing.read() == drawn, "run scripts/draw_modules"


@pytest.mark.parametrize("header", ("motion/pair_certifier.h", "pair_query/pair_ladder.h", "check/found_pairs.h", "mesh_solid/mesh_solid.h",
                                    "mesh_surface/mesh_query.h"))
def test_the_map_of_a_folder_names_all_of_its_files(header):
    path = os.path.join(PROJECT, "src/core", header)
    with open(path) as text:
        mapped = set(re.findall(r"\b[a-z]+(?:_[a-z]+)+\b", text.read().split("#pragma once")[0]))
    files = {os.path.splitext(name)[0] for name in os.listdir(os.path.dirname(path))}
    assert files <= mapped, files - mapped
