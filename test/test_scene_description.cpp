// Objects, several robots, and what a scene prepares of them.
#include <atomic>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "demo_scene.h"
#include "mixed_robot.h"
#include "refusal.h"

namespace collision_pairs::test_scene_description {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using testing::HasSubstr;

Isometry3d at(double x, double y, double z) {
  Isometry3d X = Isometry3d::Identity();
  X.translation() = Vector3d(x, y, z);
  return X;
}

RigidObject cube(const std::string& name, const Isometry3d& X_PO,
                 const std::string& attached_link = "") {
  RigidObject object;
  object.name = name;
  object.elements.push_back({Box{Vector3d::Ones()}, Isometry3d::Identity()});
  object.X_PO = X_PO;
  object.attached_link = attached_link;
  return object;
}

/// Unit cubes a and b on sliders along x.
SceneDescription twoSliders() {
  SceneDescription description;
  description.robots.push_back({robotFrom(slidingBoxes(2)), std::nullopt, ""});
  return description;
}

std::string refusalOf(const SceneDescription& description) {
  return refusal([&] { CollisionScene::build(description); });
}

std::set<std::string> contacts(const CollisionScene& scene, const BodyPoses& poses) {
  std::shared_ptr<const CollisionScene> shared(&scene, [](const CollisionScene*) {});
  CollisionDetector detector(shared);
  CheckSettings settings;
  settings.alarm_distance = 0.0;
  std::set<std::string> names;
  for (const PairReport& pair : detector.detect(poses, settings).pairs) {
    names.insert(scene.models()[pair.first].name + "|" + scene.models()[pair.second].name);
  }
  return names;
}

BodyPoses placed(const CollisionScene& scene, const std::map<std::string, Isometry3d>& X_WL) {
  BodyPoses poses;
  poses.resize(scene.bodies().size());
  for (std::size_t i = 0; i < scene.bodies().size(); ++i) {
    poses.X_WB[i] = X_WL.at(scene.bodies()[i].link);
  }
  return poses;
}

TEST(SceneObjects, StandWhereTheyAreOrMoveWithTheirLink) {
  SceneDescription description = twoSliders();
  description.objects = {cube("pillar", at(5, 0, 0)), cube("load", at(0, 0, 1.5), "a"),
                         cube("shelf", at(5, 0, 1.5))};
  const auto scene = CollisionScene::build(description);
  EXPECT_EQ(scene->nbStaticElements(), 2u);
  EXPECT_EQ(contacts(*scene, placed(*scene, {{"a", at(0, 0, 0)}, {"b", at(9, 0, 0)}})),
            std::set<std::string>{});
  EXPECT_EQ(contacts(*scene, placed(*scene, {{"a", at(4.5, 0, 0)}, {"b", at(9, 0, 0)}})),
            (std::set<std::string>{"a|pillar", "load|shelf"}));
}

TEST(SceneObjects, AFloorMeetsWhatReachesBelowItAndNothingElse) {
  SceneDescription description = twoSliders();
  description.objects = {floorAt(-0.25, {"b"})};
  const auto scene = CollisionScene::build(description);
  EXPECT_EQ(contacts(*scene, placed(*scene, {{"a", at(0, 0, 0)}, {"b", at(3, 0, 0)}})),
            std::set<std::string>{"a|floor"});
  EXPECT_EQ(contacts(*scene, placed(*scene, {{"a", at(0, 0, 0.3)}, {"b", at(3, 0, 0)}})),
            std::set<std::string>{});
}

TEST(SceneObjects, ALevelFloorIsNoCandidateOfWhatIsAboveIt) {
  SceneDescription description = twoSliders();
  description.objects = {floorAt(-2.0, {})};
  CollisionDetector detector(CollisionScene::build(description));
  BodyPoses poses;
  poses.resize(2);
  poses.X_WB[1] = at(3, 0, 0);
  EXPECT_TRUE(detector.detect(poses, CheckSettings()).candidates.empty());
}

TEST(SceneObjects, TheMinimumIsThatOfTheNearestBesideAFloorAndWhatIsFarAway) {
  SceneDescription description = twoSliders();
  description.objects = {cube("pillar", at(0, 9, 0)), cube("moon", at(0, 0, 4e8))};
  CheckSettings settings;
  settings.min_distance = true;
  BodyPoses poses;
  poses.resize(2);
  poses.X_WB[1] = at(30, 0, 0);
  const auto minimum = [&] {
    CollisionDetector detector(CollisionScene::build(description));
    return detector.detect(poses, settings).min_distance;
  };
  EXPECT_NEAR(minimum(), 8.0, 1e-12);
  description.objects.push_back(floorAt(-4.0, {}));
  EXPECT_NEAR(minimum(), 3.5, 1e-12);
  description.objects.back() = floorAt(-1e12, {});
  EXPECT_NEAR(minimum(), 8.0, 1e-12);
}

TEST(SceneObjects, WhatIsWrongWithOneIsNamed) {
  SceneDescription description = twoSliders();
  description.objects = {cube("a", at(0, 0, 0))};
  EXPECT_THAT(refusalOf(description), HasSubstr("object 'a' has the name of a link"));
  description.objects = {cube("load", at(0, 0, 0), "bb")};
  EXPECT_THAT(refusalOf(description), HasSubstr("is attached to 'bb', which is not a link"));
  EXPECT_THAT(refusalOf(description), HasSubstr("did you mean 'b'?"));
  description.objects = {cube("load", at(0, 0, 0))};
  description.objects[0].touch_links = {"aa"};
  EXPECT_THAT(refusalOf(description), HasSubstr("did you mean 'a'?"));
  description.objects[0].touch_links.clear();
  description.objects[0].padding = -0.1;
  EXPECT_THAT(refusalOf(description), HasSubstr("padding of object 'load'"));
  description.objects[0].padding = 0.0;
  description.objects[0].elements.clear();
  EXPECT_THAT(refusalOf(description), HasSubstr("object 'load' has no shape"));
}

TEST(SceneObjects, ManyThatMayTouchEachOtherAreStillTreatedAlike) {
  SceneDescription description = twoSliders();
  constexpr int COUNT = 200;
  for (int i = 0; i < COUNT; ++i) {
    description.objects.push_back(cube("brick" + std::to_string(i), at(i, 5, 0)));
    if (i > 0) description.objects[i].touch_links = {"brick" + std::to_string(i - 1)};
  }
  description.objects[7].touch_links.push_back("a");
  const auto scene = CollisionScene::build(description);
  EXPECT_EQ(scene->filter().nbClasses(), 4u);  // a, b, bricks, and the one that a may touch
}

// Everything that is asked for each pair of links is asked 2e8 times here.
TEST(Scene, AChainOf20000FixedLinksIsOneBodyAndIsChecked) {
  constexpr int COUNT = 20000;
  std::string xml = boxLink("link0", 0.1);
  for (int i = 1; i < COUNT; ++i) {
    const std::string name = "link" + std::to_string(i), before = "link" + std::to_string(i - 1);
    xml += boxLink(name, 0.1) + joint("to_" + name, "fixed", before, name, "0.09 0 0", "");
  }
  SceneDescription description;
  description.robots.push_back({robotFrom(xml), std::nullopt, ""});
  description.objects = {cube("far", at(-100, 0, 0))};
  const auto scene = CollisionScene::build(description);
  EXPECT_EQ(scene->models().size(), COUNT + 1u);
  EXPECT_EQ(scene->bodies().size(), 1u);
  const auto allowed = [&](const std::string& a, const std::string& b) {
    return scene->filter().allowed(scene->findModel(a), scene->findModel(b));
  };
  EXPECT_FALSE(allowed("link7000", "link7001"));
  EXPECT_TRUE(allowed("link7000", "link7002"));
  EXPECT_TRUE(allowed("link19999", "far"));
  BodyPoses poses;
  poses.resize(1);
  poses.X_WB[0] = at(0, 0, 0);
  CollisionDetector detector(scene);
  EXPECT_EQ(detector.detect(poses, {}).verdict, Verdict::FREE);  // neighbours overlap, no others
}

TEST(SceneObjects, AlikeButForTheRestrictionAreToldApart) {
  SceneDescription description = twoSliders();
  description.objects = {cube("pillar", at(0, 0, 0)), cube("shelf", at(0, 0, 0))};
  description.restriction.names = {"pillar"};
  const auto scene = CollisionScene::build(description);
  EXPECT_EQ(contacts(*scene, placed(*scene, {{"a", at(0, 0, 0)}, {"b", at(0, 0, 0)}})),
            (std::set<std::string>{"a|pillar", "b|pillar"}));
}

TEST(SceneObjects, AreAttachedToTheirLinkAndNotToItsBody) {
  SceneDescription description;
  description.robots.push_back({robotFrom(boxLink("arm", 1) + emptyLink("tool") +
                                          joint("weld", "fixed", "arm", "tool", "3 0 0")),
                                std::nullopt, ""});
  description.objects = {cube("load", at(0, 0, 1.5), "tool"), cube("pillar", at(9, 0, 0))};
  const auto scene = CollisionScene::build(description);
  const auto& load = scene->models()[static_cast<std::size_t>(scene->findModel("load"))];
  EXPECT_EQ(scene->elements()[load.first_element].X_BE.translation(), Vector3d(3, 0, 1.5));
}

TEST(Scene, OfASingleRobotHasItWhereItIsPlaced) {
  SceneDescription description = twoSliders();
  description.robots[0].X_WR = at(1, 2, 3);
  const auto scene = CollisionScene::build(description);
  std::vector<Isometry3d> X_WB;
  scene->robot().forwardKinematics(scene->robot().zeroPositions(), X_WB);
  for (const Isometry3d& X : X_WB) EXPECT_EQ(X.translation(), Vector3d(1, 2, 3));
}

TEST(Scene, AfterAFailureItsCacheHoldsNoMeshThatIsHalfMade) {
  SceneDescription description = twoSliders();
  SceneCache cache;
  auto without_triangles = std::make_shared<TriangleMesh>();
  without_triangles->vertices = {Vector3d::Zero()};
  RigidObject broken = cube("broken", at(0, 0, 0));
  broken.elements[0].shape = Mesh{without_triangles};
  for (int i = 0; i < 20; ++i) {
    RigidObject sound = cube("sound" + std::to_string(i), at(0, 0, 0));
    sound.elements[0].shape = meshShape(boxMesh({0.1, 0.1, 0.1}));
    description.objects.push_back(sound);
  }
  description.objects.push_back(broken);
  EXPECT_THROW(CollisionScene::build(description, &cache), InputError);
  description.objects.pop_back();
  const auto scene = CollisionScene::build(description, &cache);
  for (const SceneElement& element : scene->elements()) {
    EXPECT_NE(element.rung(Fidelity::MESH).shape, nullptr);
  }
}

TEST(Scene, RobotAndEnvironmentMayHaveARootOfOneNameWithoutGeometry) {
  SceneDescription description = twoSliders();
  description.world =
      robotFrom(emptyLink("root") + boxLink("cell", 1) + joint("j", "fixed", "root", "cell"));
  EXPECT_GE(CollisionScene::build(description)->findModel("cell"), 0);
  description.world =
      robotFrom(boxLink("root", 1) + boxLink("cell", 1) + joint("j", "fixed", "root", "cell"));
  EXPECT_THAT(refusalOf(description), HasSubstr("link 'root' is in the robot and in the world"));
}

TEST(Scene, SettingsMayNameALinkOfTheEnvironmentWithoutGeometry) {
  SceneDescription description = twoSliders();
  description.world =
      robotFrom(emptyLink("hall") + boxLink("cell", 1) + joint("j", "fixed", "hall", "cell"));
  description.settings.link_padding["hall"] = 0.1;
  EXPECT_EQ(refusalOf(description), "accepted");
  description.settings.link_padding["hell"] = 0.1;
  EXPECT_THAT(refusalOf(description), HasSubstr("'hell'"));
}

TEST(Scene, AnElementOfALinkThatIsFixedOnABodyStandsWhereTheUrdfSays) {
  const auto robot =
      robotFrom(boxLink("base", 0.1) + emptyLink("arm") +
                linkWith("tool", "<sphere radius='0.1'/>", "<origin xyz='4 5 6' rpy='0 0 0.5'/>") +
                joint("turn", "continuous", "base", "arm") +
                "<joint name='weld' type='fixed'><origin xyz='1 2 3' rpy='0.4 -1.1 2.0'/>"
                "<parent link='arm'/><child link='tool'/></joint>");
  const auto scene = CollisionScene::build(robot, Srdf{}, nullptr);
  const auto& model = scene->models()[static_cast<std::size_t>(scene->findModel("tool"))];
  const Eigen::Matrix3d R =
      (Eigen::AngleAxisd(2.0, Vector3d::UnitZ()) * Eigen::AngleAxisd(-1.1, Vector3d::UnitY()) *
       Eigen::AngleAxisd(0.4, Vector3d::UnitX()))
          .toRotationMatrix();
  const Eigen::Matrix3d R_LE = Eigen::AngleAxisd(0.5, Vector3d::UnitZ()).toRotationMatrix();
  const Isometry3d& X_BE = scene->elements()[model.first_element].X_BE;
  EXPECT_LT((X_BE.translation() - (Vector3d(1, 2, 3) + R * Vector3d(4, 5, 6))).norm(), 1e-14);
  EXPECT_LT((X_BE.linear() - R * R_LE).norm(), 1e-14);
}

TEST(Scene, WithACacheIsTheSameAndPreparesOnlyWhatIsNew) {
  SceneDescription description;
  description.robots.push_back({mixedRobot(), std::nullopt, ""});
  std::atomic<int> prepared{0};
  description.settings.progress = [&](std::size_t, std::size_t) { ++prepared; };
  SceneCache cache;
  const auto first = CollisionScene::build(description, &cache);
  EXPECT_GT(prepared, 0);
  prepared = 0;
  description.objects = {cube("pillar", at(0.1, 0, 0))};
  const auto second = CollisionScene::build(description, &cache);
  EXPECT_EQ(prepared, 0);
  const auto anew = CollisionScene::build(description);
  RandomInputs random;
  BodyPoses poses;
  poses.resize(second->bodies().size());
  throwAbout(random, 0.5, poses);
  EXPECT_EQ(contacts(*second, poses), contacts(*anew, poses));
  EXPECT_FALSE(contacts(*second, poses).empty());
}

TEST(Scene, WithACacheKeepsItsSpheresWhateverElseChanges) {
  SceneDescription description;
  description.robots.push_back({mixedRobot(), std::nullopt, ""});
  SceneCache cache;
  const auto first = CollisionScene::build(description, &cache);
  const auto expectSameSpheres = [&] {
    const auto later = CollisionScene::build(description, &cache);
    ASSERT_EQ(later->elements().size(), first->elements().size());
    int nb_spheres = 0;
    for (std::size_t i = 0; i < first->elements().size(); ++i) {
      EXPECT_EQ(later->elements()[i].spheres, first->elements()[i].spheres);
      nb_spheres += later->elements()[i].spheres != nullptr;
    }
    EXPECT_EQ(nb_spheres, 5);  // meshes
  };
  description.settings.max_hull_vertices = 8;
  expectSameSpheres();
  description.settings.narrow_phase = NarrowPhaseMethod::FCL;
  expectSameSpheres();
  description.settings.link_fidelity = {{"d", Fidelity::CONVEX}};
  expectSameSpheres();
}

TEST(Scene, SaysWhichModelsItNeedsBeforeAnyGeometryIsThere) {
  SceneDescription description;
  description.robots.push_back(
      {mixedRobot(),
       Srdf::fromXml("<robot name='r'><disable_default_collisions link='a'/>"
                     "<disable_default_collisions link='b'/></robot>"),
       ""});
  std::set<std::string> needed = CollisionScene::neededModels(description);
  EXPECT_EQ(needed.count("a"), 0u);
  EXPECT_EQ(needed.count("c"), 1u);
  description.objects = {cube("pillar", at(0, 0, 0))};  // everything can meet that
  needed = CollisionScene::neededModels(description);
  EXPECT_EQ(needed.count("a"), 1u);
  EXPECT_EQ(needed.count("pillar"), 1u);
  EXPECT_EQ(needed.size(), CollisionScene::build(description)->models().size());
}

TEST(SeveralRobots, KeepTheirOwnSrdfAndMeetEachOther) {
  SceneDescription description;
  const auto robot = robotFrom(slidingBoxes(2));
  const Srdf nothing_with_b =
      Srdf::fromXml("<robot name='r'><disable_collisions link1='a' link2='b'/></robot>");
  description.robots.push_back({robot, nothing_with_b, "left", at(0, 0, 0)});
  description.robots.push_back({robot, Srdf{}, "right", at(0, 0.5, 0)});
  const auto scene = CollisionScene::build(description);
  std::vector<Isometry3d> X_WB;
  scene->robot().forwardKinematics(scene->robot().zeroPositions(), X_WB);
  BodyPoses poses;
  scene->gatherPoses(X_WB, poses);
  EXPECT_EQ(contacts(*scene, poses),
            (std::set<std::string>{"left/a|right/a", "left/a|right/b", "left/b|right/a",
                                   "left/b|right/b", "right/a|right/b"}));
  EXPECT_GE(scene->robot().findJoint("left/" + robot->joints().front().name), 0);
}

TEST(SeveralRobots, AreNotSwitchedOffByTheSrdfOfAnother) {
  SceneDescription description;
  const auto robot = robotFrom(slidingBoxes(2));
  const Srdf names_the_other = Srdf::fromXml(
      "<robot name='r'><disable_collisions link1='a' link2='right/a'/>"
      "<disable_collisions link1='right/a' link2='right/b'/></robot>");
  description.robots.push_back({robot, names_the_other, ""});
  description.robots.push_back({robot, Srdf{}, "right"});
  const auto scene = CollisionScene::build(description);
  const auto id = [&](const char* name) {
    return static_cast<std::uint32_t>(scene->findModel(name));
  };
  EXPECT_TRUE(scene->filter().allowed(id("a"), id("right/a")));
  EXPECT_TRUE(scene->filter().allowed(id("right/a"), id("right/b")));
}

TEST(SceneObjects, WithoutAFiniteBoxAreRefusedByName) {
  SceneDescription description = twoSliders();
  RigidObject vast;
  vast.name = "vast";
  for (const auto& [radius, x] : {std::pair(1.7e308, 0.0), std::pair(5e307, 1.7e308)}) {
    vast.elements = {{Sphere{radius}, Isometry3d::Identity()}};
    vast.X_PO.translation().x() = x;
    description.objects = {vast};
    EXPECT_THAT(refusalOf(description), HasSubstr("'vast' is too large or too far away")) << radius;
  }
  auto mesh = std::make_shared<TriangleMesh>();  // as one that is scaled by 1e300
  mesh->vertices = {{0, 0, 0}, {1e299, 0, 0}, {0, 1e299, 0}, {0, 0, 1e299}};
  mesh->triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  vast.elements = {{Mesh{mesh}, Isometry3d::Identity()}};
  vast.X_PO = Isometry3d::Identity();
  description.objects = {vast};
  EXPECT_THAT(refusalOf(description), HasSubstr("'vast' is too large or too far away"));
}

TEST(Scene, ARobotWithoutAModelIsRefused) {
  SceneDescription description;
  description.robots.push_back({robotFrom(slidingBoxes(2)), std::nullopt, ""});
  description.robots.push_back({nullptr, std::nullopt, "two"});
  EXPECT_EQ(refusal([&] { CollisionScene::build(description); }), "robots[1] has no model");
  EXPECT_EQ(refusal([&] { CollisionScene::neededModels(description); }), "robots[1] has no model");
  EXPECT_EQ(refusal([&] { CollisionScene::build(nullptr, std::nullopt, nullptr); }),
            "robots[0] has no model");
}

TEST(SeveralRobots, OfOneNameAreRefused) {
  SceneDescription description = twoSliders();
  description.robots.push_back(description.robots[0]);
  EXPECT_THAT(refusalOf(description), HasSubstr("give each a different prefix"));
}

}  // namespace collision_pairs::test_scene_description
