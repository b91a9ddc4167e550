#include "cloud_processor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "collision_pairs/input_error.h"
#include "depth_map.h"
#include "occluded_obstacles.h"

namespace collision_pairs {
namespace {

using Eigen::Vector3d;

constexpr double NOISE = 0.01;             // metres, of a range
constexpr std::size_t MOST_RAYS = 50'000;  // that are looked at for what they hide

VoxelSettings settingsOf(const CloudConfig& config) {
  VoxelSettings settings;
  settings.voxel_size = config.voxel_size;
  settings.min_points = static_cast<std::uint32_t>(config.min_points);
  settings.decay = config.replace ? 0.0 : config.decay;
  settings.max_voxels = static_cast<std::uint32_t>(config.max_voxels);
  return settings;
}

std::set<std::string> checkedAgainst(const std::string& cloud, const CollisionScene& scene) {
  std::set<std::string> names;
  const int id = scene.findModel(cloud);
  for (std::uint32_t i = 0; id >= 0 && i < scene.models().size(); ++i) {
    if (scene.filter().allowed(i, static_cast<std::uint32_t>(id))) {
      names.insert(scene.models()[i].name);
    }
  }
  return names;
}

SelfFilter nearFilter(const SceneDescription& description, const CollisionScene& scene,
                      const CloudConfig& cloud, SceneCache* cache) {
  const std::set<std::string> checked = checkedAgainst(cloud.name(), scene);
  return SelfFilter(description, cloud.near(), cache, &checked);
}

SelfFilter attachedFilter(const SceneDescription& description, const CloudConfig& cloud,
                          SceneCache* cache) {
  std::set<std::string> attached;
  for (const RigidObject& object : description.objects) {
    if (!object.attached_link.empty()) attached.insert(object.name);
  }
  const double half_diagonal = 0.5 * std::sqrt(3.0) * cloud.voxel_size;
  return SelfFilter(description, cloud.self_filter_padding + half_diagonal, cache, &attached);
}

/// Those of the first that are not in the second.
std::set<std::string> without(const std::vector<std::string>& names,
                              const std::vector<std::string>& others) {
  std::set<std::string> left(names.begin(), names.end());
  for (const std::string& other : others) left.erase(other);
  return left;
}

/// Points by cells of the edge length `reach`.
class PointGrid {
 public:
  explicit PointGrid(double reach) : reach_(reach) {}

