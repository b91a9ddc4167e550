"""The Python module under random calls, in a process of its own: each ends in an answer or an exception that says why.

A few seconds; with COLLISION_PAIRS_LONG (scripts/test --long) some minutes.
"""
import os
import random
import subprocess
import sys
import threading
import time
import warnings

import numpy as np
from conftest import PYTHON
from seed import given_seed
from test_python import CLEAR, URDF, translation

import collision_pairs as cp

SECONDS = 240 if os.environ.get("COLLISION_PAIRS_LONG") else 6
EXPECTED = (ValueError, TypeError, RecursionError, MemoryError, OverflowError, OSError, AttributeError, UserWarning)
NAMES = ["turn", "slide", "base", "tip", "mid", "slyde", "", "*", "t*p", "\ud800", "a\0b", "\N{ROBOT FACE}"]
NUMBERS = [0, 0.0, -0.0, 1, -1, 0.3, 1e-300, 1e300, -1e300, float("nan"), float("inf"), -float("inf"), 2**70, True]
DTYPES = ["f8", "f4", "f2", ">f8", "i8", "u1", "?", "c16", "O", "S3", "U3", "M8[s]", "V8", "f8,f8"]


class Calls:
    """Random values, good and bad, and random calls with them."""

    def __init__(self, seed):
        self.random, self.numpy = random.Random(seed), np.random.default_rng(seed)
        self.things = [cp.Robot(URDF)]
        self.things.append(cp.Scene(self.things[0]))
        self.things.append(cp.Detector(self.things[1], threads=2))

    def thing(self, kind):
        """Mostly one of the kind that is wanted, of those made before."""
        fitting = [thing for thing in self.things if isinstance(thing, kind)]
        return self.random.choice(fitting) if fitting and self.random.random() < 0.95 else self.value()

    def array(self):
        shape = self.random.choice([(2,), (1, 2), (7, 2), (300, 2), (0, 2), (2, 0), (3,), (2, 3), (1, 1, 2), ()])
        if self.random.random() < 0.6:
            shape = (self.random.choice([1, 5, 300]), 2)
        array = self.numpy.uniform(-0.5, 1.0, shape)
        if self.random.random() < 0.2 and array.size:
            array.flat[self.random.randrange(array.size)] = float(self.random.choice(NUMBERS[:-2]))
        if self.random.random() < 0.2:
            try:
                array = array.astype(self.random.choice(DTYPES))
            except TypeError:
                pass
        way = self.random.randrange(6)
        if way == 0:
            return array[::-1] if array.ndim else array
        if way == 1:
            return np.asfortranarray(array)
        if way == 2:
            return array.tolist()
        if way == 3:
            return np.broadcast_to(array, (2,) + array.shape)[0]
        return array

    def value(self, depth=0):
        ways = [lambda: None, lambda: self.random.choice(NUMBERS), lambda: self.random.choice(NAMES), self.array,
                lambda: object(), lambda: b"bytes", lambda: translation(0.1, 0, 0), lambda: URDF, lambda: np.eye(4) * 2,
                lambda: self.random.choice(self.things), lambda: cp.Verdict.FREE, lambda: iter([1, 2])]
        if depth < 3:
            ways += [lambda: [self.value(depth + 1) for _ in range(self.random.randrange(4))],
                     lambda: tuple(self.value(depth + 1) for _ in range(self.random.randrange(4))),
                     lambda: {self.value_of_key(): self.value(depth + 1) for _ in range(self.random.randrange(3))}]
        return self.random.choice(ways)()

    def value_of_key(self):
        return self.random.choice(NAMES + [1, None, "padding", "links", "floor", "height", "pair_rules", "deny",
                                           "link_padding", "group", "max_hull_vertices", "link_fidelity"])

    def options(self, **good):
        """Some of them, a few replaced by anything."""
        chosen = {name: value() for name, value in good.items() if self.random.random() < 0.5}
        if self.random.random() < 0.15:
            chosen[self.random.choice(list(good) + ["nonsense"])] = self.value()
        return chosen

    def settings(self):
        good = {"padding": 0.01, "links": ["tip"], "floor": {"height": -0.2}, "link_padding": {"tip": 0.01},
                "pair_rules": [{"deny": ["tip", "base"]}], "max_hull_vertices": 8}
        chosen = {name: good[name] for name in good if self.random.random() < 0.3}
        if self.random.random() < 0.3:
            chosen[self.value_of_key()] = self.value()
        return chosen

    def check(self):
        detector = self.thing(cp.Detector)
        return detector.check(self.array(), **self.options(
            joints=lambda: self.random.choice([None, ["turn", "slide"], ["slide", "turn"], ["slide"], ("turn",)]),
            alarm_distance=lambda: self.random.choice(NUMBERS), gradient=lambda: True, verdict_only=lambda: True,
            fidelity=lambda: self.random.choice(["aabb", "obb", "convex", "mesh", "x"]), min_distance=lambda: True,
            tolerance=lambda: self.random.choice(NUMBERS),
            time_budget=lambda: self.random.choice([0.0, 1e-9, 1e-5, -1, float("nan")])))

    def motion(self):
        waypoints = self.array()
        if isinstance(waypoints, (list, np.ndarray)) and np.ndim(waypoints):
            waypoints = waypoints[:5]
        result = self.thing(cp.MotionCheck).check(waypoints, **self.options(
            joints=lambda: self.random.choice([None, ["turn", "slide"], ["slide"]]), resolution=lambda: 1e-2,
            clearance=lambda: self.random.choice([0.01, -1, float("nan")]), fidelity=lambda: "obb"))
        assert set(result.verdict) <= set(cp.Verdict)
        touching = result.verdict == cp.Verdict.COLLISION
        assert set(np.flatnonzero(touching)) <= set(result.pairs["segment"])
        return result

    def look(self):
        thing = self.random.choice(self.things)
        name = self.random.choice([n for n in dir(thing) if not n.startswith("__")] + ["nothing"])
        return repr(thing), getattr(thing, name)

    def shape(self):
        three, number = [0.1, 0.2, 0.3], 0.1
        kind, arguments = self.random.choice([
            (cp.Box, [three]), (cp.Sphere, [number]), (cp.Cylinder, [number, number]), (cp.Capsule, [number, number]),
            (cp.HalfSpace, []), (cp.Convex, [np.eye(3)]), (cp.Mesh, [np.eye(4)[:, :3], [[0, 1, 2], [1, 2, 3]]])])
        return kind(*[self.value() if self.random.random() < 0.2 else given for given in arguments])

    def object(self):
        shapes = [t for t in self.things if isinstance(t, (cp.Box, cp.Sphere, cp.Convex, cp.Mesh, cp.HalfSpace))]
        return cp.RigidObject(self.random.choice(NAMES + ["post"] * 5), self.random.sample(shapes, min(len(shapes), 2)),
                              **self.options(pose=lambda: translation(0.5, 0, 0), padding=lambda: 0.01,
                                             attached_link=lambda: self.random.choice(["tip", "none"]),
                                             touch_links=lambda: ["tip"], poses=lambda: [np.eye(4)] * 2))

    def scene(self):
        objects = [t for t in self.things if isinstance(t, cp.RigidObject)]
        return cp.Scene(self.thing(cp.Robot), **self.options(
            srdf=lambda: "<robot name='slider'/>", settings=self.settings, world=lambda: self.thing(cp.Robot),
            objects=lambda: self.random.sample(objects, min(len(objects), 2))))

    def robot(self):
        at = self.random.randrange(len(URDF))
        text = self.random.choice([URDF, URDF[:at], URDF[:at] + self.random.choice(NAMES) + URDF[at + 1:]])
        return self.random.choice([cp.Robot, cp.Robot.from_urdf])(text if self.random.random() < 0.9 else self.value())

    def one(self):
        call = self.random.choice([self.check] * 12 + [self.look] * 4 + [self.shape] * 2 + [self.motion] * 2 + [
            self.object, self.scene, self.robot, lambda: cp.Detector(self.thing(cp.Scene), threads=2),
            lambda: cp.MotionCheck(self.thing(cp.Scene), threads=2)])
        try:
            made = call()
        except EXPECTED as error:
            if not str(error):
                raise AssertionError("an exception that says nothing: %r" % error)
            return
        if isinstance(made, cp.CheckResult):
            self.judge(made)
        if isinstance(made, tuple) or made is None:
            return
        self.things.append(made)
        if len(self.things) > 40:  # parents go before their children
            del self.things[self.random.randrange(3, 20)]

    @staticmethod
    def judge(result):
        verdict, min_distance = np.atleast_1d(result.verdict), np.atleast_1d(result.min_distance)
        assert set(verdict) <= set(cp.Verdict)
        assert not np.isnan(min_distance).any()
        pairs = result.pairs
        touching = pairs["row"][(pairs["state"] == cp.PairState.CONTACT) | (pairs["distance"] <= 0)]
        assert (verdict[touching] != cp.Verdict.FREE).all()
        assert (verdict[result.left_out["row"]] != cp.Verdict.FREE).all()


