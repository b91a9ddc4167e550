// Collects the points of one source in voxels, cloud by cloud.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "collision_pairs/occupied_voxels.h"

namespace collision_pairs {

struct VoxelSettings {
  double voxel_size = 0.02;      ///< metres, > 0
  std::uint32_t min_points = 1;  ///< >= 1: points of one cloud needed to occupy a voxel
  /// Seconds, >= 0, after which a voxel is dropped that no later cloud occupies; at most a 4096th
  /// of it later if clouds come faster than that. 0: each cloud replaces the previous one.
  double decay = 0.0;
  /// >= 1: beyond this number the voxels furthest from the sensor are dropped, and the result is
  /// truncated. Those with fewer points of a cloud than min_points count until its end. Also bounds
  /// the memory: typically 0.1 kB per voxel, at worst, if no two are near each other, 1.4 kB.
  std::uint32_t max_voxels = 1'000'000;
};

/// Numbers of points of one cloud.
struct PointCounts {
  std::uint64_t added = 0;
  std::uint64_t not_finite = 0;  ///< skipped
  /// More than VOXEL_RANGE voxels from W's origin: the result is truncated.
  std::uint64_t out_of_range = 0;
};

/// A point p lies in cell floor(p / voxel_size), exactly: cell k holds it if k s <= p < (k + 1) s
/// in double precision.
///
///   grid.begin(stamp, p_WS);
///   for (…) grid.add(p_WP);
///   std::shared_ptr<const OccupiedVoxels> voxels = grid.end();
///
/// Keeps voxels from cloud to cloud, according to `decay`, and what keep() adds. Cost: 20 to 30 ns
/// per point in the order of a camera image, with voxels of 1 cm, including end() (docs/clouds.md).
/// Not thread safe.
class VoxelGrid {
 public:
  /// Throws InputError for settings out of range.
  explicit VoxelGrid(const VoxelSettings& settings);
  ~VoxelGrid();
  VoxelGrid(VoxelGrid&&) noexcept;
  VoxelGrid& operator=(VoxelGrid&&) noexcept;

  /// Starts a cloud with this stamp (seconds, of any clock; if it goes back, all voxels are
  /// dropped) and sensor origin p_WS (metres, in W).
  void begin(double stamp, const Eigen::Vector3d& p_WS);
  /// Adds a point of the cloud (metres, in W).
  void add(const Eigen::Vector3d& p_WP);
  /// Ends the cloud and returns all occupied voxels. Never null.
  std::shared_ptr<const OccupiedVoxels> end();

  /// Those that this cloud occupies, of the blocks that overlap the box (metres, in W). Never null.
  std::shared_ptr<const OccupiedVoxels> seen(const Aabb& box) const;
  /// Those that the cloud before occupied and this one does not, of the same blocks.
  std::vector<VoxelCell> unseen(const Aabb& box);
  /// Occupies a voxel until the next cloud, as if it were remembered. Before end().
  void keep(const VoxelCell& cell);
  /// Drops those of earlier clouds whose centre (metres, in W) is such. Before end().
  void drop(const std::function<bool(const Eigen::Vector3d& center)>& is_such);

  /// The voxels at `stamp` without a new cloud; expired ones are dropped. The next cloud may be
  /// older than that: clouds arrive late.
  std::shared_ptr<const OccupiedVoxels> at(double stamp);

  void clear();
  const PointCounts& counts() const;  ///< of the last cloud
  const VoxelSettings& settings() const;

 private:
  struct Store;
  std::unique_ptr<Store> store_;
};

}  // namespace collision_pairs
