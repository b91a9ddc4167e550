"""No dependency in name only: what package.xml and scripts/packages.txt ask for is used by code of this package."""
import functools
import os
import re
import shutil
import subprocess
import xml.etree.ElementTree

import pytest

PROJECT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
FOLDERS = ("cmake", "config", "examples", "include", "launch", "scripts", "src", "test", "CMakeLists.txt", "plugins")
# What package.xml calls by another name than Debian.
DEBIAN = {"assimp": "libassimp-dev", "bzip2": "libbz2-dev", "eigen": "libeigen3-dev", "fcl": "libfcl-dev", "libqhull": "libqhull-dev",
          "tinyxml2": "libtinyxml2-dev", "yaml-cpp": "libyaml-cpp-dev", "gtest": "libgtest-dev", "google-mock": "libgmock-dev",
          "libgmp": "libgmp-dev", "libboost-program-options": "libboost-program-options-dev"}
# What nothing of ours names, and why it is needed.
EXCUSES = {
    "libboost-program-options-dev": "a library whose headers are in libboost-dev",
    "libgmp-dev": "under CGAL's exact numbers",
    "libmpfr-dev": "under CGAL's exact numbers",
    "locales": "character maps for localedef",
    "pkg-config": "find_package(PkgConfig) is of CMake, and calls it",
    "python3-dev": "headers that those of pybind11 include",
}


@functools.lru_cache(maxsize=None)
def sources():
    """What our code includes, imports, and says at all."""
    texts = []
    for folder in FOLDERS:
        path = os.path.join(PROJECT, folder)
        names = [path] if os.path.isfile(path) else [
            os.path.join(where, name) for where, _, names in os.walk(path) for name in names]
        for name in names:
            if name.endswith(("packages.txt", "packages_docs.txt", os.path.basename(__file__))):
                continue
            try:
                with open(name, encoding="utf-8") as file:
                    texts.append(file.read())
            except UnicodeDecodeError:
                pass
    text = "\n".join(texts)
    includes = set(re.findall(r'#\s*include\s*[<"]([^>"]+)[>"]', text))
    imports = set(re.findall(r"^\s*(?:from|import)\s+([\w.]+)", text, re.MULTILINE))
    return includes, {name.split(".")[0] for name in imports}, text


def files_of(package):
    done = subprocess.run(["dpkg", "-L", package], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    return done.stdout.split() if done.returncode == 0 else None


def depends_on(package):
    done = subprocess.run(["dpkg-query", "-W", "-f", "${Depends}", package], stdout=subprocess.PIPE, text=True)
    return [name.split()[0].split(":")[0] for name in re.split(r"[,|]", done.stdout) if name.strip()]


def names_word(word):
    return re.search(r"(?<![\w-])%s(?![\w-])" % re.escape(word), sources()[2]) is not None


def use_of(files):
    """How code of ours uses one of the files; None: not at all."""
    includes, imports, _ = sources()
    for path in files:
        header = re.match(r"/usr/include/(?:[^/]*-linux-gnu/|eigen3/|urdfdom/)?(.*)", path)
        if header and header.group(1) in includes:
            return "#include <%s>" % header.group(1)
        module = re.match(r"/usr/lib/python3/dist-packages/(\w+)(?:/__init__)?(?:\.py|\.cpython.*\.so)?$", path)
        if module and module.group(1) in imports:
            return "import " + module.group(1)
        program = re.match(r"/usr/s?bin/(\w[\w-]*)$", path)
        if program and names_word(program.group(1)):
            return "the program " + program.group(1)
        ros = re.match(r"/usr/share/(\w+)/package\.xml$", path)
        if ros and re.search(r"""pkg=["']%s["']|package://%s/|include <%s/|["']%s/\w+["']""" % ((ros.group(1),) * 4),
                             sources()[2]):
            return "the ROS package " + ros.group(1)
        macro = re.match(r".*/cmake/(?:.*/)?(\w+)Config\.cmake$", path)
        if macro and re.search(r"find_package\(%s\b" % macro.group(1), sources()[2]):
            return "find_package(%s)" % macro.group(1)
    return None


def listed():
    names = {}
    with open(os.path.join(PROJECT, "scripts", "packages.txt"), encoding="utf-8") as file:
        for line in file:
            if line.split("#")[0].strip():
                names[line.split()[0]] = "scripts/packages.txt"
    for entry in xml.etree.ElementTree.parse(os.path.join(PROJECT, "package.xml")).getroot():
        if entry.tag.endswith("depend"):
            names.setdefault(DEBIAN.get(entry.text, entry.text), "package.xml")
    return sorted(names.items())


@pytest.mark.skipif(shutil.which("dpkg") is None, reason="skipped: no Debian")
@pytest.mark.parametrize("name, where", listed())
def test_each_dependency_is_used(name, where):
    if where == "package.xml" and files_of(name) is None:  # the name of a ROS package
        includes, imports, text = sources()
        used = name in imports or any(header.startswith(name + "/") for header in includes) or re.search(
            r"""pkg=["']%s["']|package://%s/|\b%s\(|find_package\(%s\b""" % ((name,) * 4), text) or names_word(name.replace("-", "_"))
        assert used, "package.xml names %s, and nothing uses it" % name
        return
    files = files_of(name)
    if files is None:
        pytest.skip("skipped: %s is not installed" % name)
    use = use_of(files)
    if use is None:  # some Debian packages hold no more than the library; its headers are in the next
        use = next((found for found in (use_of(files_of(other) or []) for other in depends_on(name)
                                        if other.endswith("-dev") and other not in dict(listed())) if found), None)
    assert (use is None) == (name in EXCUSES), "%s names %s: %s" % (where, name, use or "nothing uses it")