def main(seed, seconds):
    warnings.simplefilter("ignore")
    end, calls, failures, counts = time.monotonic() + seconds, Calls(seed), [], []

    def work(own):
        try:
            count = 0
            while time.monotonic() < end and not failures:
                own.one()
                count += 1
            counts.append(count)
        except BaseException as error:
            failures.append(repr(error))
            raise
    sharing = Calls(seed + 1)
    sharing.things = list(calls.things)  # the same objects, on another thread
    threads = [threading.Thread(target=work, args=(own,)) for own in (calls, sharing)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failures, failures
    scene = cp.Scene(cp.Robot(URDF), srdf="<robot name='slider'/>")
    assert cp.Detector(scene).check([0, CLEAR]).verdict == cp.Verdict.FREE
    print("%d calls" % sum(counts))


def test_random_calls_end_in_an_answer_or_an_exception_that_says_why():
    seed = given_seed()
    program = "import sys; sys.path[:0] = %r; import test_python_fuzz; test_python_fuzz.main(%d, %d)" % (
        [PYTHON, os.path.dirname(os.path.abspath(__file__))], seed, SECONDS)
    done = subprocess.run([sys.executable, "-X", "faulthandler", "-c", program], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, timeout=10 * SECONDS + 60)
    print(done.stdout[-3000:])
    assert done.returncode == 0
    assert int(done.stdout.split()[-2]) > 100
