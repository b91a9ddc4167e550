#include <atomic>
#include <chrono>
#include <numeric>
#include <set>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "mixed_robot.h"
#include "refusal.h"

namespace collision_pairs::test_scene_settings {

std::shared_ptr<const CollisionScene> mixedScene(const SceneSettings& settings) {
  return CollisionScene::build(mixedRobot(), std::nullopt, nullptr, settings);
}

/// Is this rung prepared for the first element of the link?
bool has(const CollisionScene& scene, const std::string& link, Fidelity fidelity) {
  const CollisionModel& model = scene.models()[static_cast<std::size_t>(scene.findModel(link))];
  return scene.elements()[model.first_element].rung(fidelity).shape != nullptr;
}

TEST(SceneSettings, ALinksFidelityIsThatOfAllItsPairs) {
  SceneSettings settings;
  settings.link_fidelity = {{"d", Fidelity::OBB}, {"e", Fidelity::CONVEX}};
  const auto scene = mixedScene(settings);
  CollisionDetector detector(scene);
  BodyPoses poses;
  poses.resize(scene->bodies().size());  // all at one place: every pair touches
  CheckSettings check;
  for (const PairReport& pair : detector.detect(poses, check).pairs) {
    const std::string first = scene->models()[pair.first].name;
    const std::string second = scene->models()[pair.second].name;
    if (first == "d" || second == "d") {
      EXPECT_EQ(pair.fidelity, Fidelity::OBB) << first << "|" << second;
    } else if (first == "e" || second == "e") {
      EXPECT_EQ(pair.fidelity, Fidelity::CONVEX) << first << "|" << second;
    } else {
      EXPECT_EQ(pair.fidelity, Fidelity::MESH) << first << "|" << second;
    }
  }
  check.fidelity = Fidelity::AABB;
  for (const PairReport& pair : detector.detect(poses, check).pairs) {
    EXPECT_EQ(pair.fidelity, Fidelity::AABB);
  }
}

TEST(SceneSettings, ProgressCountsEachMeshOnceHoweverManyLinksHaveIt) {
  std::atomic<bool> is_telling{false};
  std::vector<std::size_t> steps, totals;
  SceneSettings settings;
  settings.progress = [&](std::size_t done, std::size_t total) {
    EXPECT_FALSE(is_telling.exchange(true)) << "two threads at a time";
    steps.push_back(done);
    totals.push_back(total);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    is_telling = false;
  };
  std::set<const TriangleMesh*> meshes;
  const auto scene = mixedScene(settings);
  for (const SceneElement& element : scene->elements()) {
    if (const auto* mesh = std::get_if<Mesh>(&element.shape)) meshes.insert(mesh->mesh.get());
  }
  std::vector<std::size_t> expected(meshes.size());
  std::iota(expected.begin(), expected.end(), std::size_t{1});
  EXPECT_EQ(steps, expected);
  EXPECT_EQ(totals, std::vector<std::size_t>(meshes.size(), meshes.size()));
}

TEST(SceneSettings, RungsThatNoPairAsksForAreNotPrepared) {
  SceneSettings settings;
  settings.link_fidelity = {{"d", Fidelity::OBB}, {"e", Fidelity::CONVEX}};
  const auto scene = mixedScene(settings);
  EXPECT_TRUE(has(*scene, "d", Fidelity::OBB));
  EXPECT_FALSE(has(*scene, "d", Fidelity::CONVEX));
  EXPECT_FALSE(has(*scene, "e", Fidelity::MESH));
  EXPECT_TRUE(has(*scene, "e", Fidelity::CONVEX));
  EXPECT_TRUE(has(*scene, "g", Fidelity::MESH));
  settings = {};
  settings.fidelity = Fidelity::CONVEX;
  EXPECT_FALSE(has(*mixedScene(settings), "g", Fidelity::MESH));
}

TEST(SceneSettings, ALinkHasTheFinestRungThatOneOfItsPairsAsksFor) {
  SceneSettings settings;
  settings.link_fidelity = {{"a", Fidelity::OBB}, {"z", Fidelity::OBB}};  // the first and the last
  const auto scene = mixedScene(settings);
  EXPECT_TRUE(has(*scene, "d", Fidelity::MESH));
  EXPECT_TRUE(has(*scene, "d", Fidelity::OBB));
  EXPECT_FALSE(has(*scene, "z", Fidelity::MESH));
}

TEST(SceneSettings, ALinkWhosePartnersAreAllCheapIsNotPreparedForMore) {
  const auto robot = RobotModel::fromUrdf(
      "<robot name='r'>" + emptyLink("root") + linkWith("a", "<mesh filename='l'/>") +
          linkWith("b", "<mesh filename='l'/>") +
          joint("ja", "floating", "root", "a", "0 0 0", "") +
          joint("jb", "floating", "root", "b", "0 0 0", "") + "</robot>",
      testMesh);
  SceneSettings settings;
  settings.link_fidelity = {{"a", Fidelity::AABB}};
  const auto scene = CollisionScene::build(robot, std::nullopt, nullptr, settings);
  EXPECT_FALSE(has(*scene, "b", Fidelity::MESH));
  EXPECT_FALSE(has(*scene, "b", Fidelity::OBB));
}

TEST(SceneSettings, AnUnknownLinkIsRefusedAndTheNearestOneNamed) {
  const auto robot =
      robotFrom(emptyLink("root") + boxLink("left_gripper", 1) + boxLink("elbow", 1) +
                joint("j1", "floating", "root", "left_gripper", "0 0 0", "") +
                joint("j2", "floating", "root", "elbow", "0 0 0", ""));
  SceneSettings settings;
  settings.link_fidelity = {{"left_griper", Fidelity::OBB}};
  EXPECT_THAT(
      refusal([&] { CollisionScene::build(robot, std::nullopt, nullptr, settings); }),
      testing::AllOf(testing::HasSubstr("'left_griper'"), testing::HasSubstr("'left_gripper'")));
}

TEST(SceneSettings, HullsHaveNoMoreVerticesThanAsked) {
  for (const int count : {4, 8, 16, 64, 1000}) {
    SceneSettings settings;
    settings.max_hull_vertices = count;
    const auto scene = mixedScene(settings);
    for (const SceneElement& element : scene->elements()) {
      const auto* hull = std::get_if<Convex>(&element.rung(Fidelity::CONVEX).shape->shape());
      if (hull) {
        EXPECT_LE(hull->mesh->vertices.size(), static_cast<std::size_t>(count));
      }
    }
  }
}

TEST(SceneSettings, HullsOfLessThanATetrahedronAreRefused) {
  SceneSettings settings;
  settings.max_hull_vertices = 3;
  EXPECT_THROW(mixedScene(settings), InputError);
  settings.max_hull_vertices = -1;
  EXPECT_THROW(mixedScene(settings), InputError);
}

}  // namespace collision_pairs::test_scene_settings
