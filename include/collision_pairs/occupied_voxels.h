// The occupied voxels of a point cloud.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "collision_pairs/aabb.h"
#include "collision_pairs/sweep_and_prune.h"

namespace collision_pairs {

/// Index of a voxel: for voxels of size s, cell k is the closed cube from k s to (k + 1) s on each
/// axis, in W.
using VoxelCell = Eigen::Vector3i;

/// Cells have coordinates from -VOXEL_RANGE to VOXEL_RANGE - 1.
constexpr int VOXEL_RANGE = 1 << 20;

/// The occupied cells of one cloud, at one instant. Immutable, so all threads share it.
///
/// A tree of cubes: a cube of level 0 is 4 x 4 x 4 voxels, one of level 1 is 4 x 4 x 4 of these,
/// and so on. A bit per child marks the occupied ones, and only these are stored (after K. Museth,
/// "VDB: high-resolution sparse volumes with dynamic topology", 2013, with smaller cubes and
/// without pointers). The cost of a query depends only on the cubes near it. Memory: about 30 bytes
/// per cube; a surface has about one cube for ten voxels.
class OccupiedVoxels {
 public:
  /// 4 x 4 x 4 cells from `corner` on, whose coordinates are multiples of 4. Bit x + 4 y + 16 z of
  /// `occupied` is that of cell corner + (x, y, z).
  struct Block {
    VoxelCell corner;
    std::uint64_t occupied;
  };

  /// `voxel_size` in metres. Cells may be in any order and repeated. Throws InputError for a size
  /// that is not finite or not positive, and for a cell out of range.
  OccupiedVoxels(double voxel_size, const std::vector<VoxelCell>& cells);
  /// `truncated`: some occupied cells are missing.
  OccupiedVoxels(double voxel_size, const std::vector<Block>& blocks, bool truncated);

  double voxelSize() const { return voxel_size_; }
  std::size_t size() const { return nb_voxels_; }
  bool isEmpty() const { return nb_voxels_ == 0; }
  /// True if occupied cells are missing, so no link can be certified free of this cloud.
  bool isTruncated() const { return is_truncated_; }
  /// The box of all voxels, in W; inverted if there are none.
  const Aabb& bounds() const { return bounds_; }

  /// Calls take(cell) for each occupied cell, in an order that depends on the cells alone.
  template <class Take>
  void forEach(const Take& take) const {
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      for (std::uint64_t left = levels_[0][i].occupied; left != 0; left &= left - 1) {
        take(VoxelCell(corners_[i] + childOffset(__builtin_ctzll(left))));
      }
    }
  }

  /// Calls take(cell) for each occupied cell whose cube is, to rounding, no further than `reach`
  /// metres from the box (in W). Cost: the cubes near the box.
  template <class Take>
  void forEachWithin(const Aabb& box, double reach, const Take& take) const {
    const auto takeAll = [&](const VoxelCell& cell) {
      take(cell);
      return true;
    };
    if (!isEmpty()) descend(levels_.size() - 1, 0, root_corner_, queryFor(box, reach), takeAll);
  }
  /// True if there is such a cell. Cheaper.
  bool anyWithin(const Aabb& box, double reach) const {
    const auto takeNone = [](const VoxelCell&) { return false; };
    return !isEmpty() &&
           !descend(levels_.size() - 1, 0, root_corner_, queryFor(box, reach), takeNone);
  }

  // The tree, for searches over it.

  struct Cube {
    std::uint64_t occupied;     ///< bits of its children, as in Block
    std::uint32_t first_child;  ///< index in the level below; children are in the order of bits
  };
  /// From level 0 upwards; the last level has one cube. Empty if nothing is occupied.
  const std::vector<std::vector<Cube>>& levels() const { return levels_; }
  const VoxelCell& rootCorner() const { return root_corner_; }
  static VoxelCell childOffset(int bit) { return {bit & 3, (bit >> 2) & 3, bit >> 4}; }
  /// Index of the child with this bit in the level below.
  static std::uint32_t childOf(const Cube& cube, int bit) {
    const std::uint64_t before = cube.occupied & ((std::uint64_t{1} << bit) - 1);
    return cube.first_child + static_cast<std::uint32_t>(__builtin_popcountll(before));
  }
  /// Number of voxels along the edge of a child of a cube of this level.
  static int childEdge(std::size_t level) { return 1 << (2 * level); }

