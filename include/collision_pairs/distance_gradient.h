// Gradient of the distance of a pair with respect to the joints.
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "collision_pairs/collision_report.h"
#include "collision_pairs/collision_scene.h"
#include "collision_pairs/joint_columns.h"

namespace collision_pairs {

/// d(distance)/dq: the gradient of the distance of a reported pair with respect to the joints.
///
/// With the witness points and the normal n of the pair's nearest elements a and b it is
/// n^T (J_b(p_b) - J_a(p_a)), where J(p) is the Jacobian of a point fixed to the body: the
/// derivative of the signed distance wherever no other pair of points is equally near (in
/// penetration: no other direction equally shallow). Elsewhere, for example at parallel faces, the
/// distance has a kink, and this is the derivative for the reported witness points: if the two are
/// apart, in no direction does the distance grow faster, or shrink more slowly, than this says.
///
/// For a depth that is a bound (Certainty::BOUND) it is the derivative of that bound. There is none
/// without witness points (verdict_only), if the distance is a lower bound (UNRESOLVED, DEGRADED,
/// TOLERATED, spheres), or if axis-aligned boxes decided, since these are not fixed to the bodies.
///
/// Error: 1e-6 or better; for depths with a cylinder 1e-5; with FCL as narrow phase that of its
/// normals. Cost: about 10 ns for each joint between the two links.
class DistanceGradient {
 public:
  /// Both must outlive it. q is the state with the numbers that `joints` names.
  DistanceGradient(const CollisionScene& scene, const JointColumns& joints);

  /// For one of `report.pairs`. Writes joints.size() numbers, metres per radian (prismatic joints:
  /// per metre). The derivative of a mimic joint is added to its leader's, and its own entry is 0.
  /// `X_WB`: poses of all RobotModel::bodies() at which the report was made. Returns false, with
  /// NaN in all entries, if there is no gradient.
  bool compute(const PairReport& pair, const CollisionReport& report,
               const std::vector<Eigen::Isometry3d>& X_WB, double* gradient) const;

 private:
  /// Adds the speed of a point of a body along nhat_W due to the joint above the body.
  void addSpeed(int body, const Eigen::Vector3d& p_W, const Eigen::Vector3d& nhat_W,
                const std::vector<Eigen::Isometry3d>& X_WB, double* gradient) const;

  const CollisionScene& scene_;
  const JointColumns& joints_;
};

}  // namespace collision_pairs
