"""Collision checking in process, and the ROS messages of the same package (msg, srv, cfg).

Metres, radians, seconds. Points and normals are measured and expressed in the robot's root link.
Wrong input raises InputError (a ValueError) that names what is wrong.
"""
from enum import IntEnum
from os import PathLike
from types import ModuleType
from typing import Any, Dict, List, Optional, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

cfg: ModuleType
msg: ModuleType
srv: ModuleType

class InputError(ValueError): ...

class Verdict(IntEnum):
    FREE = 0  # every pair that the scene requires was checked and is apart
    COLLISION = 1  # a contact is certain, at the requested fidelity
    UNKNOWN = 2  # neither: a model left out, or an unresolved pair that may be in contact

class PairState(IntEnum):
    NEAR = 0  # apart, and no further than the alarm distance
    CONTACT = 1  # touching or penetrating
    UNRESOLVED = 2  # not settled; distance is a lower bound: apart if it is positive

class Certainty(IntEnum):
    EXACT = 0  # distance is the distance
    LOWER_BOUND = 1  # of the signed distance; for a NEAR pair it is too small by at most the tolerance
    DEPTH_BOUND = 2  # certainly in contact; a translation by -distance separates the two

class Fidelity(IntEnum):
    AABB = 0
    SPHERES = 1
    OBB = 2
    CONVEX = 3
    MESH = 4

class Robot:
    """Links with their collision geometry, and the joints between them. Immutable."""

    def __init__(self, urdf: Union[str, PathLike[str]], srdf: Union[str, PathLike[str], None] = None) -> None:
        """Each is XML text (a str that contains '<') or the path of a file. Meshes: package:// and file://."""
    @staticmethod
    def from_urdf(urdf_text: str) -> Robot: ...
    @staticmethod
    def from_parameters(description: str = "robot_description",
                        semantic: str = "robot_description_semantic") -> Robot:
        """Reads the ROS parameters of these names, searched for by rospy from the caller's namespace upwards."""
    @property
    def name(self) -> str: ...
    @property
    def joints(self) -> List[str]:
        """Joints of a state: revolute, continuous and prismatic joints that are not mimic joints."""
    @property
    def limits(self) -> NDArray[np.float64]:
        """(len(joints), 2): lower and upper, rad or m; infinite without a limit."""
    @property
    def links(self) -> List[str]: ...

class Box:
    """Centred at its origin."""
    def __init__(self, size: ArrayLike) -> None:
        """size: full edge lengths (3,), m."""

class Sphere:
    def __init__(self, radius: float) -> None: ...

class Cylinder:
    """Along z, centred at its origin, with flat ends."""
    def __init__(self, radius: float, length: float) -> None: ...

class Capsule:
    """All points within radius of a segment along z of this length, centred at its origin."""
    def __init__(self, radius: float, length: float) -> None: ...

class HalfSpace:
    """All points with z <= 0: a floor."""
    def __init__(self) -> None: ...

class Convex:
    """The convex hull of points."""
    def __init__(self, vertices: ArrayLike) -> None:
        """vertices: (n, 3), m."""

class Mesh:
    """The solid bounded by triangles."""
    def __init__(self, vertices: ArrayLike, triangles: ArrayLike) -> None:
        """vertices: (n, 3), m; triangles: (m, 3), indices of vertices."""
    @staticmethod
    def from_uri(uri: str, scale: ArrayLike = ...) -> Mesh:
        """package:// or file://, as in a URDF; scale: (3,), per axis, 1 by default."""

Shape = Union[Box, Sphere, Cylinder, Capsule, HalfSpace, Convex, Mesh]

class RigidObject:
    """A body that is not a link: static, or attached to a link."""
    def __init__(self, name: str, shapes: Sequence[Shape], poses: Optional[ArrayLike] = None,
                 pose: Optional[ArrayLike] = None, attached_link: str = "",
                 touch_links: Sequence[str] = (), padding: float = 0.0) -> None:
        """poses: (n, 4, 4), of the shapes in the object's frame (None: at its origin); pose: (4, 4), of the object
        in the root link's frame, or in that of attached_link (None: identity); touch_links: links and objects that
        it is not checked against; padding: m, distance to keep to everything."""
    @property
    def name(self) -> str: ...
    @property
    def attached_link(self) -> str: ...
    @property
    def touch_links(self) -> List[str]: ...
    @property
    def padding(self) -> float: ...
    @property
    def pose(self) -> NDArray[np.float64]: ...

class Scene:
    """The models and pairs to be checked. Immutable: can be shared by threads and detectors."""
    def __init__(self, robot: Robot, srdf: Union[str, PathLike[str], None] = None, world: Optional[Robot] = None,
                 objects: Sequence[RigidObject] = (),
                 settings: Union[Dict[str, Any], str, PathLike[str], None] = None) -> None:
        """srdf: in place of the robot's; without an SRDF, adjacent links are not checked. world: static, with its root
        at the robot's root link. settings: the node's parameters as a dict, or such a YAML file; those that do not
        concern the scene (rate, alarm_distance, ...) are ignored."""
    def with_objects(self, objects: Sequence[RigidObject]) -> Scene:
        """The same scene with other objects. Meshes are not prepared again."""
    @property
    def models(self) -> NDArray[np.str_]:
        """(m,): the links and objects that are in some pair, sorted; results refer to them by index."""
    @property
    def objects(self) -> List[RigidObject]: ...

