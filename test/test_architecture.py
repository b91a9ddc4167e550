"""The walls of the house: which room may know which library."""
import os
import re
import subprocess

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
    assert [pair for pair in included_in("include") if not own.match(pair[1])] == []


def test_one_file_knows_fcl():
    files = {file for folder in ("include", "src") for file, what in included_in(folder) if what.startswith("fcl/")}
    assert len(files) == 1, files


def headers_below(folder):
    return {name for _, _, names in os.walk(os.path.join(PROJECT, folder)) for name in names if name.endswith(".h")}


def assert_rooms_know_only(below):
    """below: {room: the rooms whose headers it may include}."""
    headers = {room: headers_below(room) for room in below}
    for room, allowed in below.items():
        for file, what in included_in(room):
            for other in headers:
                if what in headers[other] and what not in headers[room]:
                    assert other in allowed, "%s includes %s of %s" % (file, what, other)


def test_rooms_know_only_the_rooms_below():
    assert_rooms_know_only({"src/core": set(), "src/io": {"src/core"}, "src/messages": {"src/core"},
                            "src/tools": {"src/messages", "src/io", "src/core"},
                            "src/ros": {"src/messages", "src/io", "src/core"}})


# From the ground up. Public headers lie together in include/, so a room is also asked for the files
# that implement what it includes.
CORE_ROOMS = {"base": set(), "geometry": {"base"}, "broad_phase": {"base", "geometry"},
              "narrow_phase": {"base", "geometry"}, "robot": {"base", "geometry"},
              "scene": {"base", "geometry", "broad_phase", "narrow_phase", "robot"},
              "check": {"base", "geometry", "broad_phase", "narrow_phase", "robot", "scene"},
              "pair_statistics": {"base", "geometry", "narrow_phase", "robot", "scene", "check"}}


def test_rooms_of_the_core_know_only_the_rooms_below():
    assert_rooms_know_only({"src/core/" + room: {"src/core/" + other for other in below}
                            for room, below in CORE_ROOMS.items()})


def test_public_headers_of_a_room_are_included_from_the_rooms_above_only():
    room_of = {os.path.splitext(name)[0]: room for room in CORE_ROOMS
               for name in os.listdir(os.path.join(PROJECT, "src/core", room))}
    for room, below in CORE_ROOMS.items():
        for file, what in included_in("src/core/" + room):
            if what.startswith("collision_pairs/"):
                other = room_of.get(os.path.splitext(os.path.basename(what))[0], room)
                assert other in below | {room}, "%s includes %s of %s" % (file, what, other)


def test_every_file_of_the_core_stands_in_a_room():
    assert sorted(os.listdir(os.path.join(PROJECT, "src/core"))) == sorted(CORE_ROOMS)
