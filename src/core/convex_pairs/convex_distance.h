// Signed distance of two convex shapes: GJK if their cores are disjoint, EPA if they overlap.
#pragma once

#include "collision_pairs/pair_distance.h"
#include "simplex.h"

namespace collision_pairs {

/// Signed distance of A and B, measured and expressed in A's frame; see PairDistance. The truth is
/// that of the numbers given: the core of B is moved by X_AB as it stands, and what rounding leaves
/// of a rotation is part of the pose.
/// Certainty: EXACT if the certified interval proves that the distance or depth is off by no more
/// than largestError(). BOUND if the interval of a depth stayed wider, BEYOND if the distance
/// exceeds the given limit, DEGRADED if not even twice a double's digits made that of a distance
/// narrow enough. The distance is <= 0 if the two overlap, or the gap between them is no larger
/// than `band` metres: see contactBand(). All functions below decide alike; of a gap they know no
/// better than 4e-30 of the coordinates. Never throws, allocates nothing.
/// `between`, if given, is tried first: where the closest points of two hulls were before. It
/// changes no answer, and is replaced.
PairDistance convexDistance(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                            double max_distance, double band = 0.0,
                            ClosestVertices* between = nullptr);

/// The same without depth: if the shapes touch, the distance is some number <= 0, and witness
/// points and normal are undefined. `overlap`, if given, is set if cores that are not curved
/// overlap. If BEYOND, nhat_AB_A is the normal of the separating plane that GJK found.
PairDistance convexGap(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                       double max_distance, double band = 0.0, CoreOverlap* overlap = nullptr,
                       ClosestVertices* between = nullptr);

/// A certain lower bound of a distance that convexGap() returns as EXACT.
inline double lowerEndOfGap(const PairDistance& gap, const ConvexCore& A, const ConvexCore& B) {
  // No vector that goes into a vertex of A - B is longer than these together.
  const double reach = A.extent + A.center.lpNorm<1>() + B.extent + B.center.lpNorm<1>();
  return gap.distance - largestError(A, B, 4.0 * (gap.distance + reach + A.radius + B.radius));
}

/// Decides only whether A and B are at most `margin` metres (>= 0) apart, as convexDistance() does:
/// the returned distance is some number <= `margin` if they are, else a larger one. Cost: some ten
/// nanoseconds if they penetrate deeply, else a few support evaluations.
PairDistance convexTouch(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                         double margin, double band);

/// convexDistance() of two cores for which an overlap was already found; a BOUND where more digits
/// would make it EXACT. A self-filter, which asks for each cell of a new view, is twice as fast by
/// it (cloud_benchmark, ms_first_seen).
PairDistance convexDepth(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                         const CoreOverlap& overlap, double band);

/// A lower bound of the distance: the gap of the shapes along the unit vector n. Cost: one step of
/// GJK.
double gapAlong(const Eigen::Vector3d& n, const ConvexCore& A, const ConvexCore& B,
                const Eigen::Isometry3d& X_AB);

/// A lower bound of the distance, for searches: more than max_distance if the distance is, but for
/// rounding, else mostly within a tenth of it. <= 0 if the cores may overlap. Begins along n, a
/// unit vector, or 0 for the centres', and replaces it by the direction of the bound. Cost: one
/// step of GJK where n was good enough.
double roughGap(Eigen::Vector3d& n, const ConvexCore& A, const ConvexCore& B,
                const Eigen::Isometry3d& X_AB, double max_distance);

/// A lower bound of the distance from the spheres around the two shapes.
double boundingSphereDistance(const ConvexCore& A, const ConvexCore& B,
                              const Eigen::Isometry3d& X_AB);

}  // namespace collision_pairs
