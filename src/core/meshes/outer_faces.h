// Finds the triangles of a mesh that separate its inside from the outside.
#pragma once

#include "collision_pairs/shape.h"
#include "mesh_edges.h"

namespace collision_pairs {

enum class LooseEdges {
  ARE_GAPS,   ///< one can pass around a triangle whose edge no other one shares
  ARE_SEAMS,  ///< or not: another triangle is near
};

/// For triangles connected by edges, each set of corners given once, in any orientation: finds
/// those with the outside on exactly one side. One number per triangle: 1 if it faces the outside,
/// -1 if it has to be turned for that, 0 for walls within and flaps without. With ARE_GAPS those
/// that are not 0 are a closed surface, or none. Cost: O(n log n).
///
/// The two faces of each triangle are joined into regions of space, by what stands next to each
/// other around an edge. Zhou, Grinspun, Zorin, Jacobson, "Mesh arrangements for solid geometry"
/// (2016), section 4. Deviation: triangles that pass through each other are not cut.
std::vector<int> outerFaces(const TriangleMesh& mesh, const Surface& surface,
                            LooseEdges loose_edges);

/// Volume between a triangle and a point, cubic metres: positive if it faces away from the point.
double signedVolume(const TriangleMesh& mesh, const Triangle3& t, const Eigen::Vector3d& point);

}  // namespace collision_pairs
