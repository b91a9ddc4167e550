"""The list of mistakes that scripts/mutate tries must keep up with the code."""
import os
import subprocess
import sys

import pytest

from conftest import PROJECT


def test_each_mistake_of_the_list_still_has_its_line():
    listed = subprocess.run([os.path.join(PROJECT, "scripts", "mutate"), "--list"], stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True, timeout=60)
    assert listed.returncode == 0, listed.stderr
    with open(os.path.join(PROJECT, "test", "mutants.yaml")) as file:  # a file that is there twice would hide its first entries
        assert len(listed.stdout.splitlines()) == file.read().count("\n- line: ")


def drawn(number, seed, *options):
    listed = subprocess.run([os.path.join(PROJECT, "scripts", "mutate"), "--list", "--random", str(number), "--seed",
                             str(seed), *options], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=60)
    assert listed.returncode == 0, listed.stderr
    return listed.stdout


def test_a_seed_draws_the_same_mistakes_again_and_another_seed_others():
    files = ["--files", "src/transforms/*"]
    sample = drawn(50, 1, *files)
    assert drawn(50, 1, *files) == sample
    assert drawn(50, 2, *files) != sample
    assert drawn(10, 1, *files) == "".join(sample.splitlines(keepends=True)[:30])


def test_a_sample_can_be_of_some_files():
    mistakes = drawn(200, 1, "--files", "src/monitor/*", "src/transforms/stamps.*").splitlines()[::3]
    assert len(mistakes) == 200
    assert {os.path.dirname(mistake.split()[1]) for mistake in mistakes} == {"src/monitor", "src/transforms"}


def changes(code):
    """The lines that a line may become."""
    sys.path.insert(0, os.path.join(PROJECT, "scripts"))
    import random_mutants
    masked = random_mutants.masked(code)
    return {code[:begin] + new + code[end:] for places in random_mutants.changes(masked).values()
            for begin, end, new in places}


@pytest.mark.parametrize("code, becomes", [
    ("if (a < b) return;", {"if (a <= b) return;", "if (true) return;", "if (false) return;", "if (a < b);"}),
    ("x = a && !b;", {"x = a || !b;", "x = a && b;", ";"}),
    ("const T y = f(p, q) * 2.0;", {"const T y = f(q, p) * 2.0;", "const T y = f(p, q) / 2.0;",
                                    "const T y = f(p, q) * (2.0 * 2.0);", "const T y = f(p, q) * (0.5 * 2.0);"}),
    ("return a ? b : c;", {"return b;", "return c;"}),
    ("std::vector<T> v, w;  // a < b", set()),
    ('log("a < b && 1");', {";"}),
    ("#include <a>", set()),
])
def test_a_line_is_changed_in_one_place_and_never_in_comments_strings_or_types(code, becomes):
    assert changes(code) == becomes


def test_what_decides_who_gets_a_signal_is_not_changed():
    sys.path.insert(0, os.path.join(PROJECT, "scripts"))
    import random_mutants
    lines = ["\n".join(place[2:4]) for place in random_mutants.draw(PROJECT, 1)]
    assert len(lines) > 5000
    assert not [line for line in lines if "kill(" in line or "if (pid_ > 0) {" in line]
