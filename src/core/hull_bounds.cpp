#include "hull_bounds.h"

#include <limits>

#include "closest_on_mesh.h"
#include "convex_distance.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double ROUNDING = 64.0 * std::numeric_limits<double>::epsilon();

// By how much qhull's rounding may leave a vertex outside its hull, and a closest point beside the
// surface that it is on.
double roundingOf(const Prepared& A, const Prepared& B) {
  return ROUNDING * (A.core.extent + A.core.center.norm() + B.core.extent + B.core.center.norm());
}

}  // namespace

bool hullsMiss(const Prepared& A, const Prepared& B, const Isometry3d& X_AB) {
  const double rounding = roundingOf(A, B);
  const PairDistance gap = convexGap(A.core, B.core, X_AB, rounding);
  return gap.certainty != Certainty::DEGRADED && gap.distance > rounding;
}

HullBounds boundsFromHulls(const Prepared& A, const Prepared& B, const Isometry3d& X_AB,
                           double max_distance) {
  using Outcome = HullBounds::Outcome;
  const double rounding = roundingOf(A, B);
  HullBounds bounds;
  bounds.hulls = convexGap(A.core, B.core, X_AB, max_distance + rounding);
  if (bounds.hulls.certainty == Certainty::BEYOND) {
    bounds.outcome = Outcome::BEYOND;
    bounds.hulls.distance -= rounding;
    return bounds;
  }
  if (bounds.hulls.certainty != Certainty::EXACT || bounds.hulls.distance <= rounding)
    return bounds;
  const Vector3d& p_ACa = bounds.hulls.p_ACa;
  const Vector3d& p_ACb = bounds.hulls.p_ACb;
  const Vector3d on_a = A.mesh ? closestOnMesh(*A.mesh, p_ACa) : p_ACa;
  const Vector3d on_b =
      B.mesh ? X_AB * closestOnMesh(*B.mesh, X_AB.inverse(Eigen::Isometry) * p_ACb) : p_ACb;
  const double beside = (on_a - p_ACa).norm() + (on_b - p_ACb).norm();
  bounds.outcome = beside <= rounding ? Outcome::SETTLED : Outcome::APART;
  bounds.upper = (on_b - on_a).norm();
  return bounds;
}

}  // namespace collision_pairs
