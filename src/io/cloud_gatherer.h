// Converts the points of one source into occupied voxels.
#pragma once

#include <memory>
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
  /// the stamp in seconds. Throws InputError if a link of the robot has no pose, since its points
  /// would be obstacles.
  std::shared_ptr<const OccupiedVoxels> add(const std::vector<Eigen::Vector3f>& points,
                                            const Eigen::Isometry3d& X_WS, const BodyPoses& robot,
                                            double stamp, SelfFilter& filter);

  /// The points of the last cloud that are obstacles, in S.
  const std::vector<Eigen::Vector3f>& kept() const { return kept_; }
  void clear() { grid_.clear(); }

 private:
  const CloudConfig config_;
  VoxelGrid grid_;
  std::vector<Eigen::Vector3f> kept_;
};

}  // namespace collision_pairs
