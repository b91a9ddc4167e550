// The result of prepareShape().
#pragma once

#include <memory>

#include "collision_pairs/narrow_phase.h"
#include "convex_core.h"
#include "convex_hull.h"
#include "fcl_backend.h"
#include "prepared_mesh.h"

namespace collision_pairs {

/// Every shape except the half-space has a convex core: itself, or the hull of a mesh. A convex
/// mesh is represented by its hull, and `mesh` is null.
struct Prepared : PreparedShape {
  Prepared(const Shape& shape, NarrowPhaseMethod method);
  bool isHalfSpace() const { return std::holds_alternative<HalfSpace>(shape()); }

  ConvexCore core;
  ConvexHull hull;  ///< `core` points into it, for Convex and Mesh
  OrientedBox box;  ///< around the shape, rounding included
  std::unique_ptr<const PreparedMesh> mesh;
  NarrowPhaseMethod method;
  std::unique_ptr<const FclShape> fcl;  ///< null if FCL is not used, or has no such solid
};

}  // namespace collision_pairs
