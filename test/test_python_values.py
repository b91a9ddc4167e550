"""Every argument and every attribute of the Python module: values that differ from each other and from the defaults."""
import warnings

import numpy as np
import pytest
from conftest import DEMO
from test_python import BALL, CLEAR, TOUCHING, URDF, detector, translation

import collision_pairs as cp

TURNED = np.array([[0, -1, 0, 1.0], [0, 0, -1, 2.0], [1, 0, 0, 3.0], [0, 0, 0, 1.0]])  # its transpose is another rotation


def scene_of(*objects, **options):
    return cp.Scene(cp.Robot(URDF), srdf="<robot name='slider'/>", objects=list(objects), **options)


def distance(scene, first, second, state=(0, CLEAR)):
    result = cp.Detector(scene).check(state, alarm_distance=50.0)
    named = [{*result.models[[pair["first"], pair["second"]]]} for pair in result.pairs]
    return result.pairs["distance"][named.index({first, second})]


# Robots


def test_a_robot_is_what_its_description_says():
    text = URDF.replace("</robot>", "<link name='tail'/><joint name='follow' type='revolute'><parent link='tip'/><child link='tail'/>"
                        "<limit lower='-1' upper='2' effort='1' velocity='1'/><mimic joint='slide'/></joint></robot>")
    for robot in (cp.Robot(text), cp.Robot.from_urdf(text)):
        assert (robot.name, robot.links, robot.joints) == ("slider", ["base", "mid", "tip", "tail"], ["turn", "slide"])
        assert repr(robot) == "<Robot 'slider', 4 links, 2 joints>"
    with pytest.warns(UserWarning, match="^srdf: not links of the robot, ignored: nobody$"):
        cp.Robot(URDF, srdf="<robot name='slider'><disable_collisions link1='nobody' link2='tip'/></robot>")


def test_the_srdf_of_a_scene_stands_for_that_of_its_robot(tmp_path):
    off = "<robot name='slider'><disable_collisions link1='base' link2='tip'/></robot>"
    path = tmp_path / "on.srdf"
    path.write_text("<robot name='slider'/>")
    robot = cp.Robot(URDF, srdf=off)
    with pytest.warns(UserWarning, match="^there is no pair to check: nothing is FREE; if that is meant, permit it by settings="):
        assert cp.Scene(robot).models.tolist() == []
    for srdf in (path, str(path), path.read_text()):
        assert cp.Scene(robot, srdf=srdf).models.tolist() == ["base", "tip"]
    allowed = {"allow_empty_scene": True}
    with pytest.warns(UserWarning, match="^there is no pair to check: what is FREE is so because allow_empty_scene permits it$"):
        result = cp.Detector(cp.Scene(robot, settings=allowed)).check([0, 0.0])
    assert result.verdict == cp.Verdict.FREE and result.unchecked == "there is no pair to check"


# Shapes and objects


def test_shapes_are_where_and_as_large_as_their_arguments_say():
    tetrahedron = [[0, 0, 0], [-1, 0, 0], [0, -2, 0], [0, 0, -3]]
    faces = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]
    uri = "file://" + DEMO + "/meshes/arch.obj"  # 0.36 x 0.06 x 0.34 m on its origin
    below = {"box": (cp.Box([0.2, 0.4, 0.6]), (0.1, 0.2, 0.3)), "cylinder": (cp.Cylinder(0.1, 0.8), (0.1, 0.1, 0.4)),
             "capsule": (cp.Capsule(0.1, 0.8), (0.1, 0.1, 0.5)), "by name": (cp.Capsule(length=0.6, radius=0.2), (0.2, 0.2, 0.5)),
             "sphere": (cp.Sphere(0.7), (0.7, 0.7, 0.7)),
             "convex": (cp.Convex(tetrahedron), (1, 2, 3)), "mesh": (cp.Mesh(tetrahedron, faces), (1, 2, 3)),
             "file": (cp.Mesh.from_uri(uri), (0.18, 0.03, 0)), "scaled": (cp.Mesh.from_uri(uri, [2, 3, -4]), (0.36, 0.09, 1.36))}
    for name, (shape, reach) in below.items():
        for axis in range(3):
            place = np.full(3, 0.0)
            place[axis] = -5.0
            plate = np.full(3, 20.0)
            plate[axis] = 0.5
            found = distance(scene_of(cp.RigidObject("shape", [shape], attached_link="base"),
                                      cp.RigidObject("plate", [cp.Box(plate)], pose=translation(*place))), "plate", "shape")
            assert found == pytest.approx(5 - 0.25 - reach[axis], abs=1e-6), (name, axis)
    floor = cp.RigidObject("floor", [cp.HalfSpace()], pose=translation(0, 0, -0.4), touch_links=["tip"])
    assert distance(scene_of(floor), "base", "floor") == pytest.approx(0.3, abs=1e-12)


