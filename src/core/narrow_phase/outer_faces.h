// Which triangles of a mesh part what they enclose from the outside?
#pragma once

#include "collision_pairs/shape.h"
#include "mesh_edges.h"

namespace collision_pairs {

enum class LooseEdges {
  ARE_GAPS,   ///< one can pass around a triangle whose edge no other one shares
  ARE_SEAMS,  ///< or not: another triangle is near
};

/// Of triangles that hang together by edges, each set of corners given once and facing anywhere:
/// those with the outside on one side, turned to face it. Walls within and flaps without are left
/// out. With ARE_GAPS the result is a closed surface, or empty. Cost: O(n log n).
///
/// The two faces of each triangle are joined into regions of space, by what stands next to each
/// other around an edge. Zhou, Grinspun, Zorin, Jacobson, "Mesh arrangements for solid geometry"
/// (2016), section 4. Deviation: triangles that pass through each other are not cut.
Surface outerFaces(const TriangleMesh& mesh, const Surface& surface, LooseEdges loose_edges);

/// Volume between a triangle and a point, cubic metres: positive if it faces away from the point.
double signedVolume(const TriangleMesh& mesh, const Triangle3& t, const Eigen::Vector3d& point);

}  // namespace collision_pairs
