#include "collision_pairs/voxel_grid.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <string>
#include <tuple>

#include "collision_pairs/input_error.h"

namespace collision_pairs {
namespace {

using Eigen::Vector3d;

constexpr std::uint32_t NONE = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t FIRST_SLOTS = 1024;
constexpr double MOST_NUMBERS = 4096;  // of clouds that have not expired, whatever `decay`
constexpr double NEAR_BORDER = 1e-9;   // of a voxel; exceeds rounding for up to 2^20 voxels

/// The blocks of a grid by their corners: an open-addressing hash table of their indices.
class BlockIndex {
 public:
  BlockIndex() : slots_(FIRST_SLOTS, NONE) {}

  void clear() { std::fill(slots_.begin(), slots_.end(), NONE); }

  /// The slot of the block with this corner, or the empty one where it belongs.
  template <class Block>
  std::uint32_t& find(const VoxelCell& corner, const std::vector<Block>& blocks) {
    std::size_t slot = hash(corner) & (slots_.size() - 1);
    while (slots_[slot] != NONE && blocks[slots_[slot]].corner != corner) {
      slot = (slot + 1) & (slots_.size() - 1);
    }
    return slots_[slot];
  }

  /// Makes room for one more than `blocks`.
  template <class Block>
  void reserve(const std::vector<Block>& blocks) {
    if (2 * (blocks.size() + 1) <= slots_.size()) return;
    slots_.resize(2 * slots_.size());
    rebuild(blocks);
  }

  template <class Block>
  void rebuild(const std::vector<Block>& blocks) {
    clear();
    for (std::uint32_t i = 0; i < blocks.size(); ++i) find(blocks[i].corner, blocks) = i;
  }

 private:
  static std::size_t hash(const VoxelCell& corner) {
    const auto bits = [&](int axis) {
      return static_cast<std::uint64_t>(static_cast<std::uint32_t>(corner[axis] + VOXEL_RANGE)) / 4;
    };
    const std::uint64_t key = bits(0) | bits(1) << 19 | bits(2) << 38;
    return static_cast<std::size_t>((key * 0x9e3779b97f4a7c15u) >> 32);
  }

  std::vector<std::uint32_t> slots_;  // a power of two
};

void checkSettings(const VoxelSettings& settings) {
  if (!(settings.voxel_size > 0.0) || !std::isfinite(settings.voxel_size * VOXEL_RANGE)) {
    throw InputError("the voxel size is " + std::to_string(settings.voxel_size) +
                     ", but must be more than 0 metres, and finite");
  }
  if (!(settings.decay >= 0.0)) {
    throw InputError("the decay is " + std::to_string(settings.decay) +
                     ", but must be 0 or more seconds");
  }
  if (settings.min_points < 1) throw InputError("min_points is 0, but must be 1 or more");
  if (settings.max_voxels < 1) throw InputError("max_voxels is 0, but must be 1 or more");
}

}  // namespace

struct VoxelGrid::Store {
  using Block = OccupiedVoxels::Block;  // `occupied`: seen by a cloud that has not expired
  using OfVoxels = std::array<std::uint32_t, 64>;

  explicit Store(const VoxelSettings& chosen)
      : settings(chosen), per_metre(1.0 / chosen.voxel_size) {
    checkSettings(settings);
  }

  /// False if it does not fit.
  bool cellOf(const Vector3d& p, VoxelCell& cell) const {
    for (int axis = 0; axis < 3; ++axis) {
      const double place = p[axis] * per_metre;
      if (!(place > -VOXEL_RANGE - 1.0 && place < VOXEL_RANGE + 1.0)) return false;
      int k = static_cast<int>(place);
      double within = place - k;
      if (within < 0.0) within += 1.0, --k;
      if (within < NEAR_BORDER || within > 1.0 - NEAR_BORDER) {  // the borders are exactly k s
        k -= k * settings.voxel_size > p[axis] ? 1 : 0;
        k += (k + 1) * settings.voxel_size <= p[axis] ? 1 : 0;
      }
      if (k < -VOXEL_RANGE || k >= VOXEL_RANGE) return false;
      cell[axis] = k;
    }
    return true;
  }

  Vector3d centerOf(const VoxelCell& corner, double edge) const {
    return settings.voxel_size * (corner.cast<double>().array() + 0.5 * edge);
  }
  double squaredDistance(const VoxelCell& corner, double edge) const {
    return (centerOf(corner, edge) - p_WS).squaredNorm();
  }