def test_an_object_has_what_it_was_given():
    given = {"attached_link": "tip", "touch_links": ["tip", "base"], "padding": 0.25, "pose": TURNED}
    held = cp.RigidObject("held", [cp.Sphere(0.1), cp.Sphere(0.2)], **given)
    assert (held.name, held.attached_link, held.touch_links, held.padding) == ("held", "tip", ["tip", "base"], 0.25)
    np.testing.assert_allclose(held.pose, TURNED, atol=1e-15)
    plain = cp.RigidObject(name="plain", shapes=[cp.Sphere(0.1)])
    assert (plain.attached_link, plain.touch_links, plain.padding) == ("", [], 0.0)
    np.testing.assert_array_equal(plain.pose, np.eye(4))
    assert repr(held) == "<RigidObject 'held', 2 shapes, attached to 'tip'>" and repr(plain) == "<RigidObject 'plain', 1 shape>"
    by_place = cp.RigidObject("held", [cp.Sphere(0.1), cp.Sphere(0.2)], None, TURNED, "tip", ["tip", "base"], 0.25)
    assert repr(by_place) == repr(held) and by_place.touch_links == held.touch_links and by_place.padding == held.padding


def test_each_shape_is_at_its_pose_in_the_object_and_that_at_its_own():
    poses = [translation(0.1, 0.2, 0.3), TURNED @ translation(1, 0, 0)]
    target = np.array([-3.0, 4.0, 5.0])
    for link, X_WL in ((None, np.eye(4)), ("tip", translation(CLEAR, 0, 0))):
        small, large = (cp.RigidObject("pair", [cp.Sphere(a), cp.Sphere(b)], poses=given, pose=TURNED, attached_link=link or "")
                        for a, b, given in ((0.25, 1e-3, poses), (1e-3, 0.25, np.array(poses))))
        post = cp.RigidObject("post", [cp.Sphere(0.5)], pose=translation(*target), attached_link="" if link else "base")
        for held in (small, large):
            to_each = [np.linalg.norm((X_WL @ TURNED @ pose)[:3, 3] - target) for pose in poses]
            radii = (0.25, 1e-3) if held is small else (1e-3, 0.25)
            expected = min(to - radius - 0.5 for to, radius in zip(to_each, radii))
            assert distance(scene_of(held, post), "pair", "post") == pytest.approx(expected, abs=1e-9)


def test_padding_and_touch_links_of_an_object_count():
    def ball(**given):
        return scene_of(cp.RigidObject("ball", [cp.Sphere(0.1)], pose=translation(0, 1, 0), **given))
    assert distance(ball(), "ball", "base") == pytest.approx(0.8, abs=1e-12)
    assert distance(ball(padding=0.25), "ball", "base") == pytest.approx(0.55, abs=1e-12)
    for link, other in (("base", "tip"), ("tip", "base")):
        scene = ball(touch_links=[link])
        distance(scene, "ball", other)
        with pytest.raises(ValueError, match="not in list"):
            distance(scene, "ball", link)


def stretched(by):
    pose = TURNED.copy()
    pose[:3, :3] *= by
    return pose


def changed(row, column, value):
    pose = TURNED.copy()
    pose[row, column] = value
    return pose


