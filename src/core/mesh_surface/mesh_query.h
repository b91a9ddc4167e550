// Distance and contact between meshes, and between a mesh and a convex shape: surfaces by their
// trees of oriented boxes, containment by winding numbers.
//
// This folder knows surfaces of triangles; mesh_solid knows what they enclose. Prepared once:
// - triangle_tree: the boxes by which searches skip triangles; prepared_mesh holds it.
// For each query:
// - mesh_query: how far apart are two meshes, or a mesh and a convex shape, and do they touch?
// - surface_contact: do two surfaces intersect?
// - search_limit.h, slab_bounds.h, patch_hulls: which parts of two surfaces are too far apart?
// - triangle_distance: how far apart are two triangles, or a point and one?
#pragma once

#include <vector>

#include "patch_hulls.h"
#include "slab_bounds.h"

namespace collision_pairs {

/// Traverses pairs of boxes, nearest first. Holds scratch memory only.
class MeshQuery {
 public:
  /// Distance of the surfaces of two meshes, 0 if it is no larger than `band` (metres). The search
  /// is limited to max_distance (metres). nhat_AB_A, if given, is the normal between the hulls: it
  /// shortens the search and does not change the result. Cost: O(log n) if far apart, up to O(n)
  /// for large parallel surfaces.
  SurfaceGap meshMesh(const PreparedMesh& A, const PreparedMesh& B, const Eigen::Isometry3d& X_AB,
                      double max_distance, double band, const Eigen::Vector3d* nhat_AB_A = nullptr,
                      const Accuracy& accuracy = {});

  /// Distance of the surface of mesh A and the solid B, likewise. Stops at the first triangle that
  /// intersects B.
  SurfaceGap meshConvex(const PreparedMesh& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                        double max_distance, double band, const Accuracy& accuracy = {});

 private:
  struct Entry {
    std::uint32_t a, b;
    double squared_gap;
  };
  // Pushes the children of the node that was split (A's if `of_a`), each paired with the other
  // node, except those whose gap exceeds the limit.
  void pushNearestLast(const Entry& parent, bool of_a, const TriangleTree::Node& split,
                       const FourGaps& gaps, SearchLimit& limit);

  SlabBounds slabs_;
  std::vector<Entry> stack_;
};

}  // namespace collision_pairs