  /// Index of the block, or NONE if there is no room for it.
  std::uint32_t blockAt(const VoxelCell& corner) {
    if (last_block < blocks.size() && blocks[last_block].corner == corner) return last_block;
    std::uint32_t* slot = &index.find(corner, blocks);
    if (*slot == NONE) {
      const bool is_limited = squared_limit < std::numeric_limits<double>::infinity();
      if (is_limited && squaredDistance(corner, 4.0) > squared_limit) return NONE;
      if (blocks.size() > settings.max_voxels + std::size_t{settings.max_voxels} / 4) {
        keepNearestBlocks();
        return blockAt(corner);
      }
      index.reserve(blocks);
      slot = &index.find(corner, blocks);
      *slot = static_cast<std::uint32_t>(blocks.size());
      blocks.push_back({corner, 0});
      if (settings.min_points > 1) nb_points.push_back({});
      if (settings.decay > 0.0) last_seen.push_back({});
      seen.push_back(0);
    }
    return last_block = *slot;
  }

  /// Index of the voxel's block, or NONE if there is no room for it; and its bit.
  std::uint32_t placeOf(const VoxelCell& cell, unsigned& bit) {
    const VoxelCell within(cell[0] & 3, cell[1] & 3, cell[2] & 3);
    const std::uint32_t id = blockAt(cell - within);
    if (id == NONE) truncated_in = number;
    bit = static_cast<unsigned>(within[0] + 4 * within[1] + 16 * within[2]);
    return id;
  }

  void add(const Vector3d& p) {
    VoxelCell cell;
    if (!cellOf(p, cell)) {
      const bool is_finite = p.allFinite();
      ++(is_finite ? counts.out_of_range : counts.not_finite);
      if (is_finite) truncated_in = number;
      return;
    }
    ++counts.added;
    unsigned bit;
    const std::uint32_t id = placeOf(cell, bit);
    if (id == NONE) return;
    if (settings.min_points > 1 && ++nb_points[id][bit] < settings.min_points) return;
    seen[id] |= std::uint64_t{1} << bit;
    blocks[id].occupied |= std::uint64_t{1} << bit;
    if (settings.decay > 0.0) last_seen[id][bit] = number;
  }

  bool occupy(const VoxelCell& cell) {
    unsigned bit;
    const std::uint32_t id = placeOf(cell, bit);
    if (id != NONE) blocks[id].occupied |= std::uint64_t{1} << bit;
    return id != NONE;
  }

  void keep(const VoxelCell& cell) {
    if (occupy(cell)) remembered.push_back(cell);
  }

  template <class IsSuch>
  void drop(const IsSuch& is_such) {
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      for (std::uint64_t left = blocks[i].occupied & ~seen[i]; left != 0; left &= left - 1) {
        const VoxelCell cell =
            blocks[i].corner + OccupiedVoxels::childOffset(__builtin_ctzll(left));
        if (is_such(centerOf(cell, 1.0))) blocks[i].occupied &= ~(left & -left);
      }
    }
  }

  void dropRemembered() {
    for (const VoxelCell& cell : remembered) {
      const VoxelCell within(cell[0] & 3, cell[1] & 3, cell[2] & 3);
      const std::uint32_t id = index.find(cell - within, blocks);
      const auto bit = static_cast<unsigned>(within[0] + 4 * within[1] + 16 * within[2]);
      if (id == NONE || last_seen[id][bit] >= firstKept()) continue;
      blocks[id].occupied &= ~(std::uint64_t{1} << bit);
    }
    remembered.clear();
  }

  bool overlaps(const Block& block, const Aabb& box) const {
    const Vector3d low = settings.voxel_size * block.corner.cast<double>();
    const Vector3d high = low.array() + 4.0 * settings.voxel_size;
    return (low.array() <= box.max.array()).all() && (high.array() >= box.min.array()).all();
  }

  std::vector<VoxelCell> unseen(const Aabb& box) {
    std::vector<VoxelCell> cells;
    for (const Block& block : before) {
      if (!overlaps(block, box)) continue;
      const std::uint32_t id = index.find(block.corner, blocks);
      std::uint64_t left = block.occupied & ~(id == NONE ? 0 : seen[id]);
      for (; left != 0; left &= left - 1) {
        cells.push_back(block.corner + OccupiedVoxels::childOffset(__builtin_ctzll(left)));
      }
    }
    return cells;
  }

