#include "cloud_gatherer.h"

#include <algorithm>
#include <sstream>

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

std::shared_ptr<const OccupiedVoxels> CloudGatherer::add(const std::vector<Eigen::Vector3d>& points,
                                                         const Eigen::Isometry3d& X_WS,
                                                         const BodyPoses& robot, double stamp,
                                                         SelfFilter& filter) {
  requireValid(points);
  filter.begin(robot);
  if (!filter.leftOut().empty()) {
    throw InputError(
        "link '" + filter.leftOut().front() +
        "' has no pose at its stamp, so its points cannot be distinguished from obstacles");
  }
  kept_.clear();
  grid_.begin(stamp, X_WS.translation());
  const double squared_range = config_.max_range * config_.max_range;
  for (const Eigen::Vector3d& p_SP : points) {
    if (p_SP.squaredNorm() > squared_range) continue;
    const Eigen::Vector3d p_WP = X_WS * p_SP;
    if (config_.box && !config_.box->contains(p_WP)) continue;
    if (filter.isOwn(p_WP)) continue;
    grid_.add(p_WP);
    kept_.push_back(p_SP);
  }
  return grid_.end();
}

void CloudGatherer::requireValid(const std::vector<Eigen::Vector3d>& points) {
  const auto needed = static_cast<std::size_t>(config_.min_valid_points);
  const std::size_t enough = std::max<std::size_t>(needed, 1);
  const double squared_range = config_.max_range * config_.max_range;
  std::size_t nb_valid = 0;
  for (std::size_t i = 0; i < points.size() && nb_valid < enough; ++i) {
    nb_valid += points[i].squaredNorm() <= squared_range;
  }
  warning_.clear();
  if (nb_valid == enough) return;
  std::ostringstream found;
  if (points.empty()) {
    found << "it has no finite point";
  } else {
    found << "only " << nb_valid << " of its " << points.size()
          << " finite points are within max_range (" << config_.max_range << " m)";
  }
  if (nb_valid < needed) {
    found << ", and min_valid_points is " << needed;
    throw InputError(found.str());
  }
  warning_ = found.str();
}

}  // namespace collision_pairs
