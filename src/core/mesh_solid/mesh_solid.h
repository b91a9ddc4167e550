// The solid enclosed by a mesh, for meshes as found in robot descriptions: vertices not shared,
// triangles inverted, repeated, opposed or missing, several bodies in one file.
//
// This folder knows which solid triangles enclose:
// - mesh_edges: which triangles share which edges, and which parts do these connect?
// - outer_faces: which triangles separate inside from outside?
// - mesh_solid: what solid does the mesh enclose, if its triangles are missing, repeated, inverted?
// - winding_number, by solid_angle: is a point inside that solid?
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "collision_pairs/shape.h"

namespace collision_pairs {

/// The solid that a mesh bounds, after vertices with equal coordinates are merged and triangles
/// with two equal corners are dropped. Each part connected by edges is classified separately, by
/// the first of these rules that applies:
/// 1. At every edge as many sides run one way as the other, repeated triangles counted and opposed
///    ones cancelled: it is closed and consistently oriented, and is used as it is.
/// 2. It is nearly closed: the winding number next to its triangles is an integer, to 0.02 in the
///    mean. This holds if less than 3 to 6 % of its area is missing, depending on its shape. Used
///    as it is.
/// 3. Its triangles enclose a volume, exactly or to the same tolerance, whichever way they face:
///    their outer faces are used; internal walls and external flaps are left out. Precedes 2 if it
///    closes better: a few triangles were inverted.
/// 4. Together with what touches it at vertices, or with all that is left of the mesh, it is nearly
///    closed: edges match only in part, or vertices nearly coincide.
/// Otherwise it is an open sheet, which encloses nothing.
///
/// Closed surfaces that face inwards are inverted. One that faces the other way than most of the
/// volume, and lies within it, bounds a cavity; anywhere else it bounds a body.
struct MeshSolid {
  /// Triangles of the closed surfaces: bodies face outwards, cavities inwards. A wall shared by two
  /// bodies may be included twice, or not at all. Indices into the mesh's vertices.
  std::vector<std::array<std::uint32_t, 3>> outward;
  /// A vertex of each part, to test whether the part is inside another solid. A part is all
  /// triangles connected by vertices, closed or not.
  std::vector<Eigen::Vector3d> part_points;
  /// True for a single part in which every edge of `outward` is shared by two triangles and none is
  /// concave.
  bool locally_convex = false;
  double volume = 0.0;  ///< of the bodies, each separately, minus the cavities; cubic metres
  /// Of its open sheets outside the bodies: the area that flat caps over their open edges would
  /// have, divided by that of the caps and the whole mesh together. 0: it has no open sheet; a
  /// single flat sheet: 0.5.
  double missing_share = 0.0;
};

/// Cost: O(n log n), and 64 solid angles per open edge.
MeshSolid findSolid(const TriangleMesh& mesh);

}  // namespace collision_pairs
