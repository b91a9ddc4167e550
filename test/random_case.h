// Random scenes with all that a check can meet, clouds included.
#pragma once

#include <memory>
#include <vector>

#include "collision_pairs/body_poses.h"
#include "collision_pairs/occupied_voxels.h"
#include "every_shape.h"
#include "random_robot.h"

namespace collision_pairs {

/// A random scene, now and then with a cloud.
struct RandomCase {
  SceneDescription description;
  CloudVoxels voxels;

  explicit RandomCase(RandomInputs& random) : description(randomScene(random)) {
    description.restriction = {};
    if (random.integer(0, 3) > 0) return;
    std::vector<VoxelCell> cells;
    for (int i = 0; i < 40; ++i) {
      cells.emplace_back(random.integer(-6, 6), random.integer(-6, 6), random.integer(-6, 6));
    }
    description.clouds.push_back(cloudOf("cloud", 0.1, {}));
    voxels = {std::make_shared<const OccupiedVoxels>(0.1, cells)};
  }
};

/// A static object of several elements.
inline RigidObject heap(RandomInputs& random) {
  RigidObject object;
  object.name = "heap";
  for (int i = random.integer(2, 4); i > 0; --i) {
    const int kind = random.integer(0, static_cast<int>(EVERY_KIND.size()) - 1);
    object.elements.push_back(
        {shapeOfKind(random, EVERY_KIND[static_cast<std::size_t>(kind)], 0.2), random.pose(0.4)});
  }
  object.X_PO = random.pose(2.0);
  return object;
}

/// The scene at random joint positions, with the case's voxels.
inline BodyPoses randomPosesOf(RandomInputs& random, const RandomCase& its,
                               const CollisionScene& scene) {
  std::vector<Eigen::Isometry3d> X_RB;
  scene.robot().forwardKinematics(randomPositions(random, scene.robot()), X_RB);
  BodyPoses poses;
  scene.gatherPoses(X_RB, poses);
  if (!scene.clouds().empty()) poses.voxels = its.voxels;
  return poses;
}

}  // namespace collision_pairs
