#include "surface_query.h"

#include "solids.h"

namespace collision_pairs {

double SurfaceQuery::roughGap(const PreparedShape& A, const ConvexCore& B,
                              const Eigen::Isometry3d& X_AB, double max_distance,
                              std::vector<Eigen::Vector3d>& normals) {
  const Prepared& mesh = static_cast<const Prepared&>(A);
  return query_.roughGap(*mesh.mesh, B, X_AB, max_distance, normals);
}

bool SurfaceQuery::holds(const PreparedShape& A, const Eigen::Vector3d& p_AQ) {
  return meshHoldsPoint(static_cast<const Prepared&>(A), p_AQ);
}

}  // namespace collision_pairs