IS_POSE = "object 'a': pose is not a pose: it needs a rotation, finite metres, and 0 0 0 1 in the last row"
POSE_SHAPE = "object 'a': pose must be an array of shape (4, 4): a homogeneous transform"
REFUSED = [
    ({"pose": changed(0, 3, np.nan)}, IS_POSE), ({"pose": changed(0, 1, np.inf)}, IS_POSE), ({"pose": changed(0, 1, 1)}, IS_POSE),
    ({"pose": changed(3, 0, 1e-9)}, IS_POSE), ({"pose": changed(3, 3, 2)}, IS_POSE), ({"pose": stretched(1.00051)}, IS_POSE),
    ({"pose": stretched(0.99949)}, IS_POSE), ({"pose": np.zeros((3, 4))}, POSE_SHAPE), ({"pose": np.zeros((4, 3))}, POSE_SHAPE),
    ({"pose": np.zeros(16)}, POSE_SHAPE), ({"pose": np.zeros((1, 4, 4))}, POSE_SHAPE), ({"pose": "here"}, POSE_SHAPE),
    ({"poses": [np.eye(4), changed(3, 3, 0)]}, IS_POSE.replace("pose is", "poses[1] is")),
    ({"poses": [np.eye(4)]}, "object 'a': 2 shapes, but 1 poses; give one each, or None"),
    ({"poses": [np.eye(4)] * 3}, "object 'a': 2 shapes, but 3 poses; give one each, or None"),
    ({"padding": -0.5}, "object 'a': padding is -0.500000, but must be 0 or more metres"),
    ({"padding": np.nan}, "object 'a': padding is nan, but must be 0 or more metres"),
    ({"padding": np.inf}, "object 'a': padding is inf, but must be 0 or more metres"),
    ({"name": ""}, "an object has no name")]


def test_what_is_wrong_with_an_object_is_said_in_these_words():
    for given, words in REFUSED:
        with pytest.raises(cp.InputError) as refused:
            cp.RigidObject(**{"name": "a", "shapes": [cp.Sphere(1), cp.Sphere(2)], **given})
        assert str(refused.value) == words
    for by in (1.00049, 0.99951):  # as rounding may leave it
        pose = cp.RigidObject("a", [cp.Sphere(1)], pose=stretched(by)).pose
        np.testing.assert_allclose(pose, TURNED, atol=1e-3)
        np.testing.assert_allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3), atol=1e-15)


@pytest.mark.parametrize("vertices", [0.0, [0, 0, 0], [[0, 0]], [[0, 0, 0, 0]], [[[0, 0, 0]]], "corners"])
def test_vertices_that_are_not_rows_of_three_are_refused(vertices):
    for make in (cp.Convex, lambda rows: cp.Mesh(rows, [[0, 1, 2]])):
        with pytest.raises(cp.InputError, match=r"^vertices must be an array of shape \(n, 3\)$"):
            make(vertices)
    with pytest.raises(cp.InputError, match=r"^triangles must be an array of shape \(n, 3\)$"):
        cp.Mesh(np.eye(3), vertices)
    with pytest.raises(cp.InputError, match=r"^triangles must be an array of shape \(n, 3\)$"):
        cp.Mesh(np.eye(3), np.eye(3) > 0)  # indices 0 and 1


@pytest.mark.parametrize("index", [-1, 0.5, 2.0**32, np.nan, np.inf])
@pytest.mark.parametrize("corner", [0, 1, 2])
def test_an_index_that_is_none_is_refused_with_its_triangle(index, corner):
    triangles = np.array([[0, 1, 2], [0, 1, 2], [0, 1, 2.0]])
    triangles[1, corner] = index
    with pytest.raises(cp.InputError, match=r"^triangles\[1\] has an invalid index$"):
        cp.Mesh(np.eye(3), triangles)
    with pytest.raises(cp.InputError, match="refers to vertex 3"):
        cp.Mesh(np.eye(3), [[0, 1, 3]])
    with pytest.raises(cp.InputError, match="refers to vertex 4294967295"):
        cp.Mesh(np.eye(3), [[0, 1, 2**32 - 1]])


