// How far apart balls in place of solids are.
#pragma once

#include <vector>

#include "collision_pairs/pair_distance.h"
#include "outer_balls.h"
#include "prepared_shape.h"

namespace collision_pairs {

/// A solid in place of which balls stand, or that is asked itself: one that has a formula for the
/// distance from a ball.
struct BallOrShape {
  const std::vector<OuterBall>* balls;  ///< null: `shape` itself
  const Prepared* shape;                ///< box, sphere, cylinder, capsule or half-space
};

/// A lower bound of the signed distance of what the balls of A enclose from B; at least one has
/// balls. Where no leaves are as near as `contact_distance` (metres, >= 0) it is at least four
/// fifths of the gap of the leaves among the first 127 balls, or where these meet of those below,
/// and the points are of two of these; else it is that of the roots. What is further apart than
/// max_distance comes back as BEYOND. Of two balls the one is divided first that was so when its
/// tree was made. So of two trees that begin alike, what the one with fewer balls shows to be apart
/// so does the other. Cost: 5 ns for each pair of balls that is looked at, 50 ns for a ball and a
/// shape.
PairDistance ballDistance(const BallOrShape& A, const BallOrShape& B, const Eigen::Isometry3d& X_AB,
                          double max_distance, double contact_distance);

}  // namespace collision_pairs
