// Interface to FCL. fcl_backend.cpp is the only file of the package that includes it.
#pragma once

#include <memory>
#include <optional>

#include <Eigen/Geometry>

#include "collision_pairs/shape.h"
#include "convex_hull.h"
#include "fcl_answer.h"

namespace collision_pairs {

/// An FCL geometry: primitive, fcl::Convex, or a tree of triangles. Immutable.
struct FclShape {
  virtual ~FclShape() = default;
};

/// `hull`: of a Convex or a Mesh; a mesh that `is_convex` is represented by its hull. Null if FCL
/// has no such solid (half-space) or refuses it. Cost: O(n log n).
std::unique_ptr<const FclShape> makeFclShape(const Shape& shape, const ConvexHull& hull,
                                             bool is_convex);

/// Distance of two shapes as NarrowPhase::distance(), or without `max_distance` only whether they
/// touch. Meshes are surfaces: a body inside a mesh is APART. A DEPTH is given only for two
/// capsules and for pairs with a sphere. Never throws, aborts or hangs: fcl_backend.cpp lists the
/// functions of FCL that are called, and those that never are.
FclAnswer askFcl(const FclShape& A, const FclShape& B, const Eigen::Isometry3d& X_AB,
                 std::optional<double> max_distance) noexcept;

}  // namespace collision_pairs
