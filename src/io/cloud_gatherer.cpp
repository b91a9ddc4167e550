#include "cloud_gatherer.h"

#include "collision_pairs/input_error.h"

namespace collision_pairs {
namespace {

VoxelSettings settingsOf(const CloudConfig& config) {
  VoxelSettings settings;
  settings.voxel_size = config.voxel_size;
  settings.min_points = static_cast<std::uint32_t>(config.min_points);
  settings.decay = config.replace ? 0.0 : config.decay;
  settings.max_voxels = static_cast<std::uint32_t>(config.max_voxels);
  return settings;
}

}  // namespace

CloudGatherer::CloudGatherer(const CloudConfig& config)
    : config_(config), grid_(settingsOf(config)) {}

std::shared_ptr<const OccupiedVoxels> CloudGatherer::add(const std::vector<Eigen::Vector3f>& points,
                                                         const Eigen::Isometry3d& X_WS,
                                                         const BodyPoses& robot, double stamp,
                                                         SelfFilter& filter) {
  filter.begin(robot);
  if (!filter.leftOut().empty()) {
    throw InputError(
        "link '" + filter.leftOut().front() +
        "' has no pose at its stamp, so its points cannot be distinguished from obstacles");
  }
  kept_.clear();
  grid_.begin(stamp, X_WS.translation());
  const double squared_range = config_.max_range * config_.max_range;
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3d p_SP = point.cast<double>();
    if (p_SP.squaredNorm() > squared_range) continue;
    const Eigen::Vector3d p_WP = X_WS * p_SP;
    if (config_.box && !config_.box->contains(p_WP)) continue;
    if (filter.isOwn(p_WP)) continue;
    grid_.add(p_WP);
    kept_.push_back(point);
  }
  return grid_.end();
}

}  // namespace collision_pairs
