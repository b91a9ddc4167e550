// Leaves of an octree in a frame of its own: a cloud for each size, in a scene whose W is that
// frame.
#include <map>

#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "collision_pairs/occupied_voxels.h"
#include "mixed_robot.h"

namespace collision_pairs::test_octree_clouds {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using ByName = std::map<std::pair<std::string, std::string>, double>;

ByName distances(const CollisionScene& scene, const CollisionReport& report) {
  ByName found;
  for (const PairReport& pair : report.pairs) {
    found[{scene.models()[pair.first].name, scene.models()[pair.second].name}] = pair.distance;
  }
  return found;
}

TEST(OctreeClouds, OfTwoSizesInAnyPoseAreWhatTheirBoxesAreInTheWorld) {
  RandomInputs random;
  CheckSettings settings;
  settings.alarm_distance = 0.1;
  std::size_t nb_pairs = 0;
  for (int round = 0; round < 40; ++round) {
    SceneDescription in_world, in_tree;
    in_world.robots.push_back({mixedRobot(), std::nullopt, ""});
    in_world.check_self = false;
    in_tree = in_world;
    const Isometry3d X_WC = random.pose(2.0);
    BodyPoses poses;
    for (const double size : {0.05, 0.1}) {
      const std::string name = "leaves of " + std::to_string(size);
      RigidObject boxes;
      boxes.name = name;
      boxes.X_PO = X_WC;
      std::vector<VoxelCell> cells;
      for (int i = random.integer(1, 40); i > 0; --i) {
        cells.emplace_back(random.integer(-9, 8), random.integer(-9, 8), random.integer(-9, 8));
        Isometry3d X_CV = Isometry3d::Identity();
        X_CV.translation() = size * (cells.back().cast<double>() + Vector3d::Constant(0.5));
        boxes.elements.push_back({Box{Vector3d::Constant(size)}, X_CV});
      }
      in_world.objects.push_back(boxes);
      in_tree.clouds.push_back(cloudOf(name, size, {}));
    }
    const auto world = CollisionScene::build(in_world), tree = CollisionScene::build(in_tree);
    for (const SceneCloud& cloud : tree->clouds()) {  // in the order of their names
      std::vector<VoxelCell> cells;
      for (const RigidObject& object : in_world.objects) {
        if (object.name != tree->models()[cloud.model].name) continue;
        for (const Element& element : object.elements) {
          const Vector3d cell = element.X_LE.translation() / cloud.voxel_size;
          cells.push_back(cell.array().floor().cast<int>());
        }
      }
      poses.voxels.push_back(std::make_shared<const OccupiedVoxels>(cloud.voxel_size, cells));
    }
    poses.resize(tree->bodies().size());
    BodyPoses poses_W = poses;
    poses_W.voxels.clear();
    for (std::size_t i = 0; i < poses.X_WB.size(); ++i) {
      poses.X_WB[i] = random.pose(0.6);
      poses_W.X_WB[i] = X_WC * poses.X_WB[i];
    }
    CollisionDetector by_boxes(world), by_voxels(tree);
    const CollisionReport& expected = by_boxes.detect(poses_W, settings);
    const CollisionReport& found = by_voxels.detect(poses, settings);
    EXPECT_EQ(found.verdict, expected.verdict);
    const ByName pairs = distances(*tree, found);
    for (const auto& [names, distance] : distances(*world, expected)) {
      ASSERT_EQ(pairs.count(names), 1u) << names.first << " and " << names.second;
      EXPECT_NEAR(pairs.at(names), distance, 1e-9) << names.first << " and " << names.second;
      ++nb_pairs;
    }
  }
  EXPECT_GT(nb_pairs, 200u);
}

}  // namespace collision_pairs::test_octree_clouds
