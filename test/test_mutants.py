"""The list of mistakes that scripts/mutate tries must keep up with the code."""
import os
import subprocess

from conftest import PROJECT


def test_each_mistake_of_the_list_still_has_its_line():
    listed = subprocess.run([os.path.join(PROJECT, "scripts", "mutate"), "--list"], stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True, timeout=60)
    assert listed.returncode == 0, listed.stderr
    assert len(listed.stdout.splitlines()) >= 100
