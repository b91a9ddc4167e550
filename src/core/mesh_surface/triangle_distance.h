// Distance between points, boxes and triangles, in one frame, metres. Triangles may have no area.
#pragma once

#include <array>
#include <limits>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace collision_pairs {

using Corners = std::array<Eigen::Vector3d, 3>;

/// A triangle with its unit normal (zero if it has no area), computed from its two shortest edges,
/// which is the most accurate, and perpendicular to the longest: the triangle lies in that plane to
/// rounding, however thin it is.
struct Triangle {
  Triangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);
  explicit Triangle(const Corners& corners) : Triangle(corners[0], corners[1], corners[2]) {}
  Corners v;
  Eigen::Vector3d normal;
};

/// The closest points found so far; improved by the functions below.
struct ClosestPoints {
  double squared;  ///< of the distance
  Eigen::Vector3d on_a = Eigen::Vector3d::Zero();
  Eigen::Vector3d on_b = Eigen::Vector3d::Zero();
};

/// The point of the triangle that is closest to p.
Eigen::Vector3d closestOnTriangle(const Triangle& triangle, const Eigen::Vector3d& p);

/// True if b is certainly on one side of the plane of a and further from it than `limit` (squared).
/// False is inconclusive. Cost: about 5 ns, since the normal is not normalized.
bool planeKeepsApart(const Corners& a, const Corners& b, double squared_limit);

/// True, with `best` replaced, if the triangles are closer to each other than best.squared, which
/// is 0 if they intersect. Errors are a few units in the last place of the largest coordinate
/// difference. Cost: about 0.2 us; some 30 ns if the plane of one proves that the other is too far.
bool improveByTriangles(const Triangle& a, const Triangle& b, ClosestPoints& best);

/// Bounds of the distance of a triangle and a solid.
struct DistanceBounds {
  double lower;  ///< proved by a plane, or by their boxes; 0 if they may meet
  double upper = std::numeric_limits<double>::infinity();  ///< of two of their points
  Eigen::Vector3d nhat = Eigen::Vector3d::Zero();  ///< from the solid to the triangle if they are
                                                   ///< apart and `upper` is finite
};

/// Of the triangle and the box around the origin with these half extents. Where they are apart, the
/// bounds differ by the rounding of the direction, which has few digits if the triangle is thin or
/// they nearly touch. If `lower` is more than `limit`, it may be any bound that is.
/// Cost: about 20 ns if the box of the triangle or its plane is that far away, else 0.1 us.
DistanceBounds distanceFromBox(const Corners& triangle, const Eigen::Vector3d& half, double limit);

}  // namespace collision_pairs
