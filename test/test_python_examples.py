"""The examples in Python, and the code of docs/python.md, do what they say.

The example that needs a master runs in ros/test_node.py.
"""
import os
import re
import subprocess
import sys

from conftest import PROJECT, PYTHON


def run(*arguments):
    environment = dict(os.environ, PYTHONPATH=PYTHON, ROS_PACKAGE_PATH=PROJECT + ":/usr/share")
    done = subprocess.run([sys.executable, *map(str, arguments)], env=environment, cwd=PROJECT, timeout=300,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    return done.stdout


def test_a_million_states_are_checked_and_some_collide():
    said = run("examples/check_million_states.py")
    colliding, count = map(int, re.match(r"(\d+) of (\d+) states collide", said).groups())
    assert count == 1000000
    assert 10000 < colliding < 990000


def test_the_velocity_limiter_keeps_its_distance_where_the_arm_alone_would_hit(tmp_path):
    out = run("examples/limit_velocity.py", tmp_path / "plot.png")
    without, limited = map(float, re.search(r"without limiter (\S+) mm, with limiter (\S+) mm", out).groups())
    assert without < -10.0  # through the post
    assert 19.0 < limited < 25.0  # STOP_DISTANCE is 20 mm
    assert (tmp_path / "plot.png").read_bytes()[:4] == b"\x89PNG"


def test_the_code_of_the_page_runs():
    with open(os.path.join(PROJECT, "docs/python.md")) as page:
        blocks = re.findall(r"^```python\n(.*?)^```", page.read(), re.MULTILINE | re.DOTALL)
    assert len(blocks) == 5
    said = run("-c", "".join(blocks))
    assert re.match(r"[1-9]\d* of 10000 are not free\n\w+ \w+ in state \d+\n\[\d \d\] \[.*\]\n$", said)
