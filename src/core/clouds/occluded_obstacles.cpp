#include "occluded_obstacles.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace collision_pairs {
namespace {

using Eigen::Vector3d;

constexpr double BESIDE = 2.0;            // voxels between those of one obstacle
constexpr double HALF = 0.499;            // voxels, rounded to the side of UNKNOWN
constexpr std::size_t MOST_PLACES = 200;  // of one kind; more say nothing new

Vector3d centerOf(const OccupiedVoxels& voxels, const VoxelCell& cell) {
  return voxels.boxOf(cell, VoxelCell::Ones()).center();
}

bool anyWithin(const std::shared_ptr<const OccupiedVoxels>& voxels, const Vector3d& p_W,
               double reach) {
  return voxels && voxels->anyWithin({p_W, p_W}, reach);
}

bool isBefore(const VoxelCell& a, const VoxelCell& b) {
  return std::tie(a[0], a[1], a[2]) < std::tie(b[0], b[1], b[2]);
}

}  // namespace

void OccludedObstacles::update(const Cloud& cloud) {
  takeWhatStayed(cloud);
  std::vector<Unseen> left = unseenIn(cloud);
  remembered_.clear();
  std::vector<VoxelCell> cells;
  for (const Unseen& unseen : left) cells.push_back(unseen.cell);
  const OccupiedVoxels all(cloud.now->voxelSize(), cells);
  // Obstacle by obstacle: what lies beside each other.
  std::vector<char> is_taken(left.size(), 0);
  for (std::size_t first = 0; first < left.size(); ++first) {
    if (is_taken[first]) continue;
    is_taken[first] = 1;
    std::vector<Unseen> obstacle = {left[first]};
    for (std::size_t i = 0; i < obstacle.size(); ++i) {
      const Aabb box = all.boxOf(obstacle[i].cell, VoxelCell::Ones());
      all.forEachWithin(box, BESIDE * all.voxelSize(), [&](const VoxelCell& cell) {
        const auto at = std::lower_bound(
            left.begin(), left.end(), cell,
            [](const Unseen& a, const VoxelCell& b) { return isBefore(a.cell, b); });
        char& taken = is_taken[static_cast<std::size_t>(at - left.begin())];
        if (!taken) obstacle.push_back(*at);
        taken = 1;
      });
    }
    judge(obstacle, cloud);
  }
  followWhatIsHidden(cloud);
  findWhatAppeared(cloud);
  earlier_ = std::move(before_);
  before_ = cloud.now;
}

void OccludedObstacles::takeWhatStayed(const Cloud& cloud) {
  const auto isFound = [&](const Vanished& one) {
    return one.appeared && anyWithin(cloud.now, *one.appeared, reach_);
  };
  for (const Vanished& one : hidden_) {
    if (!isFound(one)) continue;
    remembered_.erase(
        std::remove_if(remembered_.begin(), remembered_.end(),
                       [&](const Remembered& other) { return isPartOf(one, other, cloud); }),
        remembered_.end());
  }
  for (std::vector<Vanished>* missed : {&vanished_, &hidden_}) {
    missed->erase(std::remove_if(missed->begin(), missed->end(), isFound), missed->end());
  }
}

bool OccludedObstacles::isPartOf(const Vanished& obstacle, const Remembered& one,
                                 const Cloud& cloud) {
  return one.is_alone && (centerOf(*cloud.now, one.cell) - obstacle.p_W).norm() < FOUND_AGAIN;
}

/// Those of which nothing is hidden any more have vanished unless something is seen there: the
/// robot may have moved away and carry them.
void OccludedObstacles::followWhatIsHidden(const Cloud& cloud) {
  std::vector<Vanished> hidden;
  for (Vanished one : hidden_) {
    const auto isIn = [&](const Remembered& other) {
      const Vector3d at = one.p_W / cloud.now->voxelSize() - other.cell.cast<double>();
      return (at.array() >= 0.0 && at.array() <= 1.0).all();
    };
    const auto isPart = [&](const Remembered& other) { return isPartOf(one, other, cloud); };
    if (std::any_of(remembered_.begin(), remembered_.end(), isPart)) {
      one.distance = cloud.near.nearest(one.p_W).distance;
      one.is_in_contact = one.distance - HALF * cloud.now->voxelSize() <= padding_ &&
                          std::any_of(remembered_.begin(), remembered_.end(), isIn);
      hidden.push_back(one);
    } else if (!cloud.isTakenUp(one.p_W) && !anyWithin(cloud.now, one.p_W, reach_) &&
               !anyWithin(cloud.now, placeOnLink(one, cloud), reach_) &&
               vanished_.size() < MOST_PLACES) {
      vanished_.push_back(one);
    }
  }
  hidden_ = std::move(hidden);
}

