#!/usr/bin/python3
"""Counts the test cases in a folder of JUnit-like XML: prints "N passed, N failed, N skipped" and why they were skipped.

usage: count_tests.py FOLDER FAILED: FAILED is ctest's list of failed tests, absent where none failed.

A ctest of which no such file tells a failure, although ctest says that it failed (it crashed, say),
counts as one more. Exit code 1 if one failed or none passed.
"""
import os
import sys
import xml.etree.ElementTree as ET


def outcome(case):
    if case.find("failure") is not None or case.find("error") is not None:
        return "failed"
    skipped = case.find("skipped") is not None or case.get("result") == "skipped"
    return "skipped" if skipped or case.get("status") == "notrun" else "passed"


def why_skipped(case):
    """As pytest, rosunit and gtest (in what GTEST_SKIP() prints) say it."""
    said = case.find("skipped")
    text = (said.get("message") or said.text or "") if said is not None else ""
    return " ".join(text.split()) or "no reason is given"


def files_of(test):
    """In which gtest, pytest or rostest say what came of it."""
    short = test.replace("rostest_", "")
    return {"test_%s.xml" % test, test + ".xml", "rosunit-%s_test.xml" % short, "rostest-test_ros_%s.xml" % short}


def silent_failures(ctest_failed, failed_files):
    """Names of the ctests that failed without a file of theirs saying so."""
    if not os.path.exists(ctest_failed):
        return
    with open(ctest_failed) as lines:
        for line in lines:  # "12:rostest_node"
            name = line.strip().split(":", 1)[-1]
            if name and not files_of(name) & set(failed_files):
                yield name


def main(folder, ctest_failed):
    failed_files, reasons = [], set()
    counts = {"passed": 0, "failed": 0, "skipped": 0}
    for path, _, names in os.walk(folder):
        for name in sorted(names):
            if not name.endswith(".xml"):
                continue
            try:
                cases = list(ET.parse(os.path.join(path, name)).getroot().iter("testcase"))
            except ET.ParseError as error:
                print("failed: %s: %s" % (name, error))
                counts["failed"] += 1
                continue
            for case in cases:
                result = outcome(case)
                counts[result] += 1
                if result == "failed":
                    failed_files.append(name)
                elif result == "skipped":
                    reasons.add(why_skipped(case))
                if result != "passed":
                    print("%s: %s.%s" % (result, case.get("classname"), case.get("name")))
    for name in silent_failures(ctest_failed, failed_files):
        print("failed: %s ended without a result" % name)
        counts["failed"] += 1
    why = " (%s)" % "; ".join(sorted(reasons)) if reasons else ""
    print("%(passed)d passed, %(failed)d failed, %(skipped)d skipped" % counts + why)
    return 0 if counts["failed"] == 0 and counts["passed"] > 0 else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
