#include "moveit_octree.h"

#include <algorithm>
#include <array>

namespace collision_pairs {
namespace {

using Eigen::Array3d;
using Eigen::Array3i;

/// Cells of level 0, both inclusive.
struct CellRange {
  Array3i low, high;
};

class LeafReader {
 public:
  LeafReader(const octomap::OcTree& tree, std::vector<CellRange> ranges)
      : tree_(tree), ranges_(std::move(ranges)) {}

  std::vector<OctreeLeaf> read() {
    const octomap::OcTreeNode* root = tree_.getRoot();
    if (!root) return {};
    // The origin is at the centre of the root.
    const int level = static_cast<int>(tree_.getTreeDepth()) - 1;
    const VoxelCell first = VoxelCell::Constant(-1);
    if (!takeChildren(*root, level, first, ranges_.end()) && tree_.isNodeOccupied(*root)) {
      for (unsigned i = 0; i < 8; ++i) leaves_.push_back({level, first + offsetOf(i)});
    }
    return std::move(leaves_);
  }

 private:
  using Ranges = std::vector<CellRange>::iterator;

  static VoxelCell offsetOf(unsigned child) {
    return VoxelCell(static_cast<int>(child & 1), static_cast<int>(child >> 1 & 1),
                     static_cast<int>(child >> 2));
  }

  /// `end`: of the ranges that reach the node; `first`: the cell of its first child. False: a leaf.
  bool takeChildren(const octomap::OcTreeNode& node, int level, const VoxelCell& first,
                    Ranges end) {
    bool has_any = false;
    for (unsigned i = 0; i < 8; ++i) {
      if (!tree_.nodeChildExists(&node, i)) continue;
      has_any = true;
      take(*tree_.getNodeChild(&node, i), level, first + offsetOf(i), end);
    }
    return has_any;
  }

  void take(const octomap::OcTreeNode& node, int level, const VoxelCell& cell, Ranges end) {
    const Array3i low = cell.array() * (1 << level), high = low + (1 << level) - 1;
    end = std::partition(ranges_.begin(), end, [&](const CellRange& range) {
      return (low <= range.high).all() && (high >= range.low).all();
    });
    if (end == ranges_.begin()) return;
    const bool is_inner = level > 0 && takeChildren(node, level - 1, 2 * cell, end);
    if (!is_inner && tree_.isNodeOccupied(node)) leaves_.push_back({level, cell});
  }

  const octomap::OcTree& tree_;
  std::vector<CellRange> ranges_;
  std::vector<OctreeLeaf> leaves_;
};

}  // namespace

std::vector<OctreeLeaf> occupiedLeaves(const octomap::OcTree& tree) {
  const int all = 1 << NB_OCTREE_LEVELS;
  return LeafReader(tree, {{Array3i::Constant(-all), Array3i::Constant(all)}}).read();
}

std::vector<OctreeLeaf> leavesWithin(const octomap::OcTree& tree, const std::vector<Aabb>& boxes,
                                     double reach) {
  constexpr double SLACK = 1e-6;  // cells: far more than rounding
  constexpr double FURTHEST = 2 << NB_OCTREE_LEVELS;
  const double resolution = tree.getResolution();
  const auto toCells = [&](const Array3d& numbers) -> Array3i {
    return numbers.floor().max(-FURTHEST).min(FURTHEST).cast<int>();
  };
  std::vector<CellRange> ranges;
  for (const Aabb& box : boxes) {
    if (!box.valid()) continue;
    ranges.push_back({toCells((box.min.array() - reach) / resolution - SLACK),
                      toCells((box.max.array() + reach) / resolution + SLACK)});
  }
  return LeafReader(tree, std::move(ranges)).read();
}

void appendBoxes(double resolution, const std::vector<OctreeLeaf>& leaves,
                 const Eigen::Isometry3d& X_MO, std::vector<Element>& elements) {
  for (const OctreeLeaf& leaf : leaves) {
    const double edge = edgeOfLeaf(resolution, leaf.level);
    const Eigen::Vector3d center = edge * (leaf.cell.cast<double>().array() + 0.5);
    const Shape box = Box{Eigen::Vector3d::Constant(edge)};
    elements.push_back({box, X_MO * Eigen::Translation3d(center)});
  }
}

CloudVoxels voxelsOf(double resolution, const std::vector<OctreeLeaf>& leaves) {
  std::array<std::vector<VoxelCell>, NB_OCTREE_LEVELS> cells;
  for (const OctreeLeaf& leaf : leaves)
    cells[static_cast<std::size_t>(leaf.level)].push_back(leaf.cell);
  CloudVoxels voxels;
  for (int level = 0; level < NB_OCTREE_LEVELS; ++level) {
    voxels.push_back(std::make_shared<const OccupiedVoxels>(
        edgeOfLeaf(resolution, level), cells[static_cast<std::size_t>(level)]));
  }
  return voxels;
}

}  // namespace collision_pairs
