// Spheres that together enclose a solid.
#pragma once

#include <vector>

#include "covered_solid.h"

namespace collision_pairs {

struct PlacedSphere {
  Eigen::Vector3d center;
  double radius;
};

/// Encloses all points, up to the rounding of a distance; its radius is within about 1 % of the
/// smallest. At least one point. By steps towards the furthest point (Badoiu, Clarkson: "Smaller
/// core-sets for spheres", 2003), within the core set of points that have been furthest so far.
PlacedSphere enclosingSphere(const std::vector<Eigen::Vector3d>& points);

/// A sphere of a binary tree. Its children are `first_child` and the next one; 0: it is a leaf.
struct OuterSphere : PlacedSphere {
  int first_child = 0;
};

/// The leaves of the tree enclose the solid; the first sphere is the root, the others come in the
/// order in which they were made. Each encloses the part of the solid that its descendants enclose,
/// but not the descendants themselves. `samples`: spheres inside the solid, or none.
/// The cells are those of a k-d tree: their boxes shrunk to what is in them and split in the middle
/// of the longest side. In a box, every extreme point of the solid is a corner of a clipped
/// triangle or of the box: a sphere around these encloses that part of the solid. Of such spheres
/// the one that sticks out of the solid least is chosen, which for round parts is a large one
/// centred inside. The leaf that sticks out most is divided next, so that a smaller tree is the
/// beginning of a larger one. Cost: for a mesh of n triangles O(n) clippings per level, and some
/// thousand queries for the nearest point of its surface.
std::vector<OuterSphere> outerSpheres(const CoveredSolid& solid,
                                      const std::vector<PlacedSphere>& samples,
                                      std::size_t most_spheres);

/// A tree over given leaves, at least one, that groups neighbours in their order.
std::vector<OuterSphere> treeOver(const std::vector<PlacedSphere>& leaves);

}  // namespace collision_pairs