# Scenes


def test_a_scene_says_what_is_in_it():
    scene = scene_of(cp.RigidObject("post", [cp.Sphere(0.1)], pose=translation(0, 5, 0)))
    assert repr(scene) == "<Scene of 'slider', 3 links and objects in pairs>"
    assert scene.models.tolist() == ["base", "post", "tip"] and [each.name for each in scene.objects] == ["post"]
    with pytest.raises(ValueError, match="read-only"):
        scene.models[0] = "other"
    assert scene.with_objects([]).models.tolist() == ["base", "tip"] and scene.with_objects([]).objects == []
    assert scene.models.tolist() == ["base", "post", "tip"], "another scene was made"


def test_a_floor_of_the_settings_stays_with_other_objects():
    scene = scene_of(settings={"floor": {"height": -1.0}})
    for made in (scene, scene.with_objects([cp.RigidObject("post", [cp.Sphere(0.1)], pose=translation(0, 5, 0))])):
        assert distance(made, "base", "floor") == pytest.approx(0.9, abs=1e-12)
        assert "floor" not in [each.name for each in made.objects]


def test_settings_may_be_of_any_of_pythons_types(tmp_path):
    yaml = tmp_path / "settings.yaml"
    yaml.write_text("{padding: 0.125, link_padding: {tip: 0.5}, pair_padding: [{pair: [base, tip], padding: 1}]}")
    same = [yaml, str(yaml), {"pair_padding": [{"pair": ["base", "tip"], "padding": 1}]},
            {"pair_padding": ({"pair": ("base", "tip"), "padding": np.float32(1)},)},
            {"pair_padding": [{"pair": ["base", "tip"], "padding": "1"}]},
            {"pair_padding": [{"pair": ["base", "tip"], "padding": np.array(1.0)[()]}]}]
    for settings in same:
        assert distance(scene_of(settings=settings), "base", "tip") == pytest.approx(CLEAR - 0.15 - 1, abs=1e-12)
    assert distance(scene_of(settings={"link_padding": {"tip": 0.5}, "padding": 0}), "base", "tip") == pytest.approx(-0.35, abs=1e-12)
    precise = 0.1234567890123456789
    assert distance(scene_of(settings={"padding": precise}), "base", "tip") == pytest.approx(0.15 - 2 * precise, abs=1e-16)
    for wrong, words in ((np.ones(2), r"settings: array\(\[1., 1.\]\) is not a number, text, list or map"),
                         (None, "settings: padding is (~|null), but must be 0 or more metres"),
                         (True, "settings: padding is true, but must be 0 or more metres"),
                         ([1, "a"], r"settings: padding is \[1.0, a\], but must be 0 or more metres")):
        with pytest.raises(cp.InputError, match="^" + words + "$"):
            scene_of(settings={"padding": wrong})
    with pytest.raises(cp.InputError, match="^settings: '3' is not a setting; did you mean"):
        scene_of(settings={3: 1})


# Checks


def both(x, tip=""):
    """A link of two boxes, another of three: their second and third ones are nearest to each other."""
    box = "<collision><origin xyz='%g %g 0'/><geometry><box size='0.2 0.2 0.2'/></geometry></collision>"
    return ("<robot name='pair'><link name='left'>" + box % (-2, 0) + box % (0, 0) + "</link><link name='right'>" + box % (3, 2)
            + box % (3, 1) + box % (x, 0) + "</link><joint name='j' type='prismatic'><parent link='left'/><child link='right'/>"
            "<axis xyz='1 0 0'/><limit lower='-2' upper='2' effort='1' velocity='1'/></joint></robot>")


