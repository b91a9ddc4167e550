"""Measured tables in pages: where they stand, and the commit and the machine that they are of."""
import os
import re
import subprocess

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


def commit():
    """Of what is built: with a "+" where sources differ from it."""
    git = ["git", "-C", ROOT]
    name = subprocess.run(git + ["rev-parse", "--short=10", "HEAD"], check=True, stdout=subprocess.PIPE, text=True).stdout
    changed = subprocess.run(git + ["status", "--porcelain", "--", "src", "include", "test/benchmark"], check=True,
                             stdout=subprocess.PIPE, text=True).stdout
    return name.strip() + ("+" if changed else "")


def measured_on():
    with open("/proc/cpuinfo") as info:
        text = info.read()
    model = re.search(r"model name\s*: (.*)", text).group(1)
    flags = re.search(r"flags\s*: (.*)", text).group(1).split()
    kernels = "AVX-512" if "avx512f" in flags else "AVX2" if "avx2" in flags else "SSE2"
    return "Measured at commit %s on one core of: %s, %s.\n" % (commit(), model, kernels)


def renew(page, name, text):
    """Puts `text` between the page's marks <!-- name: begin --> and <!-- name: end -->."""
    with open(page, encoding="utf-8") as file:
        old = file.read()
    begin, end = "<!-- %s: begin -->\n" % name, "<!-- %s: end -->" % name
    new = old[:old.index(begin) + len(begin)] + text + "\n" + old[old.index(end):]
    with open(page, "w", encoding="utf-8") as file:
        file.write(new)