  std::shared_ptr<const OccupiedVoxels> seenIn(const Aabb& box) const {
    std::vector<Block> found;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      if (seen[i] != 0 && overlaps(blocks[i], box)) found.push_back({blocks[i].corner, seen[i]});
    }
    return std::make_shared<const OccupiedVoxels>(settings.voxel_size, found, false);
  }

  void begin(double new_stamp, const Vector3d& p_WSensor) {
    if (!std::isfinite(new_stamp) || !p_WSensor.allFinite()) {
      throw InputError("the stamp of a cloud, or the place of its sensor, is not finite");
    }
    before.clear();
    for (std::size_t i = 0; new_stamp >= stamp && i < blocks.size(); ++i) {
      if (seen[i] != 0) before.push_back({blocks[i].corner, seen[i]});
    }
    if (new_stamp < stamp || settings.decay == 0.0) dropAll();
    stamp = new_stamp;
    p_WS = p_WSensor;
    counts = {};
    squared_limit = std::numeric_limits<double>::infinity();
    numberCloud();
    forget(stamp);
    dropRemembered();
    dropEmptyBlocks();  // they would count as voxels of this cloud
    for (OfVoxels& of_block : nb_points) of_block.fill(0);
    std::fill(seen.begin(), seen.end(), 0);
  }

  /// Clouds that come faster than MOST_NUMBERS in `decay` share numbers, and expire together.
  void numberCloud() {
    if (!stamps.empty() && stamp - first_of_number < settings.decay / MOST_NUMBERS) {
      stamps.back() = stamp;
      return;
    }
    ++number;
    stamps.push_back(stamp);
    first_of_number = stamp;
  }

  /// Removes voxels last seen in a cloud that is too old.
  void forget(double now) {
    if (settings.decay == 0.0) return;
    const std::uint32_t first_before = firstKept();
    while (!stamps.empty() && now - stamps.front() > settings.decay) stamps.pop_front();
    if (firstKept() == first_before) return;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      for (std::uint64_t left = blocks[i].occupied; left != 0; left &= left - 1) {
        const int bit = __builtin_ctzll(left);
        if (last_seen[i][static_cast<unsigned>(bit)] >= firstKept()) continue;
        blocks[i].occupied &= ~(std::uint64_t{1} << bit);
      }
    }
  }

  std::uint32_t firstKept() const { return number + 1 - static_cast<std::uint32_t>(stamps.size()); }

  void keepNearestBlocks() {
    std::vector<std::pair<double, std::uint32_t>> by_distance;
    for (std::uint32_t i = 0; i < blocks.size(); ++i) {
      by_distance.emplace_back(squaredDistance(blocks[i].corner, 4.0), i);
    }
    const auto last = by_distance.begin() + settings.max_voxels - 1;
    std::nth_element(by_distance.begin(), last, by_distance.end());
    squared_limit = last->first;
    truncated_in = number;
    std::vector<char> kept(blocks.size(), 0);
    for (auto one = by_distance.begin(); one <= last; ++one) kept[one->second] = 1;
    keepBlocks([&](std::size_t i) { return kept[i] != 0; });
  }

  void dropEmptyBlocks() {
    const auto isEmpty = [](const Block& block) { return block.occupied == 0; };
    if (std::none_of(blocks.begin(), blocks.end(), isEmpty)) return;
    keepBlocks([&](std::size_t i) { return !isEmpty(blocks[i]); });
  }

  template <class IsKept>
  void keepBlocks(const IsKept& is_kept) {
    std::size_t nb_kept = 0;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      if (!is_kept(i)) continue;
      blocks[nb_kept] = blocks[i];
      if (!nb_points.empty()) nb_points[nb_kept] = nb_points[i];
      if (!last_seen.empty()) last_seen[nb_kept] = last_seen[i];
      seen[nb_kept] = seen[i];
      ++nb_kept;
    }
    blocks.resize(nb_kept);
    if (!nb_points.empty()) nb_points.resize(nb_kept);
    if (!last_seen.empty()) last_seen.resize(nb_kept);
    seen.resize(nb_kept);
    index.rebuild(blocks);
  }

  void keepNearestVoxels() {
    std::size_t nb_voxels = 0;
    for (const Block& block : blocks) {
      nb_voxels += static_cast<std::size_t>(__builtin_popcountll(block.occupied));
    }
    if (nb_voxels <= settings.max_voxels) return;
    std::vector<std::tuple<double, std::uint32_t, int>> by_distance;
    for (std::uint32_t i = 0; i < blocks.size(); ++i) {
      for (std::uint64_t left = blocks[i].occupied; left != 0; left &= left - 1) {
        const int bit = __builtin_ctzll(left);
        const VoxelCell cell = blocks[i].corner + OccupiedVoxels::childOffset(bit);
        by_distance.emplace_back(squaredDistance(cell, 1.0), i, bit);
      }
    }
    const auto end_of_kept = by_distance.begin() + settings.max_voxels;
    std::nth_element(by_distance.begin(), end_of_kept, by_distance.end());
    for (auto one = end_of_kept; one != by_distance.end(); ++one) {
      blocks[std::get<1>(*one)].occupied &= ~(std::uint64_t{1} << std::get<2>(*one));
    }
    truncated_in = number;
  }

  std::shared_ptr<const OccupiedVoxels> end() {
    keepNearestVoxels();
    dropEmptyBlocks();
    const bool truncated = truncated_in != 0 && truncated_in >= firstKept();
    return std::make_shared<const OccupiedVoxels>(settings.voxel_size, blocks, truncated);
  }

  void clear() {
    dropAll();
    before.clear();
  }

  void dropAll() {
    blocks.clear();
    nb_points.clear();
    last_seen.clear();
    seen.clear();
    remembered.clear();
    stamps.clear();
    index.clear();
    truncated_in = 0;
  }

  const VoxelSettings settings;
  const double per_metre;
  PointCounts counts;
  Vector3d p_WS = Vector3d::Zero();
  double stamp = -std::numeric_limits<double>::infinity();
  double squared_limit = std::numeric_limits<double>::infinity();  ///< of new blocks
  std::uint32_t number = 0;                                        ///< of the cloud, from 1 on
  double first_of_number = 0.0;    ///< stamp of the first cloud with this number
  std::uint32_t truncated_in = 0;  ///< number of the last cloud that did not fit
  std::deque<double> stamps;       ///< by number: of its last cloud, for those not expired
  std::vector<Block> blocks;
  std::vector<OfVoxels> nb_points;    ///< in this cloud, by block; empty if one point is enough
  std::vector<OfVoxels> last_seen;    ///< number of the cloud, by block; empty without decay
  std::vector<Block> before;          ///< what the cloud before this one occupied
  std::vector<std::uint64_t> seen;    ///< in this cloud, by block: bits as in Block
  std::vector<VoxelCell> remembered;  ///< by keep(), since begin()
  std::uint32_t last_block = NONE;    ///< added to; told by its corner
  BlockIndex index;
};