def test_a_pair_names_its_nearest_elements_and_what_its_distance_is_worth():
    tested = cp.Detector(cp.Scene(cp.Robot(both(1.0)), srdf="<robot name='pair'/>"))
    result = tested.check([[0.0], [-0.9], [2.0]], alarm_distance=1.0)
    for rows in (result.pairs, result.nearest):
        assert rows["row"].tolist() == [0, 1] and rows["first"].tolist() == [0, 0] and rows["second"].tolist() == [1, 1]
        assert rows["first_element"].tolist() == [1, 1] and rows["second_element"].tolist() == [2, 2]
        np.testing.assert_allclose(rows["distance"], [0.8, -0.1], atol=1e-9)
        np.testing.assert_allclose(rows["first_point"][0][0], 0.1, atol=1e-9)
        np.testing.assert_allclose(rows["second_point"][0][0], 0.9, atol=1e-9)
        np.testing.assert_allclose(rows["normal"][0], [1, 0, 0], atol=1e-9)
    assert result.pairs["state"].tolist() == [cp.PairState.NEAR, cp.PairState.CONTACT]
    assert result.verdict.tolist() == [cp.Verdict.FREE, cp.Verdict.COLLISION, cp.Verdict.FREE]
    assert {*result.pairs["certainty"]} == {cp.Certainty.EXACT}
    assert {*detector().check([0, 0.3], alarm_distance=1.0, fidelity="aabb").pairs["fidelity"]} == {cp.Fidelity.AABB}
    hurried = tested.check([[-0.9]], verdict_only=True)
    assert len(hurried.pairs) == 1 and np.isnan(hurried.pairs["normal"]).all() and np.isnan(hurried.pairs["second_point"]).all()


def test_a_distance_that_is_not_exact_is_called_a_bound_of_its_kind():
    cube = np.array([[i & 1, i >> 1 & 1, i >> 2] for i in range(8)])
    faces = np.array([[0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4], [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2],
                      [1, 3, 7], [1, 7, 5]])
    angle = cp.Mesh(0.2 * np.vstack([cube, cube + [1, 0, 0], cube + [0, 1, 0]]), np.vstack([faces, faces + 8, faces + 16]))
    tested = cp.Detector(scene_of(*(cp.RigidObject(name, [angle], pose=translation(x, 0.1, 0.05), attached_link=link)
                                    for name, x, link in (("held", 0.2, "tip"), ("stands", 0.63, "")))))
    for budget, worth, state in ((0.0, cp.Certainty.DEPTH_BOUND, cp.PairState.CONTACT),
                                 (1e-12, cp.Certainty.LOWER_BOUND, cp.PairState.UNRESOLVED)):
        result = tested.check([[0, CLEAR]], time_budget=budget)
        (pair,) = [each for each in result.pairs if result.models[[each["first"], each["second"]]].tolist() == ["held", "stands"]]
        assert (pair["certainty"], pair["state"]) == (worth, state)


def test_a_result_says_in_one_line_what_is_in_it():
    tested = detector()
    free, hit = [0, CLEAR], [0, TOUCHING]
    assert repr(tested.check(hit)) == "<CheckResult of 1 state: 0 FREE, 1 COLLISION, 0 UNKNOWN; 1 pair>"
    assert repr(tested.check([free, hit, free])) == "<CheckResult of 3 states: 2 FREE, 1 COLLISION, 0 UNKNOWN; 1 pair>"
    assert repr(tested.check([hit, hit])) == "<CheckResult of 2 states: 0 FREE, 2 COLLISION, 0 UNKNOWN; 2 pairs>"
    assert repr(tested.check([[np.pi / 4, 0.16]] * 2, time_budget=1e-12)) == "<CheckResult of 2 states: 0 FREE, 0 COLLISION, 2 UNKNOWN; 2 pairs>"
    result = tested.check(free)
    assert result.models.tolist() == ["base", "tip"] and result.unchecked == "" and tested.joints == ["turn", "slide"]


