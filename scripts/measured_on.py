"""What a measured table begins with: the commit and the machine, so that tables of two pages can be told apart."""
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
