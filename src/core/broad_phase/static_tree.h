// Static boxes packed into a tree of nodes of 16.
#pragma once

#include <vector>

#include "collision_pairs/aabb.h"
#include "packed_records.h"

namespace collision_pairs {

/// Boxes in the order of a k-d tree (median cuts across the axis on which the centres spread
/// most, at multiples of 16), 16 to a leaf, 16 leaves to a node and so on: S. Leutenegger,
/// M. Lopez, J. Edgington, "STR: a simple and efficient algorithm for R-tree packing" (1997), with
/// median cuts in place of its tiles. Records are relative to origin() and not enlarged; callers
/// enlarge the query box by the whole reach.
class StaticTree {
 public:
  /// `order`: all ids, in any order, which is then that of the leaves; empty: that of a k-d tree.
  StaticTree(std::vector<Aabb> boxes, std::vector<std::uint32_t> models,
             const std::vector<std::uint32_t>& order = {});

  /// The ids in the order of the leaves.
  const std::uint32_t* order() const { return view().level[0].tag; }
  const Aabb& box(std::uint32_t id) const { return boxes_[id]; }
  std::uint32_t model(std::uint32_t id) const { return models_[id]; }
  const Eigen::Vector3d& origin() const { return origin_; }
  TreeView view() const;

 private:
  std::vector<Aabb> boxes_;
  std::vector<std::uint32_t> models_;
  Eigen::Vector3d origin_;
  std::vector<PackedStorage> levels_;
};

}  // namespace collision_pairs
