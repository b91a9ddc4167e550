#include "containment.h"

#include <algorithm>

#include "hull_bounds.h"

namespace collision_pairs {

using Eigen::Isometry3d;
using Eigen::Vector3d;

// The hull first: most points are outside of it, which it tells much sooner than solid angles do.
bool meshHoldsPoint(const Prepared& A, const Vector3d& p_AQ) {
  return !A.mesh->solid.empty() && !hullMisses(A, p_AQ) && A.mesh->solid.holds(p_AQ);
}

bool meshHoldsMesh(const Prepared& A, const Prepared& B, const Isometry3d& X_AB) {
  const auto& parts = B.mesh->part_points;
  return std::any_of(parts.begin(), parts.end(),
                     [&](const Vector3d& p_BQ) { return meshHoldsPoint(A, X_AB * p_BQ); });
}

bool meshHoldsConvex(const Prepared& A, const Prepared& B, const Isometry3d& X_AB) {
  return meshHoldsPoint(A, X_AB * B.core.center);
}

}  // namespace collision_pairs
