"""Runs a rostest, or says "skipped" where its data are absent: rosunit would count it as passed."""
import sys
import unittest
import xml.etree.ElementTree as ET

import rostest


def run_or_skip(package, name, case, reason):
    """`reason` empty: runs."""
    if not reason:
        rostest.rosrun(package, name, case)
        return
    names = unittest.TestLoader().getTestCaseNames(case)
    suite = ET.Element("testsuite", name=name, tests=str(len(names)), errors="0", failures="0", time="0")
    for test in names:
        found = ET.SubElement(suite, "testcase", classname="__main__." + case.__name__, name=test, time="0")
        ET.SubElement(found, "skipped", message=reason)
    for argument in sys.argv:
        if argument.startswith("--gtest_output=xml:"):
            ET.ElementTree(suite).write(argument.split(":", 1)[1], encoding="utf-8", xml_declaration=True)
    print("skipped: " + reason)
