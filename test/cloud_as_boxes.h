// A scene with a cloud of points, and the same with the boxes of its voxels as a static object.
#pragma once

#include <map>
#include <set>

#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "collision_pairs/occupied_voxels.h"
#include "mixed_robot.h"

namespace collision_pairs {

using CloudPairs = std::map<std::pair<std::string, std::string>, PairReport>;

/// Patches of walls, blocks and single cells about the origin.
inline std::vector<VoxelCell> randomCells(RandomInputs& random, int reach) {
  std::vector<VoxelCell> cells;
  for (int patch = random.integer(1, 12); patch > 0; --patch) {
    const auto one = [&] { return random.integer(-reach, reach); };
    const VoxelCell corner(one(), one(), one());
    VoxelCell size(random.integer(1, 8), random.integer(1, 8), random.integer(1, 8));
    if (patch % 3 != 0) size[patch % 3] = 1;
    for (int x = 0; x < size[0]; ++x) {
      for (int y = 0; y < size[1]; ++y) {
        for (int z = 0; z < size[2]; ++z) cells.push_back(corner + VoxelCell(x, y, z));
      }
    }
  }
  return cells;
}

/// The oracle: the same boxes as one object. No cell twice.
inline RigidObject asObject(const std::vector<VoxelCell>& cells, double size) {
  RigidObject object;
  object.name = "cloud";
  std::set<std::array<int, 3>> known;
  for (const VoxelCell& cell : cells) {
    if (!known.insert({cell[0], cell[1], cell[2]}).second) continue;
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    X.translation() = size * (cell.cast<double>() + Eigen::Vector3d::Constant(0.5));
    object.elements.push_back({Box{Eigen::Vector3d::Constant(size)}, X});
  }
  return object;
}

class CloudCheck : public testing::Test {
 protected:
  CloudCheck() { description_.robots.push_back({robot_, std::nullopt, ""}); }

  void setVoxels(double size, const std::vector<VoxelCell>& cells) {
    SceneDescription with_object = description_;
    with_object.objects.push_back(asObject(cells, size));
    with_object.objects.back().touch_links = touch_links_;
    object_ = std::make_unique<CollisionDetector>(CollisionScene::build(with_object));
    SceneDescription with_cloud = description_;
    with_cloud.clouds.push_back(cloudOf("cloud", size, touch_links_));
    cloud_ = std::make_unique<CollisionDetector>(CollisionScene::build(with_cloud));
    voxels_ = std::make_shared<const OccupiedVoxels>(size, cells);
    poses_.resize(cloud_->scene().bodies().size());
  }

  const CollisionReport& checkCloud(const CheckSettings& settings) {
    BodyPoses poses = poses_;
    poses.voxels = {voxels_};
    return cloud_->detect(poses, settings);
  }

  static CloudPairs byName(const CollisionDetector& detector) {
    CloudPairs pairs;
    const auto& models = detector.scene().models();
    for (const PairReport& pair : detector.report().pairs) {
      pairs[{models[pair.first].name, models[pair.second].name}] = pair;
    }
    return pairs;
  }

  void expectSame(const CheckSettings& settings) {
    const CollisionReport& wanted = object_->detect(poses_, settings);
    const CollisionReport& found = checkCloud(settings);
    EXPECT_EQ(found.verdict, wanted.verdict);
    if (settings.verdict_only) return;
    EXPECT_NEAR(found.min_distance, wanted.min_distance, 1e-9);
    EXPECT_EQ(found.min_distance_is_bound, wanted.min_distance_is_bound);
    EXPECT_EQ(found.nb_boxes, wanted.nb_boxes);
    const CloudPairs wanted_pairs = byName(*object_), found_pairs = byName(*cloud_);
    ASSERT_EQ(found_pairs.size(), wanted_pairs.size());
    for (const auto& [names, pair] : wanted_pairs) {
      SCOPED_TRACE(names.first + " and " + names.second);
      const auto same = found_pairs.find(names);
      ASSERT_TRUE(same != found_pairs.end());
      EXPECT_EQ(same->second.state, pair.state);
      EXPECT_NEAR(same->second.distance, pair.distance, 1e-9);
    }
    expectContactsAreOfVoxels(found);
  }

  void expectContactsAreOfVoxels(const CollisionReport& report) const {
    const CollisionScene& scene = cloud_->scene();
    const std::uint32_t element = scene.clouds()[0].element;
    for (const PairReport& pair : report.pairs) {
      const Contact* contact = report.nearestContact(pair);
      const bool is_first = contact->elements.first == element;
      if (!is_first && contact->elements.second != element) continue;
      bool is_occupied = false;
      voxels_->forEach([&](const VoxelCell& cell) { is_occupied |= cell == contact->voxel; });
      EXPECT_TRUE(is_occupied);
    }
  }

  void expectSameAtRandom(const CheckSettings& settings, int rounds) {
    for (int round = 0; round < rounds; ++round) {
      SCOPED_TRACE("round " + std::to_string(round));
      const double size = random_.uniform(0.01, 0.1);
      setVoxels(size, randomCells(random_, static_cast<int>(0.6 / size)));
      throwAbout(random_, 0.6, poses_);
      expectSame(settings);
      if (testing::Test::HasFailure()) return;
    }
  }

  RandomInputs random_;
  std::shared_ptr<const RobotModel> robot_ = mixedRobot();
  SceneDescription description_;
  std::vector<std::string> touch_links_;
  std::unique_ptr<CollisionDetector> object_, cloud_;
  std::shared_ptr<const OccupiedVoxels> voxels_;
  BodyPoses poses_;
};

}  // namespace collision_pairs
