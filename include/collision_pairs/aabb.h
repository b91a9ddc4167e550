// Axis-aligned boxes: the tight box of a shape at a pose, and the gap between two boxes.
#pragma once

#include <limits>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "collision_pairs/shape.h"

namespace collision_pairs {

/// Closed box with min <= max on each axis, metres, in a frame that the user of the box defines.
struct Aabb {
  Eigen::Vector3d min;
  Eigen::Vector3d max;

  /// Finite and not inverted. Invalid boxes must not be sorted: a single NaN among the end points
  /// makes the comparison inconsistent and loses pairs of valid boxes.
  bool valid() const {
    return (min.array() <= max.array()).all() && min.allFinite() && max.allFinite();
  }
  Eigen::Vector3d center() const { return 0.5 * min + 0.5 * max; }
};

/// The empty box, which is inverted.
inline Aabb noBox() {
  return {Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()),
          Eigen::Vector3d::Constant(-std::numeric_limits<double>::infinity())};
}

/// The smallest box that encloses both.
inline Aabb enclosing(const Aabb& a, const Aabb& b) {
  return {a.min.cwiseMin(b.min), a.max.cwiseMax(b.max)};
}

/// Squared Euclidean distance between two boxes, square metres; 0 if they touch or overlap.
inline double squaredGap(const Aabb& a, const Aabb& b) {
  const Eigen::Vector3d apart = (b.min - a.max).cwiseMax(a.min - b.max).cwiseMax(0.0);
  return apart.squaredNorm();
}

/// The smallest axis-aligned box, in W, of a shape with its frame E at X_WE, enlarged by a few
/// units in the last place of all of its coordinates, so that it encloses the shape in exact
/// arithmetic as well, and boxes of shapes that are in contact (docs/accuracy.md) meet. Tight for
/// every shape (no bounding spheres): |R|h for boxes, the extent of their circles for round shapes
/// (r sqrt(1 - a_i^2) for an axis a), the vertices for meshes. The box of a half-space is
/// unbounded, except at its plane if that is exactly perpendicular to an axis: nothing lies above a
/// level floor. Cost: O(1); Convex and Mesh: O(vertices).
Aabb computeAabb(const Shape& shape, const Eigen::Isometry3d& X_WE);

}  // namespace collision_pairs
