// Signed distance of two convex shapes: GJK where their cores are apart, EPA where they overlap.
#pragma once

#include "collision_pairs/pair_distance.h"
#include "simplex.h"

namespace collision_pairs {

/// Signed distance of A and B, measured and expressed in A's frame; see PairDistance.
/// Certainty: EXACT when the certified interval is closed to 1e-9 of the difference's size (curved
/// depths: 1e-6), BOUND when a depth's interval stayed wider, BEYOND as asked for, DEGRADED when
/// 64-bit mantissas (long double) did not close it either. Never throws, allocates nothing.
PairDistance convexDistance(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                            double max_distance);

/// The vertices of A - B with which GJK has enclosed the origin, if it has.
struct CoreOverlap {
  Simplex<double> simplex;
  double magnitude = 0.0;  ///< largest |w| that was seen, metres
  bool found() const { return simplex.size > 0; }
};

/// The same without depth: where the cores overlap the distance is 0 less the rounding radii, and
/// the witness points and normal say nothing. For yes or no, and for triangles of a surface.
/// `overlap`, if given, is set where cores that are not curved overlap.
PairDistance convexGap(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                       double max_distance, CoreOverlap* overlap = nullptr);

/// convexDistance() of two cores of which an overlap was found, without finding it again.
PairDistance convexDepth(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                         const CoreOverlap& overlap);

/// A lower bound of the distance from the balls around the two shapes.
double ballDistance(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB);

}  // namespace collision_pairs
