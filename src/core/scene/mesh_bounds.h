// Enclosures of a mesh: the corners of its hull, fewer points, and its axis-aligned box.
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Geometry>

#include "collision_pairs/aabb.h"
#include "packed_points.h"

namespace collision_pairs {

/// The largest coordinate of all points, metres.
double reachOf(const std::vector<Eigen::Vector3d>& points);

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

/// Encloses the mesh in exact arithmetic; no face of the box is further out than 1e-4 of the
/// largest extent of the mesh.
struct MeshBounds {
  /// `corners` of the mesh's hull, which encloses the mesh when grown by `margin` (metres).
  MeshBounds(const std::vector<Eigen::Vector3d>& corners, double margin);

  /// Cost: less than 1 ns a point that is left.
  Aabb boxAt(const Eigen::Isometry3d& X_WE) const;

  Eigen::Vector3d center;  ///< what the points are relative to, in E
  PackedPoints points;
  double margin;
  double reach;  ///< no point is further from the centre along an axis, for the rounding
};

}  // namespace collision_pairs
