// The nearest points of two solids to rounding, from points that are near them.
#pragma once

#include <Eigen/Geometry>

#include "collision_pairs/narrow_phase.h"

namespace collision_pairs {

struct ClosestPair {
  Eigen::Vector3d p_ACa, p_ACb;  ///< on A and on B, in A's frame
};

/// Alternating projections: from p_ACb to the nearest point of A, from there to the nearest point
/// of B and so on, which converges to the two nearest points; with extrapolation, because
/// convergence is linear with at most two slow directions (Anderson acceleration, "Iterative
/// Procedures for Nonlinear Integral Equations", 1965, with a memory of two). For solids that are
/// disjoint and convex near these points. Usually four rounds, with two point queries each.
ClosestPair closestPairNear(const PreparedShape& A, const PreparedShape& B,
                            const Eigen::Isometry3d& X_AB, const Eigen::Vector3d& p_ACb,
                            NarrowPhase& narrow_phase);

}  // namespace collision_pairs
