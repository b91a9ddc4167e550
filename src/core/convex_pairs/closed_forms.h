// Pairs of shapes whose signed distance has a closed form, accurate to a few units in the last
// place. Where that leaves open whether they touch, more digits decide. `band`: see
// convex_distance.h.
#pragma once

#include <optional>

#include "collision_pairs/pair_distance.h"
#include "convex_core.h"

namespace collision_pairs {

/// True if there is a closed form for the pair: point (sphere) against point, segment, box and
/// cylinder, and segment (capsule) against segment.
bool hasClosedForm(const ConvexCore& A, const ConvexCore& B);

/// Signed distance in closed form; only if hasClosedForm(). EXACT; a hair from contact it is
/// convexDistance(). Cost: 20 to 60 ns.
PairDistance closedForm(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                        double band = 0.0);

/// The half-space z <= 0 of frame A against a convex shape, by the lowest point of B. The depth is
/// measured along +z: no translation in another direction is shorter.
PairDistance halfSpaceDistance(const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                               double band = 0.0);

/// Half-spaces have a gap only if their planes are parallel and face each other; all others
/// overlap, and no translation separates them: the distance is minus infinity.
PairDistance halfSpacePair(const Eigen::Isometry3d& X_AB);

/// True if two boxes have a point in common, false if they are more than `band` apart, nothing
/// where rounding could decide. Separating axes (Gottschalk 1996): the faces' and the edges'
/// directions. Cost: about 50 ns.
std::optional<bool> boxesTouch(const Eigen::Vector3d& half_a, const Eigen::Vector3d& half_b,
                               const Eigen::Isometry3d& X_AB, double band);

/// The same answer with the roles of A and B exchanged: `result` is for (A, B) in A's frame, the
/// returned one for (B, A) in B's frame.
PairDistance exchanged(const PairDistance& result, const Eigen::Isometry3d& X_BA);

}  // namespace collision_pairs
