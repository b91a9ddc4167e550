// The two queries that a result for a mesh consists of, separately.
#pragma once

#include <Eigen/Geometry>

#include "collision_pairs/narrow_phase.h"
#include "convex_core.h"
#include "mesh_query.h"

namespace collision_pairs {

/// For callers that query one mesh at many neighbouring places. Holds scratch memory only.
class SurfaceQuery {
 public:
  /// MeshQuery::roughGap() of the triangles of A, a mesh that is not convex, and the solid B, which
  /// may lie inside A.
  double roughGap(const PreparedShape& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                  double max_distance, std::vector<Eigen::Vector3d>& normals);

  /// True if A encloses the point.
  static bool holds(const PreparedShape& A, const Eigen::Vector3d& p_AQ);

 private:
  MeshQuery query_;
};

}  // namespace collision_pairs
