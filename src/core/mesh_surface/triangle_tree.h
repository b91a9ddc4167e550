// A tree of oriented boxes over the triangles of a mesh.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "box_gap.h"
#include "collision_pairs/shape.h"
#include "convex_core.h"

namespace collision_pairs {

/// Gottschalk, Lin, Manocha, "OBBTree" (1996): boxes along the principal axes of the triangles'
/// area, split at the mean of the centroids along the longest axis. One triangle per leaf.
/// Deviation: two levels of splits are merged into one, so that a node has up to four children,
/// whose gaps to another box are computed together.
///
/// Some nodes are the roots of patches: the largest ones of at most PATCH_TRIANGLES triangles. The
/// convex hull of a patch is close to its surface where the mesh is smooth, so it bounds a distance
/// much better than a box, and its distance is often the exact one.
class TriangleTree {
 public:
  static constexpr std::uint32_t PATCH_TRIANGLES = 32;
  static constexpr std::uint32_t NO_PATCH = 0xffffffff;

  struct Node {
    double size = 0.0;           // the largest half extent of its box
    std::uint32_t children = 0;  // the first of them; of a leaf: the triangle
    std::uint32_t patch = NO_PATCH;
    std::uint8_t nb_children = 0;  // 0: a leaf
    bool above_patches = false;
    bool isLeaf() const { return nb_children == 0; }
    bool isPatch() const { return patch != NO_PATCH; }
  };

  TriangleTree() = default;
  /// Cost: O(n log n); a few microseconds per triangle.
  explicit TriangleTree(const TriangleMesh& mesh);

  const Node& node(std::uint32_t i) const { return nodes_[i]; }
  /// Enlarged by a few units in the last place.
  OrientedBox box(std::uint32_t i) const {
    return boxInLane(blocks_[i / BOX_LANES], static_cast<int>(i % BOX_LANES));
  }
  /// The boxes of all children of an inner node.
  const BoxBlock& childBoxes(const Node& node) const { return blocks_[node.children / BOX_LANES]; }
  /// squaredBoxGap() of each child of a node of this tree and node `i` of another, moved by X.
  FourGaps squaredGaps(const Node& node, const TriangleTree& other, std::uint32_t i,
                       const Eigen::Isometry3d& X) const {
    return squaredBoxGaps(childBoxes(node), other.blocks_[i / BOX_LANES],
                          static_cast<int>(i % BOX_LANES), X);
  }
  bool empty() const { return nodes_.empty(); }

  /// The corners of a patch, as a convex shape that refers to them.
  ConvexCore patchCore(std::uint32_t patch) const;

  /// For each node above the patches and each patch, by its index: the extent of the triangles
  /// below it along the direction. Nodes below patches have larger indices. Cost: about 10 ns per
  /// patch.
  void reaches(const Eigen::Vector3d& direction, std::vector<double>& reach) const;

 private:
  struct Builder;
  struct Patch {
    std::uint32_t first_point, nb_points;
    std::uint32_t first_block, nb_blocks;
    Eigen::Vector3d center;
    double extent;
  };
  std::vector<Node> nodes_;       // the root is node 0; siblings begin at a multiple of BOX_LANES
  std::vector<BoxBlock> blocks_;  // the boxes of the nodes
  std::vector<Patch> patches_;
  std::vector<Eigen::Vector3d> patch_points_;
  std::vector<PointBlock> patch_blocks_;  // the same points
  std::size_t nb_upper_ = 0;              // nodes above the patches, and patches: they come first
};

}  // namespace collision_pairs
