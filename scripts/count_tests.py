#!/usr/bin/python3
"""Counts the test cases in a folder of JUnit-like XML: prints "N passed, N failed, N skipped".

Exit code 1 if one failed or none passed.
"""
import os
import sys
import xml.etree.ElementTree as ET


def outcome(case):
    if case.find("failure") is not None or case.find("error") is not None:
        return "failed"
    skipped = case.find("skipped") is not None or case.get("result") == "skipped"
    return "skipped" if skipped or case.get("status") == "notrun" else "passed"


def main(folder):
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
                if result != "passed":
                    print("%s: %s.%s" % (result, case.get("classname"), case.get("name")))
    print("%(passed)d passed, %(failed)d failed, %(skipped)d skipped" % counts)
    return 0 if counts["failed"] == 0 and counts["passed"] > 0 else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
