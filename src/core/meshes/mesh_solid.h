// The solid enclosed by a mesh, for meshes as found in robot descriptions: vertices not shared,
// triangles inverted, repeated, opposed or missing, several bodies in one file.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "collision_pairs/shape.h"

namespace collision_pairs {

/// The solid that a mesh bounds, after vertices of equal coordinates are made one and triangles
/// with two equal corners are dropped. Each part connected by edges is classified separately, by
/// the first of these rules that applies:
/// 1. At every edge as many sides run one way as the other, repeated triangles counted and opposed
///    ones cancelled: it is closed and oriented consistently, and taken as it is.
/// 2. It is nearly so: next to its triangles it winds a whole number of times, to 0.02 turns in the
///    mean. That is so if less than 3 to 6 % of its area is missing, by its shape. Taken as it is.
/// 3. Its triangles enclose something, to the same measure or exactly, whichever way they face:
///    their outer faces are taken; walls within and flaps without are left out. Goes before 2 where
///    it closes better: a few triangles were turned.
/// 4. Together with what touches it at vertices, or with all that is left of the mesh, it is nearly
///    closed as it stands: edges match in parts only, or vertices nearly meet.
/// Else it is an open sheet, which encloses nothing.
///
/// Closed surfaces that face inwards are turned. One that faces the other way than most of the
/// volume, and lies within it, bounds a cavity; anywhere else it bounds a body.
struct MeshSolid {
  /// Triangles of the closed surfaces: bodies face outwards, cavities inwards. Where bodies share a
  /// wall it may be there twice, or not at all. Indices into the mesh's vertices.
  std::vector<std::array<std::uint32_t, 3>> outward;
  /// A vertex of each part, to ask whether the part is inside another solid. A part is all
  /// triangles connected by vertices, closed or not.
  std::vector<Eigen::Vector3d> part_points;
  /// One part, every edge of `outward` shared by two triangles and none of them concave.
  bool locally_convex = false;
  double volume = 0.0;  ///< of the bodies, each separately, minus the cavities; cubic metres
};

/// Cost: O(n log n), and 64 solid angles for each edge that is open.
MeshSolid findSolid(const TriangleMesh& mesh);

}  // namespace collision_pairs
