#include "limiter_judge.h"

#include <algorithm>
#include <limits>

namespace collision_pairs {
namespace {

using Eigen::Vector3d;

constexpr double ALARM = 0.02;   // m
constexpr double NEARER = 1e-8;  // m: a change that counts
// Metres: what is nearer than the first is looked at each time; smallest distances are exact below
// the second.
constexpr double LEAST = 0.001, EXACT = 0.015;

double distanceOf(const std::map<std::pair<std::uint32_t, std::uint32_t>, double>& near) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& [pair, distance] : near) nearest = std::min(nearest, distance);
  return nearest;
}

}  // namespace

void RobotsPart::add(const RobotsPart& other) {
  nb_contacts += other.nb_contacts;
  nb_run_into += other.nb_run_into;
  nb_moved_into += other.nb_moved_into;
  nearest = std::min(nearest, other.nearest);
  nearest_links = std::min(nearest_links, other.nearest_links);
  taken = std::max(taken, other.taken);
}

LimiterJudge::LimiterJudge(std::shared_ptr<const CollisionScene> truth,
                           std::vector<std::string> joints)
    : truth_(std::move(truth)), joints_(std::move(joints)), detector_(truth_) {}

void LimiterJudge::begin() {
  taken_.clear();
  were_.clear();
  room_ = 0.0;
}

double LimiterJudge::distanceAt(const std::vector<double>& q, const Vector3d& mover,
                                double alarm_distance) {
  return distanceOf(nearPairs(q, mover, alarm_distance));
}

bool LimiterJudge::isOfMover(std::uint32_t model) const {
  return truth_->models()[model].name.rfind(std::string(MOVER) + "/", 0) == 0;
}

bool LimiterJudge::isMoved(const PairReport& pair) const {
  const auto& bodies = truth_->robot().bodies();
  const auto bodyOf = [&](std::uint32_t model) {
    const int body = truth_->models()[model].body;
    return body < 0 ? -1 : truth_->bodies()[body].body;
  };
  int first = bodyOf(pair.first), second = bodyOf(pair.second);
  while (first != second) {
    int& later = first > second ? first : second;
    const int joint = bodies[later].joint;
    if (joint >= 0) {
      const std::string& name = truth_->robot().joints()[joint].name;
      if (std::find(joints_.begin(), joints_.end(), name) != joints_.end()) return true;
    }
    later = bodies[later].parent;
  }
  return false;
}

bool LimiterJudge::areLinks(const std::pair<std::uint32_t, std::uint32_t>& models) const {
  const auto& bodies = truth_->robot().bodies();
  const auto firstMoved = [&](std::uint32_t id) {
    const CollisionModel& model = truth_->models()[id];
    int first = -1;
    if (model.is_object || model.body < 0) return first;
    for (int body = truth_->bodies()[model.body].body; bodies[body].parent >= 0;
         body = bodies[body].parent) {
      first = body;
    }
    return first;
  };
  const int first = firstMoved(models.first);
  return first >= 0 && first == firstMoved(models.second);
}

LimiterJudge::Near LimiterJudge::nearPairs(const std::vector<double>& q, const Vector3d& mover,
                                           double alarm_distance) {
  std::vector<double> all = truth_->robot().zeroPositions();
  for (std::size_t i = 0; i < q.size(); ++i) all[truth_->robot().findJoint(joints_[i])] = q[i];
  for (int i = 0; i < 3; ++i) {
    const int id = truth_->robot().findJoint(std::string(MOVER) + "/" + "xyz"[i]);
    if (id >= 0) all[id] = mover[i];
  }
  truth_->robot().applyMimics(all);
  truth_->robot().forwardKinematics(all, X_WB_);
  truth_->gatherPoses(X_WB_, poses_);
  CheckSettings settings;
  settings.alarm_distance = alarm_distance;
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> near;
  for (const PairReport& pair : detector_.detect(poses_, settings).pairs) {
    if (isMoved(pair)) near[{pair.first, pair.second}] = pair.distance;
  }
  return near;
}

bool LimiterJudge::judge(const std::vector<double>& before, const std::vector<double>& now,
                         const Vector3d& mover, double stop_distance, RobotsPart& part) {
  const Near near = nearPairs(now, mover, ALARM);
  const auto isMovers = [&](const auto& of) {
    return isOfMover(of.first.first) || isOfMover(of.first.second);
  };
  // Only what moves by itself has to be asked again where it is now.
  const bool is_mover_near = std::any_of(near.begin(), near.end(), isMovers);
  const Near was = before == now   ? near
                   : is_mover_near ? nearPairs(before, mover, ALARM + 0.05)
                                   : were_;
  const auto isFar = [&](const auto& pair) {
    const auto found = near.find(pair);
    return found == near.end() || found->second >= stop_distance;
  };
  for (auto it = taken_.begin(); it != taken_.end();) {
    it = isFar(it->first) ? taken_.erase(it) : std::next(it);
  }
  for (const auto& [pair, distance] : near) {
    const auto found = was.find(pair);
    const double nearer = (found == was.end() ? ALARM + 0.05 : found->second) - distance;
    const auto at_last_check = were_.find(pair);
    const bool begins =
        distance <= 0.0 && (at_last_check == were_.end() || at_last_check->second > 0.0);
    if (!isOfMover(pair.first) && !isOfMover(pair.second)) {
      double& nearest = areLinks(pair) ? part.nearest_links : part.nearest;
      if (nearer > NEARER) nearest = std::min(nearest, distance);
      part.nb_contacts += begins ? 1 : 0;
      continue;
    }
    if (distance >= stop_distance) continue;
    // In contact, the depth of a mesh is a bound, which is centimetres as soon as it touches.
    const double was_apart = std::max(distance + nearer, 0.0);
    double& taken = taken_[pair];
    taken = std::max(taken + was_apart - std::max(distance, 0.0), 0.0);
    part.taken = std::max(part.taken, taken);
    if (!begins) continue;
    ++(taken > 0.5 * stop_distance ? part.nb_contacts : part.nb_run_into);
    part.nb_moved_into += was_apart > 0.0 ? 1 : 0;
  }
  were_ = near;
  const double links = std::clamp(part.nearest_links, LEAST, EXACT);
  const double others = std::clamp(part.nearest, LEAST, EXACT);
  room_ = ALARM - std::max(links, others);
  for (const auto& [pair, distance] : near) {
    room_ = std::min(room_, distance - (areLinks(pair) ? links : others));
  }
  return distanceOf(near) <= 0.0;
}

}  // namespace collision_pairs
