// Cheaper shapes that enclose an element: the rungs of the fidelity ladder.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "collision_pairs/shape.h"

namespace collision_pairs {

/// The vertices that are corners of the convex hull (convexHull()), without triangles. Points that
/// qhull takes for corners no longer, because they are within its rounding of a face, lie outside
/// the hull of the rest by at most hullMargin().
std::shared_ptr<const TriangleMesh> hullVertices(const TriangleMesh& mesh);

/// Metres by which the hull must be grown to enclose `mesh` in exact arithmetic.
double hullMargin(const TriangleMesh& mesh);

/// Points whose hull encloses `points` when it is grown by `margin` (metres; at least `tolerance`,
/// and no more than that and rounding). Far fewer than the corners of a hull with round edges:
/// every point that the hull of those before it misses by more than `tolerance` is taken, the
/// outermost ones first. Cost: one GJK query a point.
struct FewerPoints {
  std::vector<Eigen::Vector3d> points;
  double margin = 0.0;
};
FewerPoints fewerPoints(const std::vector<Eigen::Vector3d>& points, double tolerance);

/// The same with at most `max_points` (>= 1), by the least tolerance that is found to do, to a few
/// per cent. All of them, with no margin, where they are no more. Cost: about 20 of fewerPoints().
FewerPoints atMostPoints(const std::vector<Eigen::Vector3d>& points, std::size_t max_points);

/// A box that encloses the shape tightly, and its pose in the shape's frame E. For vertices: the
/// smallest of the boxes that have one axis along the frame or along a principal axis of the
/// vertices, each turned about that axis so that its cross section is least (rotating calipers,
/// Toussaint 1983, by trying each edge of the planar hull). Grown by its rounding.
std::pair<Box, Eigen::Isometry3d> enclosingBox(const Shape& shape);

}  // namespace collision_pairs
