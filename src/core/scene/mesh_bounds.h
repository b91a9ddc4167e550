// Enclosures of a mesh: the corners of its hull, fewer points, and its axis-aligned box; and the
// oriented box of any shape.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "collision_pairs/aabb.h"
#include "packed_points.h"

namespace collision_pairs {

/// The largest coordinate of all points, metres.
double reachOf(const std::vector<Eigen::Vector3d>& points);

/// The vertices that are corners of the convex hull (convexHull()), without triangles. Points that
/// Qhull drops because they are within its rounding of a face lie outside the hull of the rest by
/// at most hullMargin().
std::shared_ptr<const TriangleMesh> hullVertices(const TriangleMesh& mesh);

/// Metres by which the hull must be enlarged to enclose `mesh` in exact arithmetic.
double hullMargin(const TriangleMesh& mesh);

/// Points whose hull, enlarged by `margin` (metres; `tolerance` plus rounding), encloses `points`.
/// Far fewer than the corners of a hull with round edges: a point is added if it is further than
/// `tolerance` from the hull of those added before, the outermost points first. Cost: one GJK query
/// per point.
struct FewerPoints {
  std::vector<Eigen::Vector3d> points;
  double margin = 0.0;
};
FewerPoints fewerPoints(const std::vector<Eigen::Vector3d>& points, double tolerance);

/// The same with at most `max_points` (>= 1), with the smallest sufficient tolerance, to a few per
/// cent. If there are no more points than that, all of them without a margin. Cost: about 20 of
/// fewerPoints().
FewerPoints atMostPoints(const std::vector<Eigen::Vector3d>& points, std::size_t max_points);

/// Encloses the mesh in exact arithmetic; no face of the box is further out than 1e-4 of the
/// largest extent of the mesh.
struct MeshBounds {
  /// `corners` of the mesh's hull, which encloses the mesh if enlarged by `margin` (metres).
  MeshBounds(const std::vector<Eigen::Vector3d>& corners, double margin);

  /// Cost: less than 1 ns per remaining point.
  Aabb boxAt(const Eigen::Isometry3d& X_WE) const;

  Eigen::Vector3d center;  ///< origin of the points, in E
  PackedPoints points;
  double margin;
  double reach;  ///< largest distance of a point from the centre along an axis; bounds the rounding
};

/// A box that encloses the shape tightly, and its pose in the shape's frame E. For vertices: the
/// smallest of the boxes that have one axis along the frame or along a principal axis of the
/// vertices, each rotated about that axis to the smallest cross section (rotating calipers,
/// Toussaint 1983, by trying each edge of the planar hull). Enlarged by rounding.
std::pair<Box, Eigen::Isometry3d> enclosingBox(const Shape& shape);

}  // namespace collision_pairs
