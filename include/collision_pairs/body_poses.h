// Where the bodies of a scene stand.
#pragma once

#include <vector>

#include <Eigen/Geometry>

namespace collision_pairs {

/// Poses of CollisionScene::bodies() in the world frame W, all of one instant.
struct BodyPoses {
  std::vector<Eigen::Isometry3d> X_WB;
  /// Whether the pose is known. "No pose" is never identity: the body's models are left out and
  /// reported. A pose that is not finite counts as unknown.
  std::vector<char> known;

  /// All known, at identity until they are written.
  void resize(std::size_t nb_bodies) {
    X_WB.resize(nb_bodies, Eigen::Isometry3d::Identity());
    known.assign(nb_bodies, 1);
  }
};

}  // namespace collision_pairs
