// Pairs of shapes without triangles: half-spaces, primitives and convex hulls.
#pragma once

#include "collision_pairs/pair_distance.h"
#include "prepared_shape.h"

namespace collision_pairs {

/// Signed distance of two convex shapes, by their cores.
PairDistance convexPair(const Prepared& A, const Prepared& B, const Eigen::Isometry3d& X_AB,
                        double max_distance, double band, ClosestVertices* between = nullptr);

/// Signed distance if one of the two is a half-space, or both.
PairDistance halfSpaceWith(const Prepared& A, const Prepared& B, const Eigen::Isometry3d& X_AB,
                           double band);

/// True if two convex shapes are no further apart than `margin`, as convexPair() says. `result`
/// tells whether it is DEGRADED.
bool convexTouch(const Prepared& A, const Prepared& B, const Eigen::Isometry3d& X_AB, double margin,
                 double band, PairDistance& result);

}  // namespace collision_pairs
