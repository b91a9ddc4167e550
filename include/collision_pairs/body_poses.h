// Input of a check: poses of the bodies of a scene, and occupied voxels of its point clouds.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace collision_pairs {

class OccupiedVoxels;

/// One entry for each of CollisionScene::clouds(), with the same voxel size. Null or missing
/// entries mean unknown: the cloud is left out and reported.
using CloudVoxels = std::vector<std::shared_ptr<const OccupiedVoxels>>;

/// Poses of CollisionScene::bodies() in the world frame W, all at the same instant.
struct BodyPoses {
  std::vector<Eigen::Isometry3d> X_WB;
  /// Whether the pose is known. If not, the body's models are left out and reported; an unknown
  /// pose is never treated as identity. A pose that is not finite counts as unknown, and so does
  /// one whose rotation is off by more than 1e-3 in scale; a smaller error is repaired. Whether it
  /// is mirrored, or sheared without a scale, is not looked at.
  std::vector<char> known;
  CloudVoxels voxels;
  /// Why poses or voxels may not be what they seem, one sentence each: no verdict on them is FREE,
  /// and they are among CollisionReport::unknown_because.
  std::vector<std::string> unknown_because = {};

  /// Marks all poses as known, and sets new ones to identity; the caller overwrites them.
  void resize(std::size_t nb_bodies) {
    X_WB.resize(nb_bodies, Eigen::Isometry3d::Identity());
    known.assign(nb_bodies, 1);
  }
};

}  // namespace collision_pairs
