// What prepareShape() makes of a shape.
#pragma once

#include <memory>
#include <mutex>

#include "collision_pairs/narrow_phase.h"
#include "convex_core.h"
#include "convex_hull.h"
#include "fcl_backend.h"
#include "prepared_mesh.h"

namespace collision_pairs {

/// Every shape but the half-space has a convex core: itself, or of a mesh its hull. A mesh that is
/// convex is nothing but its hull, and `mesh` is null.
struct Prepared : PreparedShape {
  explicit Prepared(const Shape& shape);
  bool isHalfSpace() const { return std::holds_alternative<HalfSpace>(shape()); }

  ConvexCore core;
  ConvexHull hull;  ///< what `core` points into, for Convex and Mesh
  OrientedBox box;  ///< around the shape, rounding included
  std::unique_ptr<const PreparedMesh> mesh;

  /// FCL's tree of the mesh, built when it is first asked for: most never are.
  const FclMesh& fclMesh() const;

 private:
  mutable std::once_flag fcl_is_built_;
  mutable FclMesh fcl_;
};

}  // namespace collision_pairs
