// Do the surfaces of two meshes meet?
#pragma once

#include <vector>

#include "prepared_mesh.h"

namespace collision_pairs {

/// Surfaces this close meet, metres: what is left is the rounding of the coordinates that their
/// distance is computed from.
double meetDistance(const OrientedBox& a, const OrientedBox& b, const Eigen::Isometry3d& X_AB);

/// Splits pairs of boxes that overlap until two triangles meet. Tells no distance. Holds the memory
/// for that walk only.
class SurfaceContact {
 public:
  /// Cost: O(log n) where the boxes miss each other or the first triangles tried meet, up to O(n)
  /// for surfaces that nest.
  bool surfacesMeet(const PreparedMesh& A, const PreparedMesh& B, const Eigen::Isometry3d& X_AB);

 private:
  struct NodePair {
    std::uint32_t a, b;
  };
  /// The children of the node that was split, A's if `of_a`, each with the other node.
  void push(const NodePair& parent, bool of_a, const TriangleTree::Node& split,
            const FourGaps& gaps, double limit);

  std::vector<NodePair> stack_;
  std::size_t size_ = 0;  // of the stack; the vector is longer
};

}  // namespace collision_pairs