def test_what_cannot_be_placed_is_left_out_in_its_row():
    slide = "<joint name='%s' type='prismatic'><parent link='%s'/><child link='%s'/><axis xyz='1 0 0'/><limit %s/></joint>"
    limit = "lower='-1' upper='1' effort='1' velocity='1'"
    robot = cp.Robot("<robot name='r'>" + "".join("<link name='%s'>%s</link>" % (name, BALL % 0.1) for name in "abc")
                     + slide % ("near", "a", "b", limit) + slide % ("far", "b", "c", limit) + "</robot>")
    held = cp.RigidObject("held", [cp.Sphere(0.01)], attached_link="c", touch_links=["c"])
    fits, beyond = [0.3, 0.3], [1.7e308, 1.7e308]  # whose sum is infinite
    for threads in (1, 3):
        tested = cp.Detector(cp.Scene(robot, srdf="<robot name='r'/>", objects=[held]), threads)
        result = tested.check([fits] + [beyond] * 5 + [fits, beyond])
        named = [(each["row"], result.models[each["model"]]) for each in result.left_out]
        assert named == [(row, name) for row in (1, 2, 3, 4, 5, 7) for name in ("c", "held")]
        assert result.verdict.tolist() == [cp.Verdict.FREE] + [cp.Verdict.UNKNOWN] * 5 + [cp.Verdict.FREE, cp.Verdict.UNKNOWN]


def test_arguments_mean_the_same_by_place_as_by_name():
    tested = detector()
    defaults = {"states": [0, 0.21], "joints": None, "alarm_distance": 0.05, "fidelity": "mesh", "min_distance": False,
                "verdict_only": False, "time_budget": 0.0, "gradient": False, "tolerance": 0.0}
    for changes, expected in (({}, (0, True, False)), ({"alarm_distance": 0.07}, (1, False, False)),
                              ({"alarm_distance": 0.04}, (0, True, False)), ({"min_distance": True}, (0, False, False)),
                              ({"alarm_distance": 0.07, "gradient": True}, (1, False, True)),
                              ({"states": [0, TOUCHING], "verdict_only": True}, (1, False, False)),
                              ({"states": [0.21, 0], "joints": ["slide", "turn"], "alarm_distance": 0.07}, (1, False, False))):
        given = {**defaults, **changes}
        for result in (tested.check(*given.values()), tested.check(**given), tested.check(**{**changes, "states": given["states"]})):
            has_gradient = True
            try:
                assert result.gradient.shape == (1, 2)
            except cp.InputError as error:
                has_gradient = False
                assert str(error) == "the gradient was not requested: check(..., gradient=True)"
            assert (len(result.pairs), result.min_distance_is_bound, has_gradient) == expected, changes


def test_a_tolerance_is_not_used_for_distances_that_have_a_gradient():
    robot = cp.Robot(URDF.replace(BALL % 0.05, "<collision><geometry><cylinder radius='0.05' length='0.1'/></geometry></collision>"))
    tested = cp.Detector(cp.Scene(robot, srdf="<robot name='slider'/>"))
    given = np.stack([np.linspace(-3, 3, 100), np.linspace(0.2, 0.9, 100)], axis=1)
    exact = tested.check(given, alarm_distance=1.0, gradient=True)
    for tolerance in (0.0, 0.05):
        result = tested.check(given, alarm_distance=1.0, gradient=True, tolerance=tolerance)
        np.testing.assert_array_equal(result.min_distance, exact.min_distance)
    for gradient in (False, True):
        for wrong in (-1, np.nan):
            with pytest.raises(cp.InputError, match="the tolerance is"):
                tested.check(given, gradient=gradient, tolerance=wrong)


def test_states_of_a_shape_that_does_not_fit_are_refused_in_these_words():
    for states, shape in ((np.zeros((2, 3)), "(2, 3)"), (np.zeros((3, 2))[0:2].T[:, :1], "(2, 1)"), (np.zeros(3), "(3,)")):
        with pytest.raises(cp.InputError) as refused:
            detector().check(states)
        assert str(refused.value) == ("states have shape %s, but 2 joints are named: (n, 2) is expected, or (2,) for one state"
                                      % shape)


def test_the_number_of_a_state_is_said_where_there_are_several():
    why = "joint 'slide': its position is not finite"
    wrong = [0, np.nan]
    for states, where in ((wrong, ""), ([wrong], "state 0: "), ([[0, 1], [0, 1], wrong], "state 2: ")):
        with pytest.raises(cp.InputError) as refused:
            detector().check(states)
        assert str(refused.value) == where + why
    with pytest.raises(cp.InputError) as refused:
        cp.MotionCheck(scene_of()).check([[0, 1], [0, 1], wrong])
    assert str(refused.value) == "waypoint 2: " + why