  void add(const Vector3d& p) { cells_[cellOf(p)].push_back(p); }
  /// O(points of 27 cells).
  bool hasWithinReach(const Vector3d& p) const {
    const Cell cell = cellOf(p);
    for (int i = 0; i < 27; ++i) {
      const auto found =
          cells_.find({cell[0] + i % 3 - 1, cell[1] + i / 3 % 3 - 1, cell[2] + i / 9 - 1});
      if (found == cells_.end()) continue;
      for (const Vector3d& q : found->second) {
        if ((q - p).norm() < reach_) return true;
      }
    }
    return false;
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  Cell cellOf(const Vector3d& p) const {
    Cell cell;
    for (int axis = 0; axis < 3; ++axis) {
      constexpr double FAR = 1e15;
      cell[static_cast<std::size_t>(axis)] =
          static_cast<std::int64_t>(std::floor(std::clamp(p[axis] / reach_, -FAR, FAR)));
    }
    return cell;
  }

  const double reach_;
  std::map<Cell, std::vector<Vector3d>> cells_;
};

}  // namespace

RobotFilter::RobotFilter(const SceneDescription& description, const CollisionScene& scene,
                         const CloudConfig& cloud, SceneCache* cache)
    : own(description, cloud.self_filter_padding, cache),
      near(nearFilter(description, scene, cloud, cache)),
      attached(attachedFilter(description, cloud, cache)) {}

std::vector<std::string> onlyCheckedBy(const CollisionScene& scene, const CollisionScene& other) {
  std::set<std::string> names;
  for (const SceneCloud& cloud : scene.clouds()) {
    const std::string& name = scene.models()[cloud.model].name;
    const std::set<std::string> by_other = checkedAgainst(name, other);
    for (const std::string& checked : checkedAgainst(name, scene)) {
      if (by_other.count(checked) == 0) names.insert(checked);
    }
  }
  return {names.begin(), names.end()};
}

CloudProcessor::CloudProcessor(const CloudConfig& config)
    : config_(config),
      grid_(settingsOf(config)),
      memory_(std::make_unique<OccludedObstacles>(config.near(), config.padding())),
      depths_(std::make_unique<DepthMap>()) {}

CloudProcessor::~CloudProcessor() = default;
CloudProcessor::CloudProcessor(CloudProcessor&&) noexcept = default;

std::shared_ptr<const OccupiedVoxels> CloudProcessor::add(const Points& points,
                                                          const Eigen::Isometry3d& X_WS,
                                                          const BodyPoses& robot, double stamp,
                                                          RobotFilter& filter) {
  requireValid(points);
  filter.own.begin(robot);
  if (!filter.own.leftOut().empty()) {
    throw InputError(
        "link '" + filter.own.leftOut().front() +
        "' has no pose at its stamp, so its points cannot be distinguished from obstacles");
  }
  filter.near.begin(robot);
  grid_.begin(stamp, X_WS.translation());
  sort(points, X_WS, filter.own);
  remember(points, X_WS, robot, filter);
  own_names_ = filter.own.names();
  return grid_.end();
}

void CloudProcessor::requireValid(const Points& points) {
  const auto needed = static_cast<std::size_t>(config_.min_valid_points);
  const std::size_t enough = std::max<std::size_t>(needed, 1);
  const double squared_range = config_.max_range * config_.max_range;
  std::size_t nb_valid = 0;
  // That is where a frame other than the camera's has points of no return.
  bool are_at_one_place = points.size() > 1;
  for (std::size_t i = 0; i < points.size() && (nb_valid < enough || are_at_one_place); ++i) {
    nb_valid += points[i].squaredNorm() <= squared_range;
    are_at_one_place = are_at_one_place && (points[i] - points[0]).squaredNorm() < 1e-6;
  }
  if (are_at_one_place) nb_valid = 0;
  warning_.clear();
  if (nb_valid >= enough) return;
  std::ostringstream found;
  if (points.empty()) {
    found << "nothing returned: it has no point that is finite and further than 1 mm from the "
             "sensor";
  } else if (are_at_one_place) {
    found << "nothing returned: its " << points.size() << " points are at one place";
  } else {
    found << "only " << nb_valid << " of its " << points.size() << " points are within max_range ("
          << config_.max_range << " m)";
  }
  if (nb_valid < needed) {
    found << ", and min_valid_points is " << needed;
    throw InputError(found.str());
  }
  warning_ = found.str();
}

void CloudProcessor::sort(const Points& points, const Eigen::Isometry3d& X_WS, SelfFilter& own) {
  kept_.clear();
  kinds_.assign(points.size(), Kind::LEFT_OUT);
  const double squared_range = config_.max_range * config_.max_range;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector3d& p_SP = points[i];
    const Vector3d p_WP = X_WS * p_SP;
    // The robot's own points beyond the crop are asked for first: they are no obstacle that is
    // seen.
    if (own.isOwn(p_WP)) {
      kinds_[i] = Kind::OWN;
      continue;
    }
    if (p_SP.squaredNorm() > squared_range) continue;
    if (config_.box && !config_.box->contains(p_WP)) continue;
    kinds_[i] = Kind::KEPT;
    grid_.add(p_WP);
    kept_.push_back(p_SP);
  }
}

void CloudProcessor::remember(const Points& points, const Eigen::Isometry3d& X_WS,
                              const BodyPoses& robot, RobotFilter& filter) {
  SelfFilter& near = filter.near;
  const double around = OccludedObstacles::FOUND_AGAIN + config_.near();
  Aabb box = enclosing(near.bounds(), memory_->missed());
  box.min.array() -= around;
  box.max.array() += around;
  const Eigen::Isometry3d X_SW = X_WS.inverse(Eigen::Isometry);
  bool is_drawn = false;
  const auto isHidden = [&](const Vector3d& p_W) {
    if (!is_drawn) drawDepths(points);
    is_drawn = true;
    return depths_->hides(X_SW * p_W);
  };
  std::optional<PointGrid> left_out;
  const auto isLeftOut = [&](const Vector3d& p_W) {
    if (!left_out) {
      left_out.emplace(config_.near());
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (kinds_[i] != Kind::LEFT_OUT) continue;
        const Vector3d p_WP = X_WS * points[i];
        const bool may_be_near =
            (p_WP.array() >= box.min.array()).all() && (p_WP.array() <= box.max.array()).all();
        if (may_be_near) left_out->add(points[i]);
      }
    }
    return left_out->hasWithinReach(X_SW * p_W);
  };
  // What is attached since the last cloud was an obstacle in it.
  const std::set<std::string> added = without(filter.attached.names(), own_names_);
  if (!added.empty()) filter.attached.begin(robot);
  const auto isTakenUp = [&](const Vector3d& p_W) {
    return !added.empty() && !filter.attached.nearest(p_W, &added).name.empty();
  };
  if (!added.empty()) grid_.drop(isTakenUp);
  memory_->update({grid_.seen(box), grid_.unseen(near.bounds()), robot, near, isHidden, isLeftOut,
                   isTakenUp, filter.keeps_more});
  for (const VoxelCell& cell : memory_->hidden()) grid_.keep(cell);
}

/// A ray that ends on the robot hides what lies further. One that ends on an obstacle may be of the
/// same obstacle as a voxel, so it hides only what is clearly behind.
void CloudProcessor::drawDepths(const Points& points) {
  depths_->begin(points.size());
  const double obstacle = 2.0 * config_.voxel_size + 2.0 * NOISE;
  const std::size_t step = 1 + points.size() / MOST_RAYS;
  for (std::size_t i = 0; i < points.size(); i += step) {
    depths_->add(points[i], points[i].norm() + (kinds_[i] == Kind::OWN ? NOISE : obstacle));
  }
}

std::string CloudProcessor::mayTouch() const { return memory_->mayTouch(); }
bool CloudProcessor::hidesAny() const { return !memory_->hidden().empty(); }

void CloudProcessor::clear() {
  grid_.clear();
  memory_->clear();
}

}  // namespace collision_pairs
