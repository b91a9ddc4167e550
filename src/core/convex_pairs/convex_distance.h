// Signed distance of two convex shapes: GJK where their cores are apart, EPA where they overlap.
#pragma once

#include "collision_pairs/pair_distance.h"
#include "simplex.h"

namespace collision_pairs {

/// Signed distance of A and B, measured and expressed in A's frame; see PairDistance.
/// Certainty: EXACT when the certified interval is closed: of a distance to 1e-10 of the largest
/// coordinate or, with a cylinder, 1e-9 of the smaller body's size; of a depth to 1e-6 of the same.
/// BOUND when a depth's interval stayed wider, BEYOND as asked for, DEGRADED when 64-bit mantissas
/// (long double) did not close it either. Never throws, allocates nothing.
PairDistance convexDistance(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                            double max_distance);

/// The vertices of A - B with which GJK has enclosed the origin, if it has.
struct CoreOverlap {
  Simplex<double> simplex;
  double magnitude = 0.0;  ///< largest |w| that was seen, metres
  bool found() const { return simplex.size > 0; }
};

/// The same without depth: where the shapes touch, the distance is some number that is not
/// positive, and the witness points and normal say nothing. `overlap`, if given, is set where cores
/// that are not curved overlap. Where BEYOND, GJK says by which plane: its normal is nhat_AB_A.
PairDistance convexGap(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                       double max_distance, CoreOverlap* overlap = nullptr);

/// What is certain of a gap that convexGap() calls EXACT: that the distance is no less than this.
inline double lowerEndOfGap(const PairDistance& gap, const ConvexCore& A, const ConvexCore& B) {
  constexpr double ERROR = 1e-9;  // of the largest coordinate: more than any EXACT one has
  return gap.distance - ERROR * (gap.distance + 2.0 * (A.extent + A.radius + B.extent + B.radius));
}

/// Only whether A and B are no further than `margin` metres apart (>= 0): then the distance is some
/// number that is not more, else more. Cost: some ten nanoseconds where they are deep in each
/// other, else a few support evaluations.
PairDistance convexTouch(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                         double margin);

/// convexDistance() of two cores of which an overlap was found, without finding it again.
PairDistance convexDepth(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                         const CoreOverlap& overlap);

/// A lower bound of the distance: that of two planes across the unit vector n that bound the
/// shapes. Cost: that of one step of GJK.
double gapAlong(const Eigen::Vector3d& n, const ConvexCore& A, const ConvexCore& B,
                const Eigen::Isometry3d& X_AB);

/// A lower bound of the distance from the spheres around the two shapes.
double boundingSphereDistance(const ConvexCore& A, const ConvexCore& B,
                              const Eigen::Isometry3d& X_AB);

}  // namespace collision_pairs
