// The convex hull of a set of points, and the graph of its edges.
#pragma once

#include "convex_core.h"

namespace collision_pairs {

struct ConvexHull {
  ConvexPoints points;                    ///< the hull's vertices, same frame as the input
  std::vector<std::array<int, 3>> faces;  ///< its triangles, in no order or orientation
  double volume = 0.0;                    ///< cubic metres
};

/// By Qhull (Barber, Dobkin, Huhdanpaa, "The quickhull algorithm for convex hulls", 1996), facets
/// triangulated. Points that have no volume (all in one plane, line or place, or so few or so flat
/// that Qhull refuses) come back as they are, without duplicates and edges. Never throws anything
/// but std::bad_alloc. Cost: O(n log n).
ConvexHull convexHull(const std::vector<Eigen::Vector3d>& points);

}  // namespace collision_pairs