def test_joints_of_the_call_before_are_not_taken_for_those_of_this_one():
    tested = detector()
    state = [0.5, 0.25]
    for joints, slide in ((["slide", "turn"], 0.5), (("turn", "slide"), 0.25), (None, 0.25), (["turn", "slide"], 0.25),
                          (iter(["slide", "turn"]), 0.5), (("slide", "turn"), 0.5), (None, 0.25)):
        assert tested.check(state, joints, min_distance=True).min_distance == pytest.approx(slide - 0.15, abs=1e-12)
    for wrong in (["turn", 3], "turn", 3, [b"turn", "slide"]):
        with pytest.raises(cp.InputError, match="^joints must be a list of names$"):
            tested.check(state, wrong)
    said = []
    for joints in (["turn"], ["turn"], ["slide"], None, ["turn"]):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            tested.check(np.zeros(len(joints or state)), joints)
        said.append([str(each.message).rsplit(": ", 1)[1] for each in caught])
    assert said == [["slide"], [], ["turn"], [], ["slide"]], "once while the same joints are named"


def test_threads_are_at_most_1024():
    assert cp.MotionCheck(scene_of(), threads=1024).check([[0, 0.3], [1, 0.3]]).verdict.tolist() == [cp.Verdict.FREE]
    for make in (cp.MotionCheck, cp.Detector):
        with pytest.raises(cp.InputError, match="^threads is 1025, but must be at most 1024; 0: one per core$"):
            make(scene_of(), 1025)


def test_all_classes_are_called_by_the_name_of_the_package():
    assert {getattr(cp, name).__module__ for name in cp.__all__} == {"collision_pairs"}


# Motions


def test_motions_take_each_argument_and_fill_in_each_attribute():
    scene = scene_of(cp.RigidObject("post", [cp.Sphere(0.05)], pose=translation(0.4, 0, 0)))
    waypoints, joints = [[0.3, 2.0], [0.3, 1.0], [0.4, 1.0]], ["slide", "turn"]
    motions = cp.MotionCheck(scene, 1)
    by_place = motions.check(waypoints, joints, 0.01, 1e-3, "mesh", True)
    by_name = motions.check(waypoints=waypoints, joints=joints, clearance=0.01, resolution=1e-3, fidelity="mesh", from_start=True)
    for result in (by_place, by_name):
        assert result.verdict.tolist() == [cp.Verdict.FREE] * 2 and len(result.pairs) == 0
        assert result.clearance[0] > 0.01 and result.clearance[0] == by_place.clearance[0] != result.clearance[1]
        assert result.free_until.tolist() == [1, 1] and result.contact_at.tolist() == [0, 0]
        assert result.models.tolist() == ["base", "post", "tip"] and result.joints_at_zero == [] and result.unchecked == ""
    coarse = motions.check([[0.3, -0.6], [0.3, 0.6]], joints, clearance=0.01, resolution=10.0)
    fine = motions.check([[0.3, -0.6], [0.3, 0.6]], joints, clearance=0.0, resolution=1e-4)
    assert cp.Verdict.FREE != coarse.verdict[0] and fine.verdict[0] in (cp.Verdict.FREE, cp.Verdict.COLLISION)
    aabb = motions.check([[0.2, 0.7854], [0.2, 0.7853]], joints, fidelity="aabb")
    assert aabb.verdict[0] != cp.Verdict.FREE, "the boxes of the balls touch"
    assert motions.check([[0.2, 0.7854], [0.2, 0.7853]], joints).verdict[0] == cp.Verdict.FREE
    with pytest.raises(cp.InputError, match="two or more waypoints"):
        motions.check([0.0, 1.0])
    with pytest.raises(cp.InputError, match=r"states have shape \(2, 3\)"):
        motions.check(np.zeros((2, 3)))