  /// From `low` to `high`, both inclusive.
  struct CellRange {
    Eigen::Array3i low, high;
  };
  /// Contains all cells no further than `reach` metres from the box, and few others.
  CellRange cellsWithin(const Aabb& box, double reach) const;
  /// Bits of the children of a cube that intersect the range.
  static std::uint64_t childrenIn(const CellRange& range, std::size_t level,
                                  const VoxelCell& corner) {
    const int shift = 2 * static_cast<int>(level);
    std::uint64_t bits = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const int low = std::max((range.low[axis] - corner[axis]) >> shift, 0);
      const int high = std::min((range.high[axis] - corner[axis]) >> shift, 3);
      if (low > high) return 0;
      bits *= BITS_ALONG[axis][(2u << high) - (1u << low)];  // the factors' bits do not interact
    }
    return bits;
  }

  /// The box of the occupied voxels of a cube.
  Aabb boxOfCube(std::size_t level, std::uint32_t index, const VoxelCell& corner) const {
    const CellRange cells = level == 0 ? cellsOf(levels_[0][index].occupied, corner)
                                       : occupied_ranges_[level - 1][index];
    return boxOf(cells.low, cells.high - cells.low + 1);
  }
  /// The box of nb_voxels voxels per axis, from `cell` on.
  Aabb boxOf(const VoxelCell& cell, const VoxelCell& nb_voxels) const {
    return {voxel_size_ * cell.cast<double>(), voxel_size_ * (cell + nb_voxels).cast<double>()};
  }

 private:
  struct Query {
    const Aabb& box;
    double squared_reach;
    CellRange cells;
  };
  Query queryFor(const Aabb& box, double reach) const {
    return {box, squaredReach(reach), cellsWithin(box, reach)};
  }

  static constexpr std::array<std::array<std::uint64_t, 16>, 3> bitsAlongAxes() {
    std::array<std::array<std::uint64_t, 16>, 3> bits{};
    for (unsigned axis = 0; axis < 3; ++axis) {
      for (unsigned chosen = 0; chosen < 16; ++chosen) {
        for (unsigned i = 0; i < 4; ++i) {
          const unsigned place = i << (2 * axis);
          if ((chosen >> i & 1u) != 0) bits[axis][chosen] |= std::uint64_t{1} << place;
        }
      }
    }
    return bits;
  }
  static const std::array<std::array<std::uint64_t, 16>, 3> BITS_ALONG;

  /// About the bits of a cube of level 0.
  static CellRange cellsOf(std::uint64_t occupied, const VoxelCell& corner) {
    constexpr std::uint64_t SLICES[3] = {0x1111111111111111, 0x000f000f000f000f, 0xffff};
    CellRange cells{corner, corner.array() + 3};
    for (int axis = 0; axis < 3; ++axis) {
      const int step = 1 << (2 * axis);  // between the bits of neighbours
      const auto isEmpty = [&](int at) {
        return (occupied & SLICES[axis] << ((at - corner[axis]) * step)) == 0;
      };
      while (isEmpty(cells.low[axis])) ++cells.low[axis];
      while (isEmpty(cells.high[axis])) --cells.high[axis];
    }
    return cells;
  }

  void build(const std::vector<Block>& blocks);
  /// `keys`: the places of the cubes of the first level.
  void addLevelsAbove(std::vector<std::uint64_t> keys);

  /// False where take(cell) was.
  template <class Take>
  bool descend(std::size_t level, std::uint32_t index, const VoxelCell& corner, const Query& query,
               const Take& take) const {
    const Cube& cube = levels_[level][index];
    std::uint64_t wanted = cube.occupied & childrenIn(query.cells, level, corner);
    for (; wanted != 0; wanted &= wanted - 1) {
      const int bit = __builtin_ctzll(wanted);
      const VoxelCell cell = corner + childEdge(level) * childOffset(bit);
      const bool goes_on =
          level > 0 ? descend(level - 1, childOf(cube, bit), cell, query, take)
                    : squaredGap(boxOf(cell, VoxelCell::Ones()), query.box) > query.squared_reach ||
                          take(cell);
      if (!goes_on) return false;
    }
    return true;
  }

  double voxel_size_;
  bool is_truncated_ = false;
  std::size_t nb_voxels_ = 0;
  Aabb bounds_ = noBox();
  VoxelCell root_corner_ = VoxelCell::Zero();
  std::vector<std::vector<Cube>> levels_;
  std::vector<VoxelCell> corners_;                       // of the cubes of level 0
  std::vector<std::vector<CellRange>> occupied_ranges_;  // of the cubes of level 1 and up
};

}  // namespace collision_pairs
