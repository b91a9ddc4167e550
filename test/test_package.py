"""The Debian package: what it depends on, and, where it may take long, what is in it."""
import ast
import glob
import os
import re
import shutil
import subprocess

import pytest
from conftest import PROJECT

pytestmark = pytest.mark.skipif(shutil.which("dpkg") is None, reason="skipped: no Debian")


def read(*path):
    with open(os.path.join(PROJECT, *path), encoding="utf-8") as file:
        return file.read()


def depends_on():
    """Dependencies and recommendations that are written down; libraries are found by dpkg-shlibdeps."""
    text = read("cmake", "package.cmake")
    needed = re.search(r"set\(needed ([^)]*)\)", text).group(1).split()
    recommended = re.search(r"RECOMMENDS \"(.*)\"", text).group(1).split(", ")
    return set(needed + recommended)


def owner_of(*patterns):
    """The Debian package that has the file; nothing if it is not installed."""
    for path in (path for pattern in patterns for path in glob.glob(pattern)):
        done = subprocess.run(["dpkg", "-S", path], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, check=False)
        if done.returncode == 0:
            return done.stdout.split(":")[0]
    return ""


def installed_scripts():
    listed = re.search(r"catkin_install_python\(PROGRAMS (.*?)\bDESTINATION", read("cmake", "install.cmake"), re.DOTALL).group(1)
    return listed.split() + [os.path.relpath(path, PROJECT) for path in glob.glob(PROJECT + "/src/python/collision_pairs/*.py")]


def imports_of(file):
    for node in ast.walk(ast.parse(read(file))):
        if isinstance(node, ast.Import):
            yield from (name.name.split(".")[0] for name in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield node.module.split(".")[0]


def modules():
    """Those that installed scripts import, and those of the messages in ours."""
    names = {name for file in installed_scripts() for name in imports_of(file)}
    types = re.findall(r"^(\w+)/\w+", "\n".join(read(path) for path in glob.glob(PROJECT + "/[ms][sr][gv]/*.[ms][sr][gv]")), re.MULTILINE)
    return sorted((names | set(types)) - {"collision_pairs"})


@pytest.mark.parametrize("module", modules())
def test_modules_that_are_imported_come_with_the_package(module):
    folder = "/usr/lib/python3/dist-packages/" + module
    owner = owner_of(folder + "/__init__.py", folder + ".py")
    assert not owner or owner in depends_on(), "cmake/package.cmake does not name %s, for %s" % (owner, module)


def test_what_launch_files_start_comes_with_the_package():
    started = {name for path in glob.glob(PROJECT + "/launch/*.launch") for name in re.findall(r"pkg=\"(\w+)\"", read(path))}
    for name in started - {"collision_pairs"}:
        owner = owner_of("/usr/lib/%s/*" % name, "/usr/share/%s/package.xml" % name)
        packages = depends_on() | ({"python3-rosbag"} if owner == "rosbag" else set())
        assert not owner or owner in packages, "cmake/package.cmake does not name %s, of which a launch file starts a node" % owner


def test_what_find_package_calls_for_is_suggested():
    needed = re.search(r"CATKIN_DEPENDS ([\w\s]+?)\s+DEPENDS EIGEN3", read("cmake", "messages.cmake")).group(1).split()
    suggested = set(re.search(r"set\(to_build_with ([^)]*)\)", read("cmake", "package.cmake")).group(1).split())
    owners = {name: owner_of("/usr/share/%s/cmake/%sConfig.cmake" % (name, name), "/usr/lib/*/cmake/%s/%sConfig.cmake" % (name, name))
              for name in needed + ["catkin"]}
    assert len(owners) > 5
    for name, owner in owners.items():
        assert not owner or owner in suggested, "cmake/package.cmake does not suggest %s, which has %s" % (owner, name)
    if "" not in owners.values():  # all that scripts/test installs is there, these among it
        for name in sorted(suggested):
            status = ["dpkg-query", "-W", "-f", "${db:Status-Status}", name]
            assert subprocess.run(status, stdout=subprocess.PIPE, text=True, check=False).stdout == "installed", name


@pytest.mark.skipif("COLLISION_PAIRS_LONG" not in os.environ, reason="skipped: a build of its own (scripts/test --long)")
def test_a_package_has_all_that_is_installed_and_no_error_of_lintian(tmp_path):
    subprocess.run([os.path.join(PROJECT, "scripts/package"), str(tmp_path)], check=True, timeout=3000)
    (package,) = glob.glob(str(tmp_path / "collision-pairs_*_*.deb"))
    listed = subprocess.run(["dpkg-deb", "-c", package], stdout=subprocess.PIPE, text=True, check=True).stdout
    assert "setup.bash" not in listed
    for path in ("lib/collision_pairs/collision_pairs_node", "lib/collision_pairs/check_bag", "share/collision_pairs/launch/demo.launch",
                 "lib/python3/dist-packages/collision_pairs/__init__.py", "share/collision_pairs/package.xml",
                 "include/collision_pairs/collision_detector.h", "include/collision_pairs/CollisionPairs.h"):
        assert "./usr/" + path in listed, path
    if shutil.which("lintian"):
        done = subprocess.run(["lintian", "--fail-on", "error", package], stdout=subprocess.PIPE, text=True, check=False)
        assert done.returncode == 0, done.stdout
