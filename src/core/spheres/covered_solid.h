// The solid that spheres have to enclose, as the construction of the spheres needs it.
#pragma once

#include <functional>
#include <vector>

#include "collision_pairs/aabb.h"
#include "prepared_shape.h"

namespace collision_pairs {

using Polygon = std::vector<Eigen::Vector3d>;

struct CoveredSolid {
  /// Within any box, each extreme point of the solid lies on these polygons or is a corner of the
  /// box.
  std::vector<Polygon> surface;
  /// True if the point is inside, up to rounding.
  std::function<bool(const Eigen::Vector3d&)> may_hold;
  /// Radius of a sphere around a point inside that is entirely inside. For a point outside: if
  /// `holds` is set, the radius of a sphere that is entirely outside, else 0 or less.
  std::function<double(const Eigen::Vector3d&)> depth;
  /// True if the point is inside. Empty: it is inside if `depth` is positive.
  std::function<bool(const Eigen::Vector3d&)> holds;
  /// False if it is larger than the actual solid; there are no inner spheres then.
  bool is_exact = true;
};

/// The points below all planes of the hull.
CoveredSolid hullSolid(const ConvexHull& hull, double size);
/// The prism that encloses a cylinder, given by its hull.
CoveredSolid cylinderSolid(const Cylinder& cylinder, const ConvexHull& prism, double size);
/// For a mesh that is not convex; its hull if its surface is not closed. Refers to `shape`.
CoveredSolid meshSolid(const Prepared& shape, double size);

std::vector<Eigen::Vector3d> cornersOf(const std::vector<Polygon>& polygons);
/// At least one point.
Aabb boxAround(const std::vector<Eigen::Vector3d>& points);

}  // namespace collision_pairs