class CheckResult:
    """Result for n states. If one state was given as (joints,), values of shape (n,) are scalars.

    Arrays are views that keep the result alive.
    """
    @property
    def verdict(self) -> NDArray[np.uint8]:
        """(n,): see Verdict."""
    @property
    def in_collision(self) -> NDArray[np.bool_]:
        """(n,): true unless the verdict is FREE."""
    @property
    def min_distance(self) -> NDArray[np.float64]:
        """(n,), m: the smallest signed distance of all pairs, if it is at most the alarm distance or was requested;
        otherwise (min_distance_is_bound) a lower bound of it."""
    @property
    def min_distance_is_bound(self) -> NDArray[np.bool_]:
        """(n,)"""
    @property
    def pairs(self) -> NDArray[np.void]:
        """(p,), structured: the pairs in contact, near or unresolved, sorted by state and name.

        row (int64): of the state; first, second (uint32): indices into models; state (uint8): see PairState; certainty
        (uint8): see Certainty; fidelity (uint8): see Fidelity; distance (float64): m, signed; first_point,
        second_point, normal (float64, (3,)): for the nearest two elements, NaN with verdict_only; first_element,
        second_element (uint32): index of the <collision> (or shape) within its link.
        """
    @property
    def nearest(self) -> NDArray[np.void]:
        """(k,), structured: what has min_distance, of each state in which it is not a bound; none with verdict_only.

        row, first, second, distance, first_point, second_point, normal, first_element, second_element: as in pairs.
        """
    @property
    def left_out(self) -> NDArray[np.void]:
        """(l,), structured: row (int64), model (uint32): without a finite pose or size; its state is not FREE."""
    @property
    def gradient(self) -> NDArray[np.float64]:
        """(p, joints): d(distance)/d(position) of each pair, m/rad or m/m; NaN if there is none."""
    @property
    def models(self) -> NDArray[np.str_]:
        """(m,): model names of the scene."""
    @property
    def joints_at_zero(self) -> List[str]:
        """Moving joints that were not named: taken as zero, or their nearest limit."""
    @property
    def unchecked(self) -> str:
        """Usually empty: why there is nothing to check, or the robot or the environment is not checked at all. The
        verdict is then never FREE, unless the setting allow_empty_scene permits it."""

class Detector:
    """Checks joint states of a scene. A second thread waits for the first: use one detector per thread."""
    def __init__(self, scene: Scene, threads: int = 0) -> None:
        """threads: of a batch; 0: one per core."""
    def check(self, states: ArrayLike, joints: Optional[Sequence[str]] = None, alarm_distance: float = 0.05,
              fidelity: Union[str, Fidelity] = "mesh", min_distance: bool = False, verdict_only: bool = False,
              time_budget: float = 0.0, gradient: bool = False, tolerance: float = 0.0,
              broad_phase: str = "auto") -> CheckResult:
        """states: (n, len(joints)), or (len(joints),) for one; rad or m. float64 is read in place, with any strides;
        float32, integers and lists are converted. joints: None: Detector.joints; joints that are not named are taken
        as zero, or their nearest limit, with a warning. alarm_distance: m, pairs up to this far apart are reported.
        fidelity: aabb, spheres, obb, convex or mesh. min_distance: the exact smallest, even beyond the alarm distance.
        verdict_only: ends at the first contact. time_budget: s per state, 0: no limit. gradient: of each distance.
        tolerance: m by which a distance may be too small (LOWER_BOUND); contacts stay exact; 0 with gradient.
        """
    @property
    def joints(self) -> List[str]: ...

class MotionResult:
    """Result for the n - 1 segments of n waypoints."""
    @property
    def verdict(self) -> NDArray[np.uint8]:
        """(n - 1,): FREE: certified, no pair comes closer than the clearance; COLLISION: a contact was found;
        UNKNOWN: neither."""
    @property
    def clearance(self) -> NDArray[np.float64]:
        """(n - 1,), m: if FREE, a lower bound of the smallest distance of the segment; otherwise 0."""
    @property
    def contact_at(self) -> NDArray[np.float64]:
        """(n - 1,): if COLLISION, the fraction of the segment, 0 to 1, at which the contact was found; otherwise 0."""
    @property
    def free_until(self) -> NDArray[np.float64]:
        """(n - 1,): the fraction of the segment, 0 to 1, up to which it is certified with the clearance; 1: FREE.
        Without from_start 0 for COLLISION."""
    @property
    def pairs(self) -> NDArray[np.void]:
        """(p,), structured: segment (int64), first, second (uint32, in models): in contact there, or not certified."""
    @property
    def models(self) -> NDArray[np.str_]: ...
    @property
    def joints_at_zero(self) -> List[str]: ...
    @property
    def unchecked(self) -> str:
        """As in CheckResult."""

class MotionCheck:
    """Certifies straight motions in joint space between waypoints."""
    def __init__(self, scene: Scene, threads: int = 0) -> None: ...
    def check(self, waypoints: ArrayLike, joints: Optional[Sequence[str]] = None, clearance: float = 0.0,
              resolution: float = 0.001, fidelity: Union[str, Fidelity] = "mesh",
              from_start: bool = False) -> MotionResult:
        """waypoints: (n, len(joints)), rad or m. joints: as in Detector.check. clearance: m, FREE means that no pair
        comes closer. resolution: m, a pair still open when its motion is split finer is given up.
        from_start: also certify what lies before a contact, for free_until, at a higher cost."""
