// Which space a mesh encloses, for meshes as they are found in robot descriptions: vertices not
// shared, triangles inside out, doubled or missing, several bodies in one file.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "collision_pairs/shape.h"

namespace collision_pairs {

/// The parts of a mesh, after vertices of equal coordinates are made one and repeated and
/// collapsed triangles are dropped. A part is all triangles that hang together by vertices.
struct MeshSolid {
  /// Triangles of the parts that enclose space, turned to face outwards. A part encloses space if
  /// the holes in it (edges of one triangle only) are less than 1 % of its area: torn seams count
  /// as closed, an open sheet encloses nothing. Indices into the mesh's vertices.
  std::vector<std::array<std::uint32_t, 3>> outward;
  /// A vertex of each part, to ask whether the part is inside another solid.
  std::vector<Eigen::Vector3d> part_points;
  /// One part, without holes, every edge shared by two triangles and none of them concave.
  bool locally_convex = false;
  double volume = 0.0;  ///< of all parts that enclose space, cubic metres
};

/// Cost: O(n log n).
MeshSolid findSolid(const TriangleMesh& mesh);

}  // namespace collision_pairs
