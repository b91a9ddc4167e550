// How the distance of a pair changes with the joints.
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "collision_pairs/collision_report.h"
#include "collision_pairs/collision_scene.h"
#include "collision_pairs/joint_columns.h"
#include "collision_pairs/narrow_phase.h"

namespace collision_pairs {

/// d(distance)/dq: how the distance of a pair of a report changes with the joints. Holds scratch
/// memory only: one per thread.
///
/// With the witness points and the normal n of the pair's nearest elements a and b it is
/// n^T (J_b(p_b) - J_a(p_a)), J(p) being the Jacobian of a point that is fixed to the body: the
/// derivative of the signed distance wherever no other two points are as near (no other direction
/// as shallow, where the two overlap). Elsewhere, at parallel faces for instance, the distance has
/// a kink, and this is the derivative for the witness points in the report: where the two are apart
/// no direction makes the distance grow faster, or shrink more slowly, than this says.
///
/// Of a depth that is a bound (Certainty::BOUND) it is the derivative of that bound. There is none
/// without witness points (verdict_only), where the distance is a lower bound (UNRESOLVED,
/// DEGRADED), and where axis-aligned boxes decided, which are not fixed to the bodies.
///
/// Error: 1e-6 or better; of depths with a cylinder 1e-5. The normals that GJK leaves at the rim of
/// a cylinder are off by up to 3e-5, so witness points that are apart there are first sought again.
/// Cost: the joints between the two links, about 10 ns each; at a cylinder 1 µs more, with a mesh
/// some.
class DistanceGradient {
 public:
  /// Both must outlive it. q is the state whose numbers `joints` names.
  DistanceGradient(const CollisionScene& scene, const JointColumns& joints);

  /// Of one of `report.pairs`: joints.size() numbers, metres per radian (of a prismatic joint: per
  /// metre). A joint that mimics adds to its leader's number and has 0 itself. `X_WB`: the poses of
  /// all RobotModel::bodies() that the report was made at. False, and NaN in every place, where
  /// there is none.
  bool compute(const PairReport& pair, const CollisionReport& report,
               const std::vector<Eigen::Isometry3d>& X_WB, double* gradient);

 private:
  /// Adds how fast a point of a body moves along nhat_W by the joint above the body.
  void addSpeed(int body, const Eigen::Vector3d& p_W, const Eigen::Vector3d& nhat_W,
                const std::vector<Eigen::Isometry3d>& X_WB, double* gradient) const;
  /// The same pair of points, and the normal, to rounding.
  void refineAtCylinders(const PairReport& pair, const std::vector<Eigen::Isometry3d>& X_WB,
                         Contact& nearest);

  const CollisionScene& scene_;
  const JointColumns& joints_;
  NarrowPhase narrow_phase_;
};

}  // namespace collision_pairs
