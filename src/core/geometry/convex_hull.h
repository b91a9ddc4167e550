// The convex hull of a set of points, and the graph of its edges.
#pragma once

#include "convex_core.h"

namespace collision_pairs {

struct ConvexHull {
  ConvexPoints points;                    ///< the hull's vertices, same frame as the input
  std::vector<std::array<int, 3>> faces;  ///< its triangles, in any order and orientation
  double volume = 0.0;                    ///< cubic metres
};

/// By Qhull (Barber, Dobkin, Huhdanpaa, "The quickhull algorithm for convex hulls", 1996), facets
/// triangulated. Points without volume (coplanar, collinear, coincident, or so few or so flat that
/// Qhull refuses them) are returned as they are, without duplicates and edges. Throws only
/// std::bad_alloc. Cost: O(n log n).
ConvexHull convexHull(const std::vector<Eigen::Vector3d>& points);

}  // namespace collision_pairs
