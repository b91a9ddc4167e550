// How far apart spheres in place of solids are.
#pragma once

#include <vector>

#include "collision_pairs/pair_distance.h"
#include "outer_spheres.h"
#include "prepared_shape.h"

namespace collision_pairs {

/// A solid in place of which spheres stand, or that is asked itself: one that has a formula for the
/// distance from a sphere.
struct SpheresOrShape {
  const std::vector<OuterSphere>* spheres;  ///< null: `shape` itself
  const Prepared* shape;                    ///< box, sphere, cylinder, capsule or half-space
};

/// A lower bound of the signed distance of what the spheres of A enclose from B; at least one has
/// spheres. Where no leaves are as near as `contact_distance` (metres, >= 0) it is at least four
/// fifths of the gap of the leaves among the first 127 spheres, or where these meet of those below,
/// and the points are of two of these; else it is that of the roots. What is further apart than
/// max_distance comes back as BEYOND. Of two spheres the one is divided first that was so when its
/// tree was made. So of two trees that begin alike, what the one with fewer spheres shows to be
/// apart so does the other. Cost: 5 ns for each pair of spheres that is looked at, 50 ns for a
/// sphere and a shape.
PairDistance sphereDistance(const SpheresOrShape& A, const SpheresOrShape& B,
                            const Eigen::Isometry3d& X_AB, double max_distance,
                            double contact_distance);

}  // namespace collision_pairs
