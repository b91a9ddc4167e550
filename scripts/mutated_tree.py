"""A copy of the tree that scripts/mutate builds, breaks and tests."""
import contextlib
import hashlib
import os
import resource
import shutil
import subprocess
import sys
import time

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
WORK = os.path.join(ROOT, "build", "mutate")
FAST = "-O1 -DNDEBUG"
LARGEST = 16 << 30  # bytes of memory, and of a file: a mistake may ask for any amount


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def write(path, text):
    with open(path + ".part", "w", encoding="utf-8") as file:
        file.write(text)
    os.replace(path + ".part", path)  # at once: a run may be interrupted


def limit_resources():
    for kind in (resource.RLIMIT_AS, resource.RLIMIT_FSIZE):
        resource.setrlimit(kind, (LARGEST, LARGEST))


class MutatedTree:
    """-O1 and shared libraries that are not linked again: a mutant takes some seconds."""

    def __init__(self, name="", flags=FAST, jobs=len(os.sched_getaffinity(0))):
        place = os.path.join(WORK, name)
        # Hidden: roslaunch would find its launch files beside ours.
        self.copy, self.build, self.jobs = os.path.join(place, ".source"), os.path.join(place, "build"), jobs
        self.seconds = {}  # by test: what it takes
        os.makedirs(self.copy, exist_ok=True)
        self.sources, self.tests = self.copy_tree()  # hashes
        self.log = open(os.path.join(place, "log"), "w")
        self.flags, self.environment = flags, None

    def copy_tree(self):
        """Brings the copy up to date, also after a run that was interrupted; returns hashes of the sources and the tests."""
        names = subprocess.run(["git", "-C", ROOT, "ls-files", "-co", "--exclude-standard", "-z"], check=True,
                               stdout=subprocess.PIPE).stdout.decode().split("\0")
        names = sorted(name for name in names if os.path.isfile(os.path.join(ROOT, name)))
        sources, tests = hashlib.sha256(), hashlib.sha256()
        for name in names:
            source, copy = os.path.join(ROOT, name), os.path.join(self.copy, name)
            with open(source, "rb") as file:
                content = file.read()
            if name.startswith(("src/", "include/", "msg/", "srv/", "config/")) or name.endswith(".h"):
                sources.update(name.encode() + b"\0" + content)
            elif name.startswith("test/"):
                tests.update(name.encode() + b"\0" + content)
            if os.path.exists(copy):
                with open(copy, "rb") as file:
                    if file.read() == content:
                        continue
            os.makedirs(os.path.dirname(copy), exist_ok=True)
            shutil.copy(source, copy)  # with a new time, so that it is built
        for folder, _, files in os.walk(self.copy):
            for name in files:
                path = os.path.join(folder, name)
                if os.path.relpath(path, self.copy) not in names:
                    os.remove(path)
        return sources.hexdigest(), tests.hexdigest()

    def configure(self):
        """Once, before the rest."""
        if self.environment:
            return
        launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
        generator = ["-G", "Ninja"] if shutil.which("ninja") else []
        os.environ["PATH"] = "/usr/bin:/bin:/usr/sbin:/sbin:" + os.environ["PATH"]  # ROS needs the system's Python
        if not self.run(["cmake", "-S", self.copy, "-B", self.build, "-DBUILD_TESTING=ON", "-DCMAKE_CXX_FLAGS=-w",
                         "-DCMAKE_CXX_FLAGS_RELEASE=" + self.flags, "-DCMAKE_LINK_DEPENDS_NO_SHARED=ON", "-DCMAKE_UNITY_BUILD=OFF",
                         *launcher, *generator]):
            sys.exit("error: cmake failed; see %s" % self.log.name)
        shell = subprocess.run(["bash", "-euc", ". %s/scripts/common.sh; ros_environment; env -0" % self.copy],
                               check=True, stdout=subprocess.PIPE,
                               env=dict(os.environ, COLLISION_PAIRS_BUILD=self.build))
        self.environment = dict(line.split("=", 1) for line in shell.stdout.decode().split("\0") if "=" in line)
        self.environment.update(GTEST_FAIL_FAST="1", GTEST_BRIEF="1", PYTEST_ADDOPTS="-x", ROS_HOSTNAME="localhost")
        shared = os.path.join(ROOT, "..", "shared")
        if os.path.isdir(os.path.join(shared, "reference")):
            self.environment.setdefault("COLLISION_PAIRS_SHARED", os.path.abspath(shared))

    def run(self, command, **options):
        self.log.write("\n$ %s\n" % " ".join(command))
        self.log.flush()
        return subprocess.run(command, stdout=self.log, stderr=subprocess.STDOUT, **options).returncode == 0

    def make(self, targets):
        self.configure()
        return self.run(["cmake", "--build", self.build, "-j", str(self.jobs), "--target", *sorted(set(targets))])

    def test(self, name):
        limit = 10 + 5 * self.seconds.get(name, 120)
        begin = time.monotonic()
        passes = self.run(["ctest", "--no-tests=error", "--output-on-failure", "--timeout", "%.0f" % limit, "-R",
                           "^%s$" % name], env=self.environment, cwd=self.build, preexec_fn=limit_resources)
        self.seconds.setdefault(name, time.monotonic() - begin)
        return passes

    def test_names(self):
        listed = subprocess.run(["ctest", "-N"], cwd=self.build, stdout=subprocess.PIPE, check=True).stdout.decode()
        return [line.split(": ")[1].strip() for line in listed.splitlines() if line.startswith("  Test ")]

    @contextlib.contextmanager
    def broken(self, mutant):
        """with: the file has the mistake."""
        path = os.path.join(self.copy, mutant.file)
        sound = read(path)
        write(path, mutant.applied(sound))
        try:
            yield
        finally:
            write(path, sound)
