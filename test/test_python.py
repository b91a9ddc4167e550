"""The Python module: what it answers, and what it refuses."""
import copy
import os
import pickle
import warnings

import numpy as np
import pytest
from conftest import DEMO, PROJECT
from seed import given_seed

import collision_pairs as cp

BALL = "<collision><geometry><sphere radius='%s'/></geometry></collision>"
# A ball of 0.1 m at the origin; a ball of 0.05 m that slides out along x, which turns about z.
URDF = ("<robot name='slider'><link name='base'>" + BALL % 0.1 + "</link><link name='mid'/>"
        "<link name='tip'>" + BALL % 0.05 + "</link>"
        "<joint name='turn' type='continuous'><parent link='base'/><child link='mid'/><axis xyz='0 0 1'/></joint>"
        "<joint name='slide' type='prismatic'><parent link='mid'/><child link='tip'/><axis xyz='1 0 0'/>"
        "<limit lower='0' upper='2' effort='1' velocity='1'/></joint></robot>")
CLEAR, TOUCHING = 0.3, 0.12  # m on the slide; in contact below 0.15


def translation(x, y, z):
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


def detector(threads=0, **scene):
    return cp.Detector(cp.Scene(cp.Robot(URDF), srdf="<robot name='slider'/>", **scene), threads=threads)


def states(count=200):
    random = np.random.default_rng(given_seed())
    return np.stack([random.uniform(-3, 3, count), random.uniform(0, 0.4, count)], axis=1)


# What it answers


def test_distances_points_and_verdicts_of_two_balls_are_those_of_the_formula():
    given = states()
    result = detector().check(given, ["turn", "slide"], alarm_distance=1.0)
    angle, slide = given.T
    np.testing.assert_allclose(result.min_distance, slide - 0.15, atol=1e-14)
    np.testing.assert_array_equal(result.verdict, np.where(slide <= 0.15, cp.Verdict.COLLISION, cp.Verdict.FREE))
    np.testing.assert_array_equal(result.in_collision, slide <= 0.15)
    assert not result.min_distance_is_bound.any()
    pairs = result.pairs
    np.testing.assert_array_equal(pairs["row"], np.arange(len(given)))
    assert {tuple(result.models[list(pair)]) for pair in zip(pairs["first"], pairs["second"])} == {("base", "tip")}
    outwards = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    np.testing.assert_allclose(pairs["normal"], outwards, atol=1e-12)
    np.testing.assert_allclose(pairs["first_point"], 0.1 * outwards, atol=1e-12)
    np.testing.assert_allclose(pairs["second_point"], (slide[:, None] - 0.05) * outwards, atol=1e-12)
    np.testing.assert_array_equal(pairs["state"], np.where(slide <= 0.15, cp.PairState.CONTACT, cp.PairState.NEAR))
    for field in result.nearest.dtype.names:
        np.testing.assert_array_equal(result.nearest[field], pairs[field])
    assert set(pairs["certainty"]) == {cp.Certainty.EXACT} and set(pairs["fidelity"]) == {cp.Fidelity.MESH}
    assert len(result.left_out) == 0 and result.joints_at_zero == []


def test_a_smallest_distance_of_which_only_a_bound_is_known_is_called_a_bound():
    result = detector().check([[0, CLEAR], [0, TOUCHING], [0, CLEAR]], alarm_distance=0.01)
    np.testing.assert_array_equal(result.min_distance_is_bound, [True, False, True])
    assert 0 < result.min_distance[0] <= CLEAR - 0.15
    np.testing.assert_array_equal(result.nearest["row"], [1])


def test_a_file_that_is_not_in_utf_8_is_refused_with_its_line(tmp_path):
    urdf, srdf = tmp_path / "robot.urdf", tmp_path / "robot.srdf"
    for name in ("caf\u00e9", "na\u00efve", "\u30ed"):
        urdf.write_text("<robot name='r'>\n<link name='%s'/></robot>" % name, encoding="utf-8")
        srdf.write_text("<robot name='r'>\n<group name='g'><link name='%s'/></group></robot>" % name, encoding="utf-8")
        cp.Robot(urdf, srdf)
    for file in (urdf, srdf):
        whole = file.read_bytes()
        file.write_bytes(whole.replace("\u30ed".encode(), b"caf\xe9"))
        with pytest.raises(cp.InputError, match="%s line 2: it is not in UTF-8" % file):
            cp.Robot(urdf, srdf)
        file.write_bytes(whole)


