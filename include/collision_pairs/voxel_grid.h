// Gathers the points of one source, cloud by cloud, in voxels.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "collision_pairs/occupied_voxels.h"

namespace collision_pairs {

struct VoxelSettings {
  double voxel_size = 0.02;      ///< metres, > 0
  std::uint32_t min_points = 1;  ///< >= 1: fewer points of one cloud do not occupy a voxel
  /// Seconds, >= 0, after which a voxel that no later cloud occupies is forgotten. 0: each cloud
  /// shows everything, and what it does not show is gone.
  double decay = 0.0;
  /// >= 1: of more occupied voxels those furthest from the sensor are left out, and the voxels are
  /// truncated. Bounds the memory too: mostly 0.1 kB for each, at worst, where no two are near each
  /// other, 1.4 kB.
  std::uint32_t max_voxels = 1'000'000;
};

/// What became of the points of one cloud.
struct PointCounts {
  std::uint64_t added = 0;
  std::uint64_t not_finite = 0;  ///< skipped
  std::uint64_t out_of_range =
      0;  ///< more than VOXEL_RANGE voxels from W: the voxels are truncated
};

/// A point p lies in cell floor(p / voxel_size), exactly: cell k holds it if k s <= p < (k + 1) s
/// in double precision.
///
///   grid.begin(stamp, p_WS);
///   for (…) grid.add(p_WP);
///   std::shared_ptr<const OccupiedVoxels> voxels = grid.end();
///
/// Keeps voxels from cloud to cloud, as `decay` says, and nothing else. Cost: 20 to 30 ns a
/// point in the order in which a camera gives them, at voxels of 1 cm, end() included
/// (docs/clouds.md). Not thread safe.
class VoxelGrid {
 public:
  /// Throws InputError for settings out of their range.
  explicit VoxelGrid(const VoxelSettings& settings);
  ~VoxelGrid();
  VoxelGrid(VoxelGrid&&) noexcept;
  VoxelGrid& operator=(VoxelGrid&&) noexcept;

  /// Starts a cloud that was seen at `stamp` (seconds, of any clock that does not go back: where it
  /// does, what was seen is forgotten) from p_WS.
  void begin(double stamp, const Eigen::Vector3d& p_WS);
  /// A point of it, in W.
  void add(const Eigen::Vector3d& p_WP);
  /// Ends the cloud: all that is occupied now. Never null.
  std::shared_ptr<const OccupiedVoxels> end();

  /// What is occupied at `stamp` without a new cloud: what is older by then is forgotten.
  std::shared_ptr<const OccupiedVoxels> at(double stamp);

  void clear();
  const PointCounts& counts() const;  ///< of the last cloud
  const VoxelSettings& settings() const;

 private:
  struct Store;
  std::unique_ptr<Store> store_;
};

}  // namespace collision_pairs
