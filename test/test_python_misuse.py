"""What Python can do to the module's objects that C++ cannot: each use is answered or raises, none crashes or hangs."""
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from conftest import DEMO, PYTHON
from test_python import CLEAR, TOUCHING, URDF, detector

import collision_pairs as cp

CLASSES = [name for name in cp.__all__ if not issubclass(getattr(cp, name), (int, Exception))]


def in_a_process(program):
    """Its output; the test fails if it crashes, or hangs for a minute."""
    header = "import os, sys\nsys.path[:0] = %r\nimport collision_pairs as cp\nimport test_python_misuse as own\n" % [
        PYTHON, os.path.dirname(os.path.abspath(__file__))]
    done = subprocess.run([sys.executable, "-u", "-X", "faulthandler", "-c", header + program], timeout=60,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    assert done.returncode == 0, done.stdout[-3000:]
    return done.stdout


def refusals(call):
    """What the call raises for no argument, one, two, ...: all that any signature takes."""
    said = []
    for count in range(12):
        try:
            call(*[None] * count)
        except TypeError as error:
            said.append(str(error))
        else:
            said.append("answered")
    return said


def use_without_init(cls):
    """Each method and attribute of an object that __new__ alone has made."""
    made = cls.__new__(cls)
    for name in vars(cls):
        if name == "__init__":
            continue
        attribute = getattr(cls, name)
        if isinstance(attribute, property):
            said = refusals(lambda *_: getattr(made, name))
        elif "self" in (attribute.__doc__ or ""):
            said = refusals(getattr(made, name))
        else:
            continue  # static: it has no object
        assert "answered" not in said and any("__init__" in text for text in said), (cls, name, said)
        print(cls.__name__, name)


def test_an_object_made_without_init_raises_whatever_is_asked_of_it():
    used = in_a_process("for name in own.CLASSES: own.use_without_init(getattr(cp, name))").split("\n")
    without_methods = {"Box", "Sphere", "Cylinder", "Capsule", "HalfSpace", "Convex", "Mesh"}
    assert {line.split(" ")[0] for line in used} >= set(CLASSES) - without_methods


class Late(cp.Detector):
    """A subclass that checks before it has made what it inherits."""

    def __init__(self, scene):
        self.check([0, CLEAR])
        super().__init__(scene)


def give_without_init():
    empty = {name: getattr(cp, name).__new__(getattr(cp, name)) for name in CLASSES}
    scene = cp.Scene(cp.Robot(URDF), srdf="<robot name='slider'/>")
    calls = [lambda: cp.Scene(empty["Robot"]), lambda: cp.Scene(cp.Robot(URDF), world=empty["Robot"]),
             lambda: cp.Detector(empty["Scene"]), lambda: cp.MotionCheck(empty["Scene"]), lambda: Late(scene),
             lambda: scene.with_objects([empty["RigidObject"]])]
    calls += [lambda shape=empty[shape]: cp.RigidObject("a", [shape])
              for shape in ("Box", "Sphere", "Cylinder", "Capsule", "HalfSpace", "Convex", "Mesh")]
    for call in calls:
        with pytest.raises(TypeError, match="__init__"):
            call()


def test_an_object_made_without_init_is_refused_as_an_argument():
    in_a_process("own.give_without_init()")


def fork_during_a_check(in_child):
    """Forks while another thread is in a call; the child runs `in_child`, and the status is that of the child."""
    busy = detector(threads=1)
    many = np.broadcast_to([0.0, CLEAR], (10**7, 2))
    entered = threading.Event()

    def work():
        entered.set()
        busy.check(many)
    thread = threading.Thread(target=work, daemon=True)
    thread.start()
    entered.wait()
    time.sleep(0.5)  # for longer than it takes to get into its loop
    child = os.fork()
    if child == 0:
        signal.alarm(20)  # instead of hanging
        try:
            in_child(busy)
            os._exit(0)
        except BaseException as error:
            print(repr(error), flush=True)
        os._exit(1)
    status = os.waitpid(child, 0)[1]
    assert thread.is_alive(), "the check has ended before the child was made"
    os._exit(status != 0)


def every_long_call_raises(busy):
    scene_of = {"robot": cp.Robot(URDF), "srdf": "<robot name='slider'/>"}
    for call in (lambda: busy.check([0, CLEAR]), lambda: cp.Scene(**scene_of)):
        with pytest.raises(cp.InputError, match="fork"):
            call()


def test_a_child_forked_during_a_check_raises_and_does_not_hang():
    in_a_process("own.fork_during_a_check(own.every_long_call_raises)")


def fork_between_checks():
    tested = detector()
    tested.check([[0, CLEAR]] * 100)
    if os.fork() == 0:
        verdicts = set(tested.check([[0, CLEAR], [0, TOUCHING]] * 100).verdict)
        os._exit(verdicts != {cp.Verdict.FREE, cp.Verdict.COLLISION})
    assert os.wait()[1] == 0


def test_a_child_of_fork_checks_as_its_parent():
    in_a_process("own.fork_between_checks()")


def test_a_fidelity_is_given_by_name_or_by_its_enum():
    robot = cp.Robot(DEMO + "/demo_robot.urdf", srdf=DEMO + "/demo_robot.srdf")
    for fidelity in cp.Fidelity:
        results, motions = [], []
        for given in (fidelity, fidelity.name.lower()):
            scene = cp.Scene(robot, settings={"link_fidelity": {"palm": given}})
            state = [0.3] * len(robot.joints)
            results.append(cp.Detector(scene).check(state, alarm_distance=1.0, fidelity=given).pairs)
            motions.append(cp.MotionCheck(scene).check([state, state], fidelity=given).clearance)
        assert len(results[0]) and (results[0] == results[1]).all() and (motions[0] == motions[1]).all()
        assert results[0]["fidelity"].max() <= fidelity
    for other in (2, 2.0, None, cp.Verdict.UNKNOWN, b"mesh"):
        with pytest.raises(TypeError, match="fidelity .*'mesh'.*Fidelity"):
            detector().check([0, CLEAR], fidelity=other)


NO_PATHS = {"xml": URDF.encode(), "long": URDF.replace("<", "").encode() * 100, "lines": "name: x\n" * 1000}
TAKE_PATHS = {"urdf": cp.Robot, "srdf": lambda text: cp.Robot(URDF, srdf=text),
              "settings": lambda text: cp.Scene(cp.Robot(URDF), settings=text)}


@pytest.mark.parametrize("what", TAKE_PATHS)
@pytest.mark.parametrize("text", NO_PATHS)
def test_a_text_that_is_no_path_is_refused_in_a_sentence(what, text):
    make, text = TAKE_PATHS[what], NO_PATHS[text]
    with pytest.raises(cp.InputError, match=what + " is .* no path") as refused:
        make(text)
    assert len(str(refused.value)) < 200, str(refused.value)


def test_texts_that_are_no_paths_are_refused_in_these_words(tmp_path):
    long = "/" + "x" * 4094  # a path may have 4095 bytes
    for given, words in (("", "urdf is empty"), (b"", "urdf is empty"), (long, None),
                         (long + "x", "urdf is a text that is no path, b'/%s' ...; give the path of a file, or what such a file says"
                          % ("x" * 19)),
                         (b"a\nb", "urdf is bytes that are no path, b'a\\nb' ...; give the path of a file, or decode() it to a str"),
                         ("a\rb", "urdf is a text that is no path, b'a\\rb' ...; give the path of a file, or what such a file says"),
                         (b"<robot/>", "urdf is bytes that are no path, b'<robot/>' ...; give the path of a file, or "
                          "decode() it to a str")):
        with pytest.raises(cp.InputError) as refused:
            cp.Robot(given)
        assert str(refused.value) == words if words else "no path" not in str(refused.value)
    (tmp_path / "robot.urdf").write_text(URDF)
    for path in (tmp_path / "robot.urdf", str(tmp_path / "robot.urdf"), bytes(tmp_path / "robot.urdf")):
        assert cp.Robot(path).name == "slider"
