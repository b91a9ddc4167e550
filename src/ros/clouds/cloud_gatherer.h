// From the points of one source to the voxels that they occupy.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <ros/time.h>

#include "cloud_config.h"
#include "collision_pairs/self_filter.h"
#include "collision_pairs/voxel_grid.h"
#include "tf_poses.h"

namespace collision_pairs {

/// What tells points of the robot from obstacles, in one scene.
struct RobotFilter {
  RobotFilter(const SceneDescription& description, double padding, SceneCache* cache)
      : filter(description, padding, cache) {}
  SelfFilter filter;
  std::unique_ptr<TfPoses> poses;  ///< of filter.bodies()
};

/// Crops, filters and gathers. For one thread.
class CloudGatherer {
 public:
  explicit CloudGatherer(const CloudConfig& config);

  /// Points in the frame S of the sensor, where that stood in W, and the robot's poses of that
  /// instant. Throws InputError if a link of the robot has no pose: its points would be obstacles.
  std::shared_ptr<const OccupiedVoxels> add(const std::vector<Eigen::Vector3f>& points,
                                            const Eigen::Isometry3d& X_WS, const BodyPoses& robot,
                                            const ros::Time& stamp, SelfFilter& filter);

  /// The points of the last cloud that are obstacles, in S.
  const std::vector<Eigen::Vector3f>& kept() const { return kept_; }
  void clear() { grid_.clear(); }

 private:
  const CloudConfig config_;
  VoxelGrid grid_;
  std::vector<Eigen::Vector3f> kept_;
};

}  // namespace collision_pairs