def test_an_error_about_a_path_of_any_bytes_is_an_input_error(tmp_path):
    with pytest.raises(cp.InputError, match=r"\\xff.urdf.*cannot be opened"):
        cp.Robot(os.fsencode(tmp_path) + b"/\xff.urdf")


def test_either_broad_phase_finds_the_same_pairs():
    states = [[0.1 * i, CLEAR - 0.05 * i] for i in range(30)]
    auto, sweep = (detector().check(states, alarm_distance=1.0, broad_phase=name) for name in ("auto", "sweep"))
    assert len(auto.pairs) > 0
    np.testing.assert_array_equal(auto.pairs, sweep.pairs)


def test_what_is_nearest_is_named_beyond_the_alarm_distance_too():
    tested = detector()
    result = tested.check([[0, CLEAR], [0, TOUCHING], [0, CLEAR + 1]], alarm_distance=0.01, min_distance=True)
    nearest = result.nearest
    np.testing.assert_array_equal(nearest["row"], [0, 1, 2])
    np.testing.assert_array_equal(nearest["distance"], result.min_distance)
    np.testing.assert_allclose(nearest["second_point"][:, 0] - nearest["first_point"][:, 0], result.min_distance, atol=1e-12)
    assert {tuple(result.models[list(pair)]) for pair in zip(nearest["first"], nearest["second"])} == {("base", "tip")}
    assert len(tested.check([0, TOUCHING], min_distance=True, verdict_only=True).nearest) == 0


def test_limits_are_those_of_the_description_and_infinite_without():
    def joint(name, kind, limit=""):
        return ("<link name='%s'/><joint name='to_%s' type='%s'><parent link='base'/><child link='%s'/>"
                "<axis xyz='0 0 1'/>%s</joint>" % (name, name, kind, name, limit))
    def limited(lower, upper):
        return "<limit lower='%s' upper='%s' effort='1' velocity='1'/>" % (lower, upper)
    robot = cp.Robot("<robot name='r'><link name='base'/>" + joint("a", "revolute", limited(-1, 2))
                     + joint("b", "continuous") + joint("c", "prismatic", limited(0, 0.5))
                     + joint("d", "prismatic", limited(-0.5, 0)) + joint("e", "prismatic", limited(0, 0)) + "</robot>")
    np.testing.assert_array_equal(robot.limits, [[-1, 2], [-np.inf, np.inf], [0, 0.5], [-0.5, 0], [-np.inf, np.inf]])


def test_the_gradient_is_the_slope_of_the_distance_for_the_joints_in_the_order_given():
    post = cp.RigidObject("post", [cp.Sphere(0.1)], pose=translation(1, 0, 0))
    tested, given = detector(objects=[post]), states(50)
    result = tested.check(given[:, ::-1], ["slide", "turn"], alarm_distance=2.0, gradient=True)
    slide, turn = given[result.pairs["row"]].T[::-1]
    with_post = result.models[result.pairs["second"]] == "tip"
    with_post &= result.models[result.pairs["first"]] == "post"
    to_post = np.hypot(slide * np.cos(turn) - 1, slide * np.sin(turn))
    expected = np.where(with_post[:, None],
                        np.stack([(slide - np.cos(turn)) / to_post, slide * np.sin(turn) / to_post], axis=1),
                        np.stack([1.0 + 0 * slide, 0 * slide], axis=1))
    expected[result.models[result.pairs["second"]] == "post"] = 0  # base and post: neither moves
    np.testing.assert_allclose(result.gradient, expected, atol=1e-9)
    assert with_post.sum() == 50


def test_where_there_is_no_gradient_every_number_is_nan():
    result = detector().check([[0, TOUCHING]], fidelity="aabb", gradient=True)
    assert np.isnan(result.gradient).all() and result.gradient.shape == (1, 2)


def test_one_state_is_answered_by_numbers_and_a_batch_of_one_by_arrays():
    tested = detector()
    one, batch = tested.check([0, TOUCHING]), tested.check([[0, TOUCHING]])
    assert (one.verdict, one.in_collision) == (cp.Verdict.COLLISION, True)
    assert one.min_distance == pytest.approx(TOUCHING - 0.15, abs=1e-14)
    assert batch.verdict.shape == batch.in_collision.shape == batch.min_distance.shape == (1,)
    assert one.pairs == batch.pairs and one.nearest == batch.nearest


