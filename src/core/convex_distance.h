// Signed distance of two convex shapes: GJK where their cores are apart, EPA where they overlap.
#pragma once

#include "collision_pairs/narrow_phase.h"
#include "convex_core.h"

namespace collision_pairs {

/// Signed distance of A and B, measured and expressed in A's frame; see PairDistance.
/// Certainty: EXACT when the certified interval is closed to 1e-9 of the difference's size (curved
/// depths: 1e-6), BOUND when a depth's interval stayed wider, BEYOND as asked for, DEGRADED when
/// 64-bit mantissas (long double) did not close it either. Never throws, allocates nothing.
PairDistance convexDistance(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                            double max_distance);

/// The same without depth: where the cores overlap the distance is 0 less the rounding radii, and
/// the witness points and normal say nothing. For yes or no, and for triangles of a surface.
PairDistance convexGap(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                       double max_distance);

/// A lower bound of the distance from the balls around the two shapes.
double ballDistance(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB);

}  // namespace collision_pairs
