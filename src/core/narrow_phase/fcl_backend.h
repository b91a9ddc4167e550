// Interface to FCL. fcl_backend.cpp is the only file of the package that includes it.
#pragma once

#include <memory>
#include <optional>

#include <Eigen/Geometry>

#include "collision_pairs/shape.h"
#include "convex_hull.h"
#include "fcl_answer.h"

namespace collision_pairs {

/// A shape of FCL: its primitive, fcl::Convex, or a tree of triangles. Immutable.
struct FclShape {
  virtual ~FclShape() = default;
};

/// `hull` is that of a Convex or a Mesh; a mesh that `is_convex` is nothing but its hull. Null
/// where FCL has no such solid (half-space) or refuses it. Cost: O(n log n).
std::unique_ptr<const FclShape> makeFclShape(const Shape& shape, const ConvexHull& hull,
                                             bool is_convex);

/// Of two shapes, B's pose given in A's frame: how far apart, as NarrowPhase::distance(), or
/// without `max_distance` only whether they touch. Of meshes only the surfaces count: one body
/// inside a mesh is APART. Only with a sphere or of two capsules there is a DEPTH. Never throws,
/// aborts or hangs: fcl_backend.cpp says which functions of FCL are called, and which never.
FclAnswer askFcl(const FclShape& A, const FclShape& B, const Eigen::Isometry3d& X_AB,
                 std::optional<double> max_distance) noexcept;

}  // namespace collision_pairs