def test_a_batch_is_answered_as_its_states_one_by_one_on_any_number_of_threads():
    robot = demo_robot()
    scene = cp.Scene(robot)
    random = np.random.default_rng(given_seed())
    given = random.uniform(-1.5, 1.5, (300, len(robot.joints)))
    single = [cp.Detector(scene).check(state, gradient=True) for state in given]
    for threads in (1, 3):
        batch = cp.Detector(scene, threads=threads).check(given, gradient=True)
        np.testing.assert_array_equal(batch.verdict, [one.verdict for one in single])
        np.testing.assert_array_equal(batch.min_distance, [one.min_distance for one in single])
        assert np.array_equal(batch.gradient, np.concatenate([one.gradient for one in single]), equal_nan=True)
        for name in batch.pairs.dtype.names:
            if name != "row":
                np.testing.assert_array_equal(batch.pairs[name], np.concatenate([one.pairs[name] for one in single]))
        near = np.flatnonzero(~batch.min_distance_is_bound)
        np.testing.assert_array_equal(batch.nearest["row"], near)
        for name in batch.nearest.dtype.names[1:]:
            np.testing.assert_array_equal(batch.nearest[name], [single[i].nearest[name][0] for i in near])
    assert batch.in_collision.any() and not batch.in_collision.all()


def demo_robot():
    os.environ["ROS_PACKAGE_PATH"] = PROJECT + ":/usr/share"
    return cp.Robot(DEMO + "/demo_robot.urdf", srdf=DEMO + "/demo_robot.srdf")


def test_time_that_is_spent_is_unknown_and_never_free():
    result = detector().check(np.tile([np.pi / 4, 0.16], (100, 1)), time_budget=1e-12)
    assert set(result.verdict) == {cp.Verdict.UNKNOWN} and result.in_collision.all()
    assert set(result.pairs["state"]) == {cp.PairState.UNRESOLVED}


def test_joints_that_are_not_named_are_warned_of_and_listed():
    with pytest.warns(UserWarning, match="slide"):
        result = detector().check([[0.1]], ["turn"])
    assert result.joints_at_zero == ["slide"] and result.in_collision.all()  # the slide is in
    with pytest.warns(UserWarning, match="slide"):
        motion = cp.MotionCheck(cp.Scene(cp.Robot(URDF), srdf="<robot name='slider'/>")).check([[0], [1]], ["turn"])
    assert motion.joints_at_zero == ["slide"] and motion.verdict[0] == cp.Verdict.COLLISION


def test_settings_that_only_the_node_follows_are_named_in_a_warning():
    ignored = "ignored, so a state may be free only without them: robots, cloud 'camera/points'$"
    with pytest.warns(UserWarning, match=ignored):
        detector(settings={"clouds": [{"topic": "camera/points"}], "robots": [{"description": "other"}]})
    world = cp.Robot("<robot name='world'><link name='room'>" + BALL % 0.2 + "</link></robot>")
    with pytest.warns(UserWarning, match="only without them: fixed_frame$"):
        detector(world=world, settings={"links": ["tip"], "fixed_frame": "map"})


def test_objects_settings_and_a_world_are_in_the_scene():
    box = cp.RigidObject("held", [cp.Box([0.1, 0.1, 0.1])], pose=translation(-0.1, 0, 0), attached_link="tip",
                         touch_links=["tip"])
    assert detector(objects=[box]).check([0, 0.3]).models.tolist() == ["base", "held", "tip"]

    def distance(checked):
        return pytest.approx(checked.check([0, 0.3], min_distance=True).min_distance, abs=1e-12)
    assert distance(detector(objects=[box])) == 0.05
    assert distance(detector(settings={"padding": 0.1})) == -0.05
    assert distance(detector(settings={"floor": {"height": -0.06, "touch_links": ["base"]}, "rate": 50.0})) == 0.01
    world = cp.Robot("<robot name='world'><link name='room'>" + BALL % 0.2 + "</link></robot>")
    assert distance(detector(world=world, settings={"links": ["tip"]})) == 0.05
    far = cp.RigidObject("far", [cp.Sphere(0.1)], pose=translation(0, 0, 9))
    scene = cp.Scene(cp.Robot(URDF), srdf="<robot name='slider'/>", objects=[far]).with_objects([box])
    assert distance(cp.Detector(scene)) == 0.05
    assert [o.name for o in scene.objects] == ["held"]


