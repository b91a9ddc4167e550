// Tests whether the surfaces of two meshes intersect.
#pragma once

#include <vector>

#include "prepared_mesh.h"

namespace collision_pairs {

/// Splits pairs of overlapping boxes until two triangles intersect. Computes no distance. Holds
/// scratch memory only.
class SurfaceContact {
 public:
  /// True if they are no more than `band` metres apart. Cost: O(log n) if the boxes are disjoint or
  /// the first triangles tested intersect, up to O(n) for nested surfaces.
  bool surfacesMeet(const PreparedMesh& A, const PreparedMesh& B, const Eigen::Isometry3d& X_AB,
                    double band);

 private:
  struct NodePair {
    std::uint32_t a, b;
  };
  /// Pushes the children of the node that was split (A's if `of_a`), each paired with the other
  /// node.
  void push(const NodePair& parent, bool of_a, const TriangleTree::Node& split,
            const FourGaps& gaps, double limit);

  std::vector<NodePair> stack_;
  std::size_t size_ = 0;  // of the stack; the vector is longer
};

}  // namespace collision_pairs
