#include "collision_pairs/occupied_voxels.h"

#include <cmath>
#include <limits>
#include <string>

#include "collision_pairs/input_error.h"

namespace collision_pairs {
namespace {

using Eigen::Array3d;
using Eigen::Array3i;
using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double ROUNDING = 16.0 * std::numeric_limits<double>::epsilon();

/// A block and its place in the tree: six bits per level, the uppermost first.
struct Place {
  std::uint64_t key;
  std::uint32_t block;
};

/// Spreads the bits of a byte: in pairs, with four bits between them.
constexpr std::array<std::uint32_t, 256> spreadBytes() {
  std::array<std::uint32_t, 256> spread{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    for (std::uint32_t pair = 0; pair < 4; ++pair) {
      spread[byte] |= (byte >> (2 * pair) & 3u) << (6 * pair);
    }
  }
  return spread;
}

std::uint64_t placeInTree(const Vector3i& blocks_from_root) {
  static constexpr auto SPREAD = spreadBytes();
  const auto along = [&](int axis) {
    const auto number = static_cast<std::uint32_t>(blocks_from_root[axis]);
    const std::uint64_t high = SPREAD[number >> 16 & 255], middle = SPREAD[number >> 8 & 255];
    return (high << 48 | middle << 24 | SPREAD[number & 255]) << (2 * axis);
  };
  return along(0) | along(1) | along(2);
}

/// Radix sort, least significant digit first.
void sortPlaces(std::vector<Place>& places) {
  constexpr int DIGIT = 11;
  std::uint64_t all_bits = 0;
  for (const Place& place : places) all_bits |= place.key;
  std::vector<Place> sorted(places.size());
  for (int shift = 0; shift < 64 && all_bits >> shift != 0; shift += DIGIT) {
    std::array<std::uint32_t, (1u << DIGIT) + 1> first{};
    const auto digitOf = [&](const Place& place) {
      return static_cast<std::size_t>(place.key >> shift & ((1u << DIGIT) - 1));
    };
    for (const Place& place : places) ++first[digitOf(place) + 1];
    for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
    for (const Place& place : places) sorted[first[digitOf(place)]++] = place;
    places.swap(sorted);
  }
}

bool isInRange(const VoxelCell& cell) {
  return (cell.array() >= -VOXEL_RANGE && cell.array() < VOXEL_RANGE).all();
}

}  // namespace

const std::array<std::array<std::uint64_t, 16>, 3> OccupiedVoxels::BITS_ALONG = bitsAlongAxes();

OccupiedVoxels::OccupiedVoxels(double voxel_size, const std::vector<VoxelCell>& cells)
    : voxel_size_(voxel_size) {
  std::vector<Block> blocks;
  for (const VoxelCell& cell : cells) {
    const VoxelCell within = cell.unaryExpr([](int k) { return k & 3; });
    const int bit = within[0] + 4 * within[1] + 16 * within[2];
    blocks.push_back({cell - within, std::uint64_t{1} << bit});
  }
  build(blocks);
}

OccupiedVoxels::OccupiedVoxels(double voxel_size, const std::vector<Block>& blocks, bool truncated)
    : voxel_size_(voxel_size), is_truncated_(truncated) {
  build(blocks);
}

void OccupiedVoxels::build(const std::vector<Block>& blocks) {
  if (!(voxel_size_ > 0.0) || !std::isfinite(voxel_size_ * VOXEL_RANGE)) {
    throw InputError("the voxel size is " + std::to_string(voxel_size_) +
                     ", but must be more than 0 metres, and finite");
  }
  VoxelCell low = VoxelCell::Constant(VOXEL_RANGE);
  for (const Block& block : blocks) {
    if (!isInRange(block.corner)) throw InputError("a voxel is more than 2^20 voxels from W");
    low = low.cwiseMin(block.corner);
  }
  std::vector<Place> places;
  places.reserve(blocks.size());
  for (std::uint32_t i = 0; i < blocks.size(); ++i) {
    if (blocks[i].occupied == 0) continue;
    places.push_back({placeInTree((blocks[i].corner - low) / 4), i});
  }
  if (places.empty()) return;
  root_corner_ = low;
  sortPlaces(places);
  std::vector<std::uint64_t> keys;
  levels_.emplace_back();
  std::vector<Cube>& cubes = levels_.back();
  keys.reserve(places.size());
  cubes.reserve(places.size());
  corners_.reserve(places.size());
  for (const auto& [key, id] : places) {
    if (keys.empty() || keys.back() != key) {
      keys.push_back(key);
      cubes.push_back({0, 0});
      corners_.push_back(blocks[id].corner);
    }
    cubes.back().occupied |= blocks[id].occupied;
  }
  for (std::uint32_t i = 0; i < cubes.size(); ++i) {
    nb_voxels_ += static_cast<std::size_t>(__builtin_popcountll(cubes[i].occupied));
    bounds_ = enclosing(bounds_, boxOfCube(0, i, corners_[i]));
  }
  addLevelsAbove(std::move(keys));
}

void OccupiedVoxels::addLevelsAbove(std::vector<std::uint64_t> keys) {
  while (levels_.back().size() > 1) {
    std::vector<Cube> above;
    std::vector<CellRange> ranges;
    std::size_t nb_above = 0;
    for (std::uint32_t i = 0; i < keys.size(); ++i) {
      const std::uint64_t key = keys[i] >> 6, bit = keys[i] & 63;
      const CellRange cells = occupied_ranges_.empty()
                                  ? cellsOf(levels_[0][i].occupied, corners_[i])
                                  : occupied_ranges_.back()[i];
      if (nb_above == 0 || keys[nb_above - 1] != key) {
        above.push_back({0, i});
        ranges.push_back(cells);
        keys[nb_above++] = key;
      }
      above.back().occupied |= std::uint64_t{1} << bit;
      ranges.back() = {ranges.back().low.min(cells.low), ranges.back().high.max(cells.high)};
    }
    keys.resize(nb_above);
    levels_.push_back(std::move(above));
    occupied_ranges_.push_back(std::move(ranges));
  }
}

OccupiedVoxels::CellRange OccupiedVoxels::cellsWithin(const Aabb& box, double reach) const {
  constexpr double FURTHEST = 4.0 * VOXEL_RANGE;
  const auto toCells = [&](const Array3d& numbers) -> Array3i {
    return numbers.max(-FURTHEST).min(FURTHEST).cast<int>();
  };
  const double size = bounds_.min.cwiseAbs().cwiseMax(bounds_.max.cwiseAbs()).maxCoeff();
  const double grown = reach + ROUNDING * (reach + size);
  // A point on a face belongs to the cells on both sides.
  return {toCells(((box.min.array() - grown) / voxel_size_).ceil() - 1.0),
          toCells(((box.max.array() + grown) / voxel_size_).floor())};
}

}  // namespace collision_pairs