VoxelGrid::VoxelGrid(const VoxelSettings& settings) : store_(std::make_unique<Store>(settings)) {}
VoxelGrid::~VoxelGrid() = default;
VoxelGrid::VoxelGrid(VoxelGrid&&) noexcept = default;
VoxelGrid& VoxelGrid::operator=(VoxelGrid&&) noexcept = default;

void VoxelGrid::begin(double stamp, const Vector3d& p_WS) { store_->begin(stamp, p_WS); }
void VoxelGrid::add(const Vector3d& p_WP) { store_->add(p_WP); }
std::shared_ptr<const OccupiedVoxels> VoxelGrid::end() { return store_->end(); }
std::shared_ptr<const OccupiedVoxels> VoxelGrid::seen(const Aabb& box) const {
  return store_->seenIn(box);
}
std::vector<VoxelCell> VoxelGrid::unseen(const Aabb& box) { return store_->unseen(box); }
void VoxelGrid::keep(const VoxelCell& cell) { store_->keep(cell); }
void VoxelGrid::drop(const std::function<bool(const Vector3d&)>& is_such) { store_->drop(is_such); }

std::shared_ptr<const OccupiedVoxels> VoxelGrid::at(double stamp) {
  store_->forget(stamp);
  for (const VoxelCell& cell : store_->remembered) store_->occupy(cell);  // until the next cloud
  return store_->end();
}

void VoxelGrid::clear() { store_->clear(); }
const PointCounts& VoxelGrid::counts() const { return store_->counts; }
const VoxelSettings& VoxelGrid::settings() const { return store_->settings; }

}  // namespace collision_pairs
