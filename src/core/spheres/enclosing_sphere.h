// A small sphere around points.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace collision_pairs {

struct PlacedSphere {
  Eigen::Vector3d center;
  double radius;
};

/// Encloses all points, up to the rounding of a distance; its radius is within about 1 % of the
/// smallest. At least one point. By steps towards the furthest point (Badoiu, Clarkson: "Smaller
/// core-sets for spheres", 2003), within the core set of points that have been furthest so far.
PlacedSphere enclosingSphere(const std::vector<Eigen::Vector3d>& points);

}  // namespace collision_pairs
