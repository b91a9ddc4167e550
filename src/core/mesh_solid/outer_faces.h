// Finds the triangles of a mesh that separate its inside from the outside.
#pragma once

#include "collision_pairs/shape.h"
#include "mesh_edges.h"

namespace collision_pairs {

enum class LooseEdges {
  ARE_GAPS,   ///< edges of a single triangle: the two sides of the triangle are connected there
  ARE_SEAMS,  ///< they are not connected: another triangle is near
};

/// For triangles connected by edges, each set of corners given once, in any orientation: finds
/// those that have the outside on exactly one side. One number per triangle: 1 if it faces the
/// outside, -1 if it has to be inverted for that, 0 for internal walls and external flaps. With
/// ARE_GAPS those that are not 0 form a closed surface, or there are none. Cost: O(n log n).
///
/// The two faces of each triangle are joined into regions of space, by adjacency around each edge.
/// Zhou, Grinspun, Zorin, Jacobson, "Mesh arrangements for solid geometry" (2016), section 4.
/// Deviation: intersecting triangles are not split.
std::vector<int> outerFaces(const TriangleMesh& mesh, const Surface& surface,
                            LooseEdges loose_edges);

/// Signed volume of the tetrahedron of a triangle and a point, cubic metres: positive if the
/// triangle faces away from the point.
double signedVolume(const TriangleMesh& mesh, const Triangle3& t, const Eigen::Vector3d& point);

}  // namespace collision_pairs
