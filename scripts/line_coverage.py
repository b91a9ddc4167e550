"""Which tests execute which lines: one run of every test with gcov's counters, for scripts/mutate --random."""
import bisect
import collections
import json
import os
import subprocess
import sys

from mutated_tree import FAST, ROOT, WORK, MutatedTree, read, write


def counted_lines(tree):
    """By file: the rows (from 1) that have code, and those that were executed since the last call."""
    counters = [os.path.join(folder, name) for folder, _, names in os.walk(tree.build) for name in names
                if name.endswith(".gcda")]
    known, executed = collections.defaultdict(set), collections.defaultdict(set)
    for first in range(0, len(counters), 50):
        output = subprocess.run(["gcov", "--json-format", "--stdout", *counters[first:first + 50]], cwd=tree.build,
                                stdout=subprocess.PIPE, stderr=tree.log, check=False).stdout.decode()
        for line in filter(None, output.split("\n")):
            for file in json.loads(line)["files"]:
                path = os.path.relpath(os.path.join(tree.build, file["file"]), tree.copy)
                if path.startswith(("src/", "include/")):
                    known[path].update(row["line_number"] for row in file["lines"])
                    executed[path].update(row["line_number"] for row in file["lines"] if row["count"])
    for path in counters:
        os.remove(path)
    return known, executed


def built_sources(tree):
    names = [os.path.join(folder, name) for folder, _, names in os.walk(tree.build) for name in names]
    return sorted({name.split(".dir/")[-1][:-len(".gcno")] for name in names if name.endswith(".gcno")})


class LineCoverage:
    """Of the sources and tests as they are; kept until they change."""

    def __init__(self):
        tree = MutatedTree("coverage", FAST + " --coverage")
        memory = os.path.join(WORK, "coverage.json")
        self.data = json.loads(read(memory)) if os.path.exists(memory) else {}
        if self.data.get("tree") != [tree.sources, tree.tests]:
            if not tree.make(["all", "tests"]):
                sys.exit("error: the build failed; see %s" % tree.log.name)
            self.data = {"tree": [tree.sources, tree.tests], "built": built_sources(tree), "known": {}, "seconds": {},
                         "executed": {}, "failing": []}
        tree.configure()
        tree.environment.update(GTEST_FAIL_FAST="0", PYTEST_ADDOPTS="")
        counted_lines(tree)
        for test in tree.test_names():
            if test in self.data["seconds"]:
                continue
            print("counting what %s executes" % test, file=sys.stderr, flush=True)
            passes = tree.test(test)
            known, executed = counted_lines(tree)
            for path, rows in known.items():
                self.data["known"][path] = sorted(rows.union(self.data["known"].get(path, [])))
            self.data["executed"][test] = {path: sorted(rows) for path, rows in executed.items() if rows}
            if not passes:  # a process of limited size can't write its counters
                self.data["failing"].append(test)
            self.data["seconds"][test] = tree.seconds[test]
            write(memory, json.dumps(self.data))

    def is_built(self, file):
        """Not what needs MoveIt, where there is none."""
        source = os.path.splitext(file)[0] + ".cpp"
        return not os.path.exists(os.path.join(ROOT, source)) or source in self.data["built"]

    def seconds(self, test):
        return self.data["seconds"][test]

    def tests_of(self, file, row):
        """Those that execute the line, the quickest first. A line without code of its own, such as the second of a
        statement, is taken for its neighbours with code."""
        known = self.data["known"].get(file, [])
        at = bisect.bisect_left(known, row)
        rows = {row} if known[at:at + 1] == [row] else set(known[max(0, at - 1):at + 1])
        tests = [test for test, files in self.data["executed"].items() if rows.intersection(files.get(file, []))]
        return sorted(tests, key=self.seconds)
