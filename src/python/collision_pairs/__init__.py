"""Collision checking in process, and the ROS messages of the same package.

    import collision_pairs as cp
    robot = cp.Robot("robot.urdf", srdf="robot.srdf")
    detector = cp.Detector(cp.Scene(robot))
    result = detector.check(states, joints=names)   # states: float64 (n, len(names))

cp.msg, cp.srv and the compiled module are loaded when they are first asked for: who only wants
messages needs neither NumPy nor the library.
"""
import importlib

__version__ = "1.0.0"
__all__ = ["Box", "Capsule", "Certainty", "CheckResult", "Convex", "Cylinder", "Detector", "Fidelity",
           "HalfSpace", "InputError", "Mesh", "MotionCheck", "MotionResult", "PairState", "RigidObject", "Robot",
           "Scene", "Sphere", "Verdict"]


def __getattr__(name):
    if name in __all__:
        value = getattr(importlib.import_module("collision_pairs._native"), name)
        globals()[name] = value
        return value
    if name in ("cfg", "msg", "srv"):
        return importlib.import_module("collision_pairs." + name)
    raise AttributeError("module 'collision_pairs' has no attribute '%s'" % name)


def __dir__():
    return sorted(__all__ + ["cfg", "msg", "srv"])
