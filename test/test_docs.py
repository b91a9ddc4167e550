"""What the pages state is tied to what was measured."""
import os
import re

from conftest import PROJECT

# Measured by scripts/measure_trade_off and scripts/benchmark_detector; a number of one must not contradict the other.
PAGES = ["docs/trade_off.md", "docs/performance.md"]


def commit_of(page):
    with open(os.path.join(PROJECT, page), encoding="utf-8") as text:
        found = re.findall(r"Measured at commit ([0-9a-f]{10})(\+?) on", text.read())
    assert len(found) == 1, "%s names %d commits" % (page, len(found))
    assert not found[0][1], "%s was measured with changes that are in no commit" % page
    return found[0][0]


def test_pages_whose_numbers_are_compared_were_measured_at_one_commit():
    assert len({commit_of(page) for page in PAGES}) == 1