def test_floats_integers_lists_and_any_strides_are_read_alike():
    tested, given = detector(), states()
    expected = tested.check(given, alarm_distance=1.0).min_distance
    wide = np.full((400, 5), np.nan)
    wide[::-2, 1::3] = given
    for same in (given.tolist(), np.asfortranarray(given), wide[::-2, 1::3], given.astype(">f8")):
        np.testing.assert_array_equal(tested.check(same, alarm_distance=1.0).min_distance, expected)
    unaligned = np.frombuffer(b"." + given.tobytes(), offset=1).reshape(given.shape)
    np.testing.assert_array_equal(tested.check(unaligned, alarm_distance=1.0).min_distance, expected)
    np.testing.assert_allclose(tested.check(given.astype("f4"), alarm_distance=1.0).min_distance, expected, atol=1e-6)
    assert tested.check(np.array([[0, 1]], "i8"), alarm_distance=1.0).min_distance == pytest.approx(0.85)
    assert tested.check(np.zeros((0, 2))).verdict.shape == (0,)


def test_motions_are_certified_or_the_contact_between_their_ends_is_found():
    post = cp.RigidObject("post", [cp.Sphere(0.05)], pose=translation(0.4, 0, 0))
    scene = cp.Scene(cp.Robot(URDF), srdf="<robot name='slider'/>", objects=[post])
    # Past the post, to and fro at its distance, to the ball at the origin, and on the spot.
    waypoints = [[-1.0, 0.4], [1.0, 0.4], [1.0, 0.3], [2.0, 0.3], [2.0, 0.1], [2.0, 0.1]]
    for threads in (1, 2):
        result = cp.MotionCheck(scene, threads=threads).check(waypoints, ["turn", "slide"], clearance=0.01,
                                                               from_start=True)
        free, hit = cp.Verdict.FREE, cp.Verdict.COLLISION
        assert result.verdict.tolist() == [hit, free, free, hit, hit]
        turned = -1.0 + 2.0 * result.contact_at[0]
        assert 2 * 0.4 * abs(np.sin(turned / 2)) <= 0.1  # the chord between the two centres
        assert 0.3 - 0.2 * result.contact_at[3] <= 0.15
        np.testing.assert_array_equal(result.contact_at[1:3], 0)
        # A centimetre from the post, and from the ball at the origin; on the spot they touch.
        first_near = [(1 - 2 * np.arcsin(0.11 / 0.8)) / 2, 1, 1, (0.3 - 0.16) / 0.2, 0]
        np.testing.assert_allclose(result.free_until, first_near, atol=0.01)
        assert (result.free_until <= first_near).all()
        assert (result.clearance[1:3] >= 0.01).all() and (result.clearance[1:3] <= 0.15).all()
        named = [(p["segment"], *result.models[[p["first"], p["second"]]]) for p in result.pairs]
        assert named == [(0, "post", "tip"), (3, "base", "tip"), (4, "base", "tip")]
    np.testing.assert_array_equal(cp.MotionCheck(scene).check(waypoints, ["turn", "slide"]).free_until, [0, 1, 1, 0, 0])
    # 0.15 m to the ball at the origin: more is not kept.
    near = cp.MotionCheck(scene).check([[1.0, 0.3], [2.0, 0.3]], clearance=0.2)
    assert near.verdict.tolist() != [free]


def test_what_numpy_takes_for_an_array_is_one_although_it_has_a_method_mask():
    class Frame:  # as pandas' DataFrame
        def __array__(self, dtype=None, copy=None):
            return np.array([[0.0, 0.3]])

        def mask(self):
            pass

    np.testing.assert_array_equal(detector().check(Frame()).verdict, detector().check([[0.0, 0.3]]).verdict)


# What it refuses: the exception names the thing


REFUSED_STATES = {
    r"joint 'turn': its position is not finite": [np.inf, 0.3],
    r"shape \(1, 1, 2\), but 2 joints": [[[0, 0]]],
    r"shape \(\), but 2 joints": 0.0,
    r"dtype <U1": ["0", "1"],
    r"dtype bool": [True, False],
    r"dtype complex128": [1j, 0],
    r"dtype object": None,
    r"no array|dtype object": [[0, 1], [0]],
    r"masked": np.ma.masked_array([0, 1.0], mask=[True, False]),
    r"maske[d]": [np.ma.masked_array([0, 1.0], mask=[True, False])],
    r"mask[e]d": ([0.0, 1.0], [0.0, np.ma.masked]),
}


@pytest.mark.parametrize("says", REFUSED_STATES)
def test_states_that_are_none_are_refused(says):
    with pytest.raises(cp.InputError, match=says):
        detector().check(REFUSED_STATES[says])