/// Sorted by cell.
std::vector<OccludedObstacles::Unseen> OccludedObstacles::unseenIn(const Cloud& cloud) const {
  std::vector<Unseen> unseen;
  const double size = cloud.now->voxelSize();
  const auto take = [&](const VoxelCell& cell, bool was_alone, bool was_seen) {
    const Vector3d center = centerOf(*cloud.now, cell);
    if (!cloud.near.mayBeOwn(center) || anyWithin(cloud.now, center, 0.0)) return;
    if (cloud.isTakenUp(center)) return;
    const bool is_beside = anyWithin(cloud.now, center, BESIDE * size);
    const bool is_hidden = cloud.isHidden(center);
    if (!is_hidden && (is_beside || anyWithin(cloud.now, center, reach_))) return;
    unseen.push_back({cell, is_hidden, is_beside, was_alone, was_seen});
  };
  for (const Remembered& one : remembered_) take(one.cell, one.is_alone, false);
  for (std::size_t i = 0; before_ && i < cloud.unseen.size(); ++i) {
    take(cloud.unseen[i], false, true);
  }
  std::sort(unseen.begin(), unseen.end(),
            [](const Unseen& a, const Unseen& b) { return isBefore(a.cell, b.cell); });
  unseen.erase(std::unique(unseen.begin(), unseen.end(),
                           [](const Unseen& a, const Unseen& b) { return a.cell == b.cell; }),
               unseen.end());
  return unseen;
}

void OccludedObstacles::judge(const std::vector<Unseen>& obstacle, const Cloud& cloud) {
  const auto any = [&](const auto& holds) {
    return std::any_of(obstacle.begin(), obstacle.end(), holds);
  };
  const auto centerOfOne = [&](const Unseen& one) { return centerOf(*cloud.now, one.cell); };
  const bool is_seen_in_part = any([](const Unseen& one) { return one.is_beside; });
  const bool is_left_behind = !any([](const Unseen& one) { return one.was_seen || one.was_alone; });
  const bool has_moved =
      !is_seen_in_part && (is_left_behind || any([&](const Unseen& one) {
                             return anyWithin(cloud.now, centerOfOne(one), reach_);
                           }));
  if (has_moved) return;
  for (const Unseen& one : obstacle) {
    if (one.is_hidden) remembered_.push_back({one.cell, !is_seen_in_part});
  }
  if (is_seen_in_part) return;
  const auto nb_hidden = std::count_if(obstacle.begin(), obstacle.end(),
                                       [](const Unseen& one) { return one.is_hidden; });
  const bool was_alone = any([](const Unseen& one) { return one.was_alone; });
  const bool was_seen_before =
      any([&](const Unseen& one) { return anyWithin(earlier_, centerOfOne(one), reach_); });
  if (2 * nb_hidden > static_cast<std::ptrdiff_t>(obstacle.size())) {  // behind something
    if (was_alone || !was_seen_before || hidden_.size() == MOST_PLACES) return;
    if (const auto place = placeOf(obstacle, cloud)) hidden_.push_back(*place);
    return;
  }
  const bool is_no_noise = was_alone || was_seen_before;
  if (is_no_noise) addVanished(obstacle, cloud);
}

