// What prepareShape() makes of a shape.
#pragma once

#include <memory>
#include <mutex>

#include "collision_pairs/narrow_phase.h"
#include "convex_core.h"
#include "convex_hull.h"
#include "fcl_backend.h"
#include "triangle_tree.h"
#include "winding_number.h"

namespace collision_pairs {

/// A mesh that is not convex, ready for queries.
struct PreparedMesh {
  std::shared_ptr<const TriangleMesh> triangles;
  TriangleTree tree;
  WindingNumber solid;                       ///< the parts that enclose space
  std::vector<Eigen::Vector3d> part_points;  ///< a point of each part

  /// FCL's tree, built when it is first asked for: most never are.
  const FclMesh& fcl() const;

 private:
  mutable std::once_flag fcl_is_built_;
  mutable FclMesh fcl_;
};

/// Every shape but the half-space has a convex core: itself, or of a mesh its hull. A mesh that is
/// convex is nothing but its hull, and `mesh` is null.
struct Prepared : PreparedShape {
  explicit Prepared(const Shape& shape);
  bool isHalfSpace() const { return std::holds_alternative<HalfSpace>(shape()); }

  ConvexCore core;
  ConvexHull hull;  ///< what `core` points into, for Convex and Mesh
  OrientedBox box;  ///< around the shape, rounding included
  std::unique_ptr<const PreparedMesh> mesh;
};

}  // namespace collision_pairs