REFUSED = {
    "joint 'slyde' is not in robot 'slider'": lambda: detector().check([[0.0]], ["slyde"]),
    "joint 'turn' is named twice": lambda: detector().check([[0.0, 0.0]], ["turn", "turn"]),
    "joints must be a list of name[s]": lambda: detector().check([0.0, 0.0], {"turn", "slide"}),
    "joints must be a list of na[m]es": lambda: detector().check([0.0, 0.0], frozenset(["turn", "slide"])),
    "padding is true, but must be": lambda: detector(settings={"padding": np.True_}),
    "size must be an array of shape": lambda: cp.Box(np.ma.masked_array([1, 1, 1.0], mask=[False, True, False])),
    "size must be an array of shap[e]": lambda: cp.Box([1, 1, 1j]),
    "pose must be an array of shape": lambda: cp.RigidObject("a", [cp.Sphere(1)], pose=np.ma.masked_array(np.eye(4))),
    "vertices must be an array of shape": lambda: cp.Convex(np.ma.masked_array(np.eye(3))),
    "scale has a factor that is 0 or not finite": lambda: cp.Mesh.from_uri("file:///none.stl", [1, 0, 1]),
    "scale has a factor that is 0 or not finit[e]": lambda: cp.Mesh.from_uri("file:///none.stl", [1, 1, np.inf]),
    "unknown fidelity 'hull'": lambda: detector().check([0, 1], fidelity="hull"),
    "the alarm distance is nan": lambda: detector().check([0, 1], alarm_distance=np.nan),
    "unknown broad phase 'grid'": lambda: detector().check([0, 1], broad_phase="grid"),
    "the time budget is -1": lambda: detector().check([0, 1], time_budget=-1),
    "cannot be combined with verdict_only": lambda: detector().check([0, 1], gradient=True, verdict_only=True),
    "nowhere.urdf: cannot be opened": lambda: cp.Robot("nowhere.urdf"),
    "urdf: .*line 1": lambda: cp.Robot.from_urdf("<robot"),
    "urdf: .*mesh 'package://none/x.stl'": lambda: cp.Robot(
        "<robot name='r'><link name='a'><collision><geometry><mesh filename='package://none/x.stl'/></geometry>"
        "</collision></link></robot>"),
    "'paddding' is not a setting; did you mean 'padding'": lambda: detector(settings={"paddding": 1}),
    "settings: padding is nan": lambda: detector(settings={"padding": np.nan}),
    "settings: .*is not a number, text, list or map": lambda: detector(settings={"padding": object()}),
    "nesting|recursion": lambda: detector(settings=endless()),
    "object 'a': .*poses": lambda: cp.RigidObject("a", [cp.Sphere(1)], poses=[]),
    "'nolink'": lambda: detector(objects=[cp.RigidObject("a", [cp.Sphere(1)], attached_link="nolink")]),
    "'tip'": lambda: detector(objects=[cp.RigidObject("tip", [cp.Sphere(1)])]),
    "radius is -1": lambda: cp.Sphere(-1),
    "two or more waypoints": lambda: motions().check([[0, 1]]),
    "joint 'x' is not in robot": lambda: motions().check([[0], [1]], ["x"]),
    "clearance": lambda: motions().check([[0, 1], [0, 1]], clearance=-1),
    "resolution": lambda: motions().check([[0, 1], [0, 1]], resolution=0),
    "no pair to check": lambda: detector(settings={"links": ["mid"]}),
    "surrogates": lambda: detector().check([0.0], ["\ud800"]),
    "neither true nor false": lambda: bool(detector().check([0, 1])),
    "not int": lambda: cp.Robot(3),
    "argument types": lambda: cp.Scene(None),
    "cannot pickle 'collision_pairs.Detector'": lambda: pickle.dumps(detector()),
    "cannot pickle 'collision_pairs.Scene'": lambda: copy.copy(cp.Scene(cp.Robot(URDF), srdf="<robot name='r'/>")),
    "has no attribute 'Sceen'": lambda: cp.Sceen,
}


def motions():
    return cp.MotionCheck(cp.Scene(cp.Robot(URDF), srdf="<robot name='slider'/>"))


def endless():
    settings = {}
    settings["padding"] = settings
    return settings


@pytest.mark.parametrize("says", REFUSED)
def test_wrong_input_is_refused(says):
    with pytest.raises((ValueError, TypeError, RecursionError, AttributeError), match=says):
        REFUSED[says]()
    assert detector().check([0, CLEAR]).verdict == cp.Verdict.FREE  # and all goes on


def test_a_warning_that_is_an_error_ends_every_such_call():
    tested = detector()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for _ in range(2):
            with pytest.raises(UserWarning):
                tested.check([0.0], ["turn"])