std::optional<OccludedObstacles::Vanished> OccludedObstacles::placeOf(
    const std::vector<Unseen>& obstacle, const Cloud& cloud) const {
  SelfFilter::Nearest nearest;
  Vector3d place;
  for (std::size_t i = 0; i < std::min(obstacle.size(), MOST_PLACES); ++i) {
    const Vector3d center = centerOf(*cloud.now, obstacle[i].cell);
    const SelfFilter::Nearest found = cloud.near.nearest(center);
    const bool is_nearer = nearest.name.empty() || found.distance < nearest.distance;
    if (found.name.empty() || !is_nearer) continue;
    nearest = found;
    place = center;
  }
  if (nearest.name.empty()) return std::nullopt;
  const Eigen::Isometry3d X_BW = cloud.robot.X_WB[nearest.body].inverse(Eigen::Isometry);
  return Vanished{place,        X_BW * place,     cloud.near.bodies()[nearest.body].link,
                  nearest.name, nearest.distance, aboutPlace(place, cloud)};
}

OccludedObstacles::Voxels OccludedObstacles::aboutPlace(const Vector3d& p_W,
                                                        const Cloud& cloud) const {
  std::vector<VoxelCell> cells;
  cloud.now->forEachWithin({p_W, p_W}, FOUND_AGAIN + reach_,
                           [&](const VoxelCell& cell) { cells.push_back(cell); });
  return std::make_shared<const OccupiedVoxels>(cloud.now->voxelSize(), cells);
}

void OccludedObstacles::addVanished(const std::vector<Unseen>& obstacle, const Cloud& cloud) {
  for (std::size_t i = 0; i < std::min(obstacle.size(), MOST_PLACES); ++i) {
    const Vector3d center = centerOf(*cloud.now, obstacle[i].cell);
    if (cloud.isLeftOut(center)) return;  // seen, but not to be an obstacle
  }
  const auto place = placeOf(obstacle, cloud);
  if (place && vanished_.size() < MOST_PLACES) vanished_.push_back(*place);
}

/// The robot may carry what touches it.
Vector3d OccludedObstacles::placeOnLink(const Vanished& one, const Cloud& cloud) {
  const auto& bodies = cloud.near.bodies();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].link == one.link_of_body) return cloud.robot.X_WB[i] * one.p_B;
  }
  return one.p_W;
}

void OccludedObstacles::findWhatAppeared(const Cloud& cloud) {
  const auto find = [&](Vanished& one) {
    one.appeared.reset();
    if (cloud.shows_more) {
      one.around = aboutPlace(one.p_W, cloud);
      return;
    }
    for (const Vector3d& place : {one.p_W, placeOnLink(one, cloud)}) {
      cloud.now->forEachWithin({place, place}, FOUND_AGAIN, [&](const VoxelCell& cell) {
        if (one.appeared) return;
        const Vector3d center = centerOf(*cloud.now, cell);
        const bool is_around = (center - one.p_W).norm() < FOUND_AGAIN;
        if (!anyWithin(is_around ? one.around : before_, center, reach_)) one.appeared = center;
      });
    }
  };
  std::for_each(vanished_.begin(), vanished_.end(), find);
  std::for_each(hidden_.begin(), hidden_.end(), find);
}

std::vector<VoxelCell> OccludedObstacles::hidden() const {
  std::vector<VoxelCell> cells;
  for (const Remembered& one : remembered_) cells.push_back(one.cell);
  return cells;
}

Aabb OccludedObstacles::missed() const {
  Aabb box = noBox();
  for (const auto* missed : {&vanished_, &hidden_}) {
    for (const Vanished& one : *missed) box = enclosing(box, {one.p_W, one.p_W});
  }
  return box;
}

std::string OccludedObstacles::mayTouch() const {
  const Vanished* nearest = nullptr;
  const char* what = "";
  const auto take = [&](const Vanished& one, const char* is) {
    if (nearest && nearest->distance <= one.distance) return;
    nearest = &one;
    what = is;
  };
  for (const Vanished& one : vanished_) take(one, "vanished ");
  for (const Vanished& one : hidden_) {
    if (!one.is_in_contact) take(one, "hidden ");
  }
  if (!nearest) return "";
  const long centimetres = std::lround(100.0 * std::max(nearest->distance, 0.0));
  return what + std::to_string(centimetres) + " cm from " + nearest->link + ": it may touch";
}

void OccludedObstacles::clear() {
  before_ = earlier_ = nullptr;
  remembered_.clear();
  hidden_.clear();
  vanished_.clear();
}

}  // namespace collision_pairs
