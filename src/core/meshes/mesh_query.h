// Distance and contact between meshes, and between a mesh and a convex shape: surfaces by their
// trees of oriented boxes, containment by winding numbers.
#pragma once

#include <vector>

#include "patch_hulls.h"
#include "slab_bounds.h"

namespace collision_pairs {

/// Traverses pairs of boxes, nearest first. Holds scratch memory only.
class MeshQuery {
 public:
  /// Distance of the surfaces of two meshes. The search is cut off at
  /// max_distance (metres). nhat_AB_A, if given, is the normal between the hulls: it makes the
  /// search shorter and does not change the answer. Cost: O(log n) far apart, up to O(n) for large
  /// parallel surfaces.
  SurfaceGap meshMesh(const PreparedMesh& A, const PreparedMesh& B, const Eigen::Isometry3d& X_AB,
                      double max_distance, const Eigen::Vector3d* nhat_AB_A = nullptr,
                      const Accuracy& accuracy = {});

  /// Distance of the surface of mesh A and the solid B. Stops at the first triangle that meets B.
  SurfaceGap meshConvex(const PreparedMesh& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                        double max_distance, const Accuracy& accuracy = {});

 private:
  struct Entry {
    std::uint32_t a, b;
    double squared_gap;
  };
  // Children of the node that was split, A's if `of_a`, each with the parent's other node; none
  // whose gap is above the limit.
  void pushNearestLast(const Entry& parent, bool of_a, const TriangleTree::Node& split,
                       const FourGaps& gaps, SearchLimit& limit);

  SlabBounds slabs_;
  std::vector<Entry> stack_;
};

}  // namespace collision_pairs
