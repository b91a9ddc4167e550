// Axis-aligned boxes: the tight box of a shape at a pose, and the gap between two boxes.
#pragma once

#include <limits>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "collision_pairs/shape.h"

namespace collision_pairs {

/// Closed box with min <= max on each axis, metres, in whatever frame its maker says.
struct Aabb {
  Eigen::Vector3d min;
  Eigen::Vector3d max;

  /// Finite and not inverted. What is not valid must never reach a sort: one NaN among the end
  /// points makes the comparison inconsistent and loses pairs between sound boxes.
  bool valid() const {
    return (min.array() <= max.array()).all() && min.allFinite() && max.allFinite();
  }
  Eigen::Vector3d center() const { return 0.5 * min + 0.5 * max; }
};

/// An inverted box: what encloses nothing.
inline Aabb noBox() {
  return {Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()),
          Eigen::Vector3d::Constant(-std::numeric_limits<double>::infinity())};
}

/// The smallest box about both.
inline Aabb enclosing(const Aabb& a, const Aabb& b) {
  return {a.min.cwiseMin(b.min), a.max.cwiseMax(b.max)};
}

/// Square of the Euclidean distance between two boxes over all three axes, 0 if they touch.
inline double squaredGap(const Aabb& a, const Aabb& b) {
  const Eigen::Vector3d apart = (b.min - a.max).cwiseMax(a.min - b.max).cwiseMax(0.0);
  return apart.squaredNorm();
}

/// The smallest axis-aligned box, in W, of the shape whose frame E stands at X_WE; grown outwards
/// by a few units in the last place, so that it encloses the shape in exact arithmetic too.
/// Exact for each shape (no bounding spheres): boxes by |R|h, round shapes by the extent of their
/// circles (r sqrt(1 - a_i^2) for an axis a), meshes by their vertices.
/// Cost: O(1), for Convex and Mesh O(vertices). The box of a half-space is unbounded, but for the
/// side of its plane where that lies exactly along an axis: a level floor has nothing above it.
Aabb computeAabb(const Shape& shape, const Eigen::Isometry3d& X_WE);

}  // namespace collision_pairs
