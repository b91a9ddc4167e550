// Converts the points of one source into occupied voxels.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "cloud_config.h"
#include "collision_pairs/self_filter.h"
#include "collision_pairs/voxel_grid.h"

namespace collision_pairs {

/// Crops, filters and collects points. Not thread safe.
class CloudGatherer {
 public:
  explicit CloudGatherer(const CloudConfig& config);

  /// Points in the sensor's frame S, the pose of S in W and the robot's poses at that stamp, and
  /// the stamp in seconds. Throws InputError, and changes nothing, if a link of the robot has no
  /// pose, since its points would be obstacles, or if fewer than min_valid_points are valid.
  std::shared_ptr<const OccupiedVoxels> add(const std::vector<Eigen::Vector3d>& points,
                                            const Eigen::Isometry3d& X_WS, const BodyPoses& robot,
                                            double stamp, SelfFilter& filter);

  /// The points of the last cloud that are obstacles, in S.
  const std::vector<Eigen::Vector3d>& kept() const { return kept_; }
  /// A warning if the last cloud showed nothing: no valid point, which min_valid_points permits.
  const std::string& warning() const { return warning_; }
  void clear() { grid_.clear(); }

 private:
  void requireValid(const std::vector<Eigen::Vector3d>& points);

  const CloudConfig config_;
  VoxelGrid grid_;
  std::vector<Eigen::Vector3d> kept_;
  std::string warning_;
};

}  // namespace collision_pairs
