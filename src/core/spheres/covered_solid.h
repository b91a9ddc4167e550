// A solid as its cover by spheres sees it.
#pragma once

#include <functional>
#include <vector>

#include "collision_pairs/aabb.h"
#include "prepared_shape.h"

namespace collision_pairs {

using Polygon = std::vector<Eigen::Vector3d>;

struct CoveredSolid {
  /// Each extreme point of what is in a box is on these, or is a corner of the box.
  std::vector<Polygon> surface;
  /// Is the point inside, or nearly so?
  std::function<bool(const Eigen::Vector3d&)> may_hold;
  /// A sphere of this radius around a point that is inside is so, too, and around any other point
  /// outside if it is `holds` that tells; else 0 or less where a point is not inside.
  std::function<double(const Eigen::Vector3d&)> depth;
  /// Is the point inside? Empty: where `depth` is positive.
  std::function<bool(const Eigen::Vector3d&)> holds;
  /// Whether it is the solid itself, and not something larger: has it inner spheres?
  bool is_exact = true;
};

/// All that is below the hull's planes.
CoveredSolid hullSolid(const ConvexHull& hull, double size);
/// The prism around a cylinder whose hull is given.
CoveredSolid cylinderSolid(const Cylinder& cylinder, const ConvexHull& prism, double size);
/// Of a mesh that is not convex; of one whose surface is not closed, its hull. Refers to `shape`.
CoveredSolid meshSolid(const Prepared& shape, double size);

std::vector<Eigen::Vector3d> cornersOf(const std::vector<Polygon>& polygons);
/// At least one point.
Aabb boxAround(const std::vector<Eigen::Vector3d>& points);

}  // namespace collision_pairs
