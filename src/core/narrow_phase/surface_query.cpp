#include "surface_query.h"

#include <limits>

#include "solids.h"

namespace collision_pairs {

double SurfaceQuery::apart(const PreparedShape& A, const ConvexCore& B,
                           const Eigen::Isometry3d& X_AB, double max_distance, double band) {
  const Prepared& mesh = static_cast<const Prepared&>(A);
  const SurfaceGap gap = query_.meshConvex(*mesh.mesh, B, X_AB, max_distance, band);
  if (!gap.beyond) return gap.distance;
  return max_distance > 0.0 ? gap.distance : std::numeric_limits<double>::infinity();
}

bool SurfaceQuery::holds(const PreparedShape& A, const Eigen::Vector3d& p_AQ) {
  return meshHoldsPoint(static_cast<const Prepared&>(A), p_AQ);
}

}  // namespace collision_pairs
