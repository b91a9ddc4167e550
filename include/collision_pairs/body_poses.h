// Where the bodies of a scene stand, and what its clouds of points show.
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Geometry>

namespace collision_pairs {

class OccupiedVoxels;

/// One for each of CollisionScene::clouds(), of its voxel size. Null, or missing at the end: it is
/// not known what is there, and the cloud is left out and reported.
using CloudVoxels = std::vector<std::shared_ptr<const OccupiedVoxels>>;

/// Poses of CollisionScene::bodies() in the world frame W, all of one instant.
struct BodyPoses {
  std::vector<Eigen::Isometry3d> X_WB;
  /// Whether the pose is known. "No pose" is never identity: the body's models are left out and
  /// reported. A pose that is not finite counts as unknown.
  std::vector<char> known;
  CloudVoxels voxels;

  /// All known, at identity until they are written.
  void resize(std::size_t nb_bodies) {
    X_WB.resize(nb_bodies, Eigen::Isometry3d::Identity());
    known.assign(nb_bodies, 1);
  }
};

}  // namespace collision_pairs
