// Distance of solids represented by spheres.
#pragma once

#include <vector>

#include "collision_pairs/pair_distance.h"
#include "outer_spheres.h"
#include "prepared_shape.h"

namespace collision_pairs {

/// A solid represented by spheres, or used itself because its distance from a sphere has a closed
/// form.
struct SpheresOrShape {
  const std::vector<OuterSphere>* spheres;  ///< null: `shape` itself
  const Prepared* shape;                    ///< box, sphere, cylinder, capsule or half-space
};

/// A lower bound of the signed distance of what the spheres of A enclose from B; at least one has
/// spheres. If no leaves are within `contact_distance` (metres, >= 0) of each other, it is at least
/// four fifths of the gap between the leaves among the first 127 spheres (if these overlap, between
/// the leaves below them), and the witness points are on two of these spheres. Otherwise it is the
/// distance of the roots. Distances above max_distance are returned as BEYOND. Of two spheres, the
/// one that was divided first when its tree was built is descended first. So if one tree is the
/// beginning of another, what it shows to be apart the other shows as well. Cost: 5 ns per pair of
/// spheres compared, 50 ns per sphere and shape.
PairDistance sphereDistance(const SpheresOrShape& A, const SpheresOrShape& B,
                            const Eigen::Isometry3d& X_AB, double max_distance,
                            double contact_distance);

}  // namespace collision_pairs
