// Signed distance of two convex shapes: GJK if their cores are disjoint, EPA if they overlap.
#pragma once

#include "collision_pairs/pair_distance.h"
#include "simplex.h"

namespace collision_pairs {

/// Signed distance of A and B, measured and expressed in A's frame; see PairDistance.
/// Certainty: EXACT if the certified interval is narrow enough: for a distance 1e-10 of the largest
/// coordinate or, with a cylinder, 1e-9 of the smaller body's size; for a depth 1e-6 of the same.
/// BOUND if the interval of a depth stayed wider, BEYOND if the distance exceeds the given limit,
/// DEGRADED if not even 64-bit mantissas (long double) made it narrow enough. Never throws,
/// allocates nothing.
PairDistance convexDistance(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                            double max_distance);

/// The vertices of A - B with which GJK enclosed the origin, if it did.
struct CoreOverlap {
  Simplex<double> simplex;
  double magnitude = 0.0;  ///< largest |w| encountered, metres
  bool found() const { return simplex.size > 0; }
};

/// The same without depth: if the shapes touch, the distance is some number <= 0, and witness
/// points and normal are undefined. `overlap`, if given, is set if cores that are not curved
/// overlap. If BEYOND, nhat_AB_A is the normal of the separating plane that GJK found.
PairDistance convexGap(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                       double max_distance, CoreOverlap* overlap = nullptr);

/// A certain lower bound of a distance that convexGap() returns as EXACT.
inline double lowerEndOfGap(const PairDistance& gap, const ConvexCore& A, const ConvexCore& B) {
  constexpr double ERROR = 1e-9;  // of the largest coordinate; more than any EXACT one has
  return gap.distance - ERROR * (gap.distance + 2.0 * (A.extent + A.radius + B.extent + B.radius));
}

/// Decides only whether A and B are at most `margin` metres (>= 0) apart: the returned distance is
/// some number <= `margin` if they are, else a larger one. Cost: some ten nanoseconds if they
/// penetrate deeply, else a few support evaluations.
PairDistance convexTouch(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                         double margin);

/// convexDistance() of two cores for which an overlap was already found.
PairDistance convexDepth(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                         const CoreOverlap& overlap);

/// A lower bound of the distance: the gap of the shapes along the unit vector n. Cost: one step of
/// GJK.
double gapAlong(const Eigen::Vector3d& n, const ConvexCore& A, const ConvexCore& B,
                const Eigen::Isometry3d& X_AB);

/// A lower bound of the distance from the spheres around the two shapes.
double boundingSphereDistance(const ConvexCore& A, const ConvexCore& B,
                              const Eigen::Isometry3d& X_AB);

}  // namespace collision_pairs
