// Bounds of the distance of two pieces of surface by their convex hulls.
#pragma once

#include <limits>

#include "prepared_mesh.h"
#include "search_limit.h"

namespace collision_pairs {

/// The closest points of two surfaces, in the first one's frame.
struct SurfaceGap {
  double distance = std::numeric_limits<double>::infinity();  ///< 0 if they intersect
  /// Lower bound of the distance, unless `beyond`; less than `distance` only with a tolerance.
  double lower = 0.0;
  bool beyond = true;  ///< nothing within the limit; `distance` is a lower bound
  Eigen::Vector3d p_ACa = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_ACb = Eigen::Vector3d::Zero();
  bool by_hulls = false;  ///< found between hulls: there is a normal instead of two triangles
  Eigen::Vector3d nhat_AB_A = Eigen::Vector3d::Zero();
  std::uint32_t triangle_a = 0;
  std::uint32_t triangle_b = 0;
};

enum class PatchOutcome {
  SETTLED,     ///< too far apart, or the hulls' closest points are on both surfaces, or
               ///< as near to them as the tolerance allows
  NOT_ON_A,    ///< the closest point of A's hull is not on its surface
  NOT_ON_B,    ///< that of B's is not
  HULLS_TOUCH  ///< or nearly touch
};

/// A patch or a triangle as a convex shape; `corners` stores those of a triangle.
ConvexCore pieceCore(const PreparedMesh& mesh, const TriangleTree::Node& node, Corners& corners);

/// Compares the pieces of surface below nodes a and b, which are patches or triangles. Updates
/// `best`, `gap` and `limit` if nearer points of both surfaces are found. Tests the direction
/// nhat_AB_A (any unit vector) first, and replaces it by the normal of the hulls if that was not
/// enough. Cost: a GJK query of 0.2 to 0.5 us, and the same again for the closest points if the
/// hulls are near enough.
PatchOutcome comparePatches(const PreparedMesh& A, std::uint32_t a, const PreparedMesh& B,
                            std::uint32_t b, const Eigen::Isometry3d& X_AB,
                            const Eigen::Isometry3d& X_BA, Eigen::Vector3d& nhat_AB_A,
                            SearchLimit& limit, ClosestPoints& best, SurfaceGap& gap);

/// The same for a patch and a convex solid, which is always on its own surface.
PatchOutcome comparePatch(const PreparedMesh& A, std::uint32_t a, const ConvexCore& B,
                          const Eigen::Isometry3d& X_AB, Eigen::Vector3d& nhat_AB_A,
                          SearchLimit& limit, SurfaceGap& gap);

}  // namespace collision_pairs
