#include "collision_pairs/collision_detector.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>

#include "collision_pairs/input_error.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double INF = std::numeric_limits<double>::infinity();

/// Adds the time since it was made, or since its last split(), to one stage.
class StageClock {
 public:
  void split(double& stage) {
    const auto now = std::chrono::steady_clock::now();
    stage += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// Another pair of elements of the same two models.
void mergeInto(PairReport& pair, const PairReport& other) {
  const auto weight = [](PairState state) {
    return state == PairState::CONTACT ? 2 : state == PairState::UNRESOLVED ? 1 : 0;
  };
  if (weight(other.state) > weight(pair.state)) pair.state = other.state;
  ++pair.nb_contacts;
  if (other.distance >= pair.distance) return;
  pair.distance = other.distance;
  pair.certainty = other.certainty;
  pair.fidelity = other.fidelity;
}

Aabb noBox() { return {Vector3d::Constant(INF), Vector3d::Constant(-INF)}; }

}  // namespace

CollisionDetector::CollisionDetector(std::shared_ptr<const CollisionScene> scene)
    : scene_(std::move(scene)) {}

void CollisionDetector::setScene(std::shared_ptr<const CollisionScene> scene) {
  scene_ = std::move(scene);
}

void CollisionDetector::reset() { *this = CollisionDetector(std::move(scene_)); }

const CollisionReport& CollisionDetector::detect(const BodyPoses& poses,
                                                 const CheckSettings& settings) {
  checkInput(poses, settings);
  settings_ = settings;
  only_added_pairs_ = false;
  return run(poses);
}

void CollisionDetector::beginNarrowPhase(const BodyPoses& poses, const CheckSettings& settings) {
  checkInput(poses, settings);
  settings_ = settings;
  begun_poses_ = poses;
  added_pairs_.clear();
  only_added_pairs_ = true;
}

void CollisionDetector::addCollisionPair(std::uint32_t model_a, std::uint32_t model_b) {
  added_pairs_.push_back(std::minmax(model_a, model_b));
}

const CollisionReport& CollisionDetector::endNarrowPhase() {
  std::sort(added_pairs_.begin(), added_pairs_.end());
  return run(begun_poses_);
}

void CollisionDetector::checkInput(const BodyPoses& poses, const CheckSettings& settings) const {
  if (!(settings.alarm_distance >= 0.0)) {
    throw InputError("the alarm distance is " + std::to_string(settings.alarm_distance) +
                     ", but must be 0 or more metres");
  }
  const std::size_t expected = scene_->bodies().size();
  if (poses.X_WB.size() != expected || poses.known.size() != expected) {
    throw InputError("poses of " + std::to_string(poses.X_WB.size()) +
                     " bodies were given, but the scene has " + std::to_string(expected));
  }
}

const CollisionReport& CollisionDetector::run(const BodyPoses& poses) {
  StageClock clock, whole;
  report_.times = {};
  rebuildBoxes(poses);  // tight boxes of every element at its pose
  clock.split(report_.times.boxes);
  sweep(settings_.alarm_distance, report_.candidates);  // axis, sort, sweep
  clock.split(report_.times.broad_phase);
  runNarrowPhase(poses);  // contacts and near pairs among the candidates
  if (settings_.min_distance) searchMinimum(poses);
  clock.split(report_.times.narrow_phase);
  assembleReport();  // one entry for each pair of models
  whole.split(report_.times.total);
  return report_;
}

void CollisionDetector::rebuildBoxes(const BodyPoses& poses) {
  const auto& elements = scene_->elements();
  report_.boxes.resize(elements.size());
  report_.left_out.clear();
  report_.nb_boxes = scene_->nbStaticElements();
  for (std::uint32_t i = 0; i < scene_->nbStaticElements(); ++i) {
    report_.boxes[i] = scene_->staticBoxes().box(i);
  }
  for (std::size_t i = scene_->nbStaticElements(); i < elements.size(); ++i) {
    const SceneElement& element = elements[i];
    report_.boxes[i] =
        poses.known[element.body] ? element.boxAt(poses.X_WB[element.body]) : noBox();
    if (report_.boxes[i].valid()) {
      ++report_.nb_boxes;
    } else if (report_.left_out.empty() || report_.left_out.back() != element.model) {
      report_.left_out.push_back(element.model);
    }
  }
}

void CollisionDetector::sweep(double reach, std::vector<BoxPair>& candidates) {
  const auto& elements = scene_->elements();
  sweep_.begin(reach, &scene_->staticBoxes(), &scene_->filter());
  for (std::size_t i = scene_->nbStaticElements(); i < elements.size(); ++i) {
    sweep_.add(report_.boxes[i], elements[i].model);
  }
  candidates = sweep_.end();
  if (!only_added_pairs_) return;
  const auto was_not_added = [&](const BoxPair& pair) {
    const BoxPair ab = byModel(pair);
    return !std::binary_search(added_pairs_.begin(), added_pairs_.end(),
                               std::make_pair(elements[ab.first].model, elements[ab.second].model));
  };
  candidates.erase(std::remove_if(candidates.begin(), candidates.end(), was_not_added),
                   candidates.end());
}

void CollisionDetector::runNarrowPhase(const BodyPoses& poses) {
  found_.clear();
  found_contacts_.clear();
  report_.nb_degraded = 0;
  for (const BoxPair& candidate : report_.candidates) {
    const BoxPair pair = byModel(candidate);
    const PairDistance found = measure(pair, poses, settings_.alarm_distance);
    if (found.certainty == Certainty::DEGRADED) ++report_.nb_degraded;
    if (found.distance <= settings_.alarm_distance && found.certainty != Certainty::BEYOND) {
      record(pair, found);
    }
  }
}

BoxPair CollisionDetector::byModel(const BoxPair& pair) const {
  const auto& elements = scene_->elements();
  return elements[pair.first].model < elements[pair.second].model
             ? pair
             : BoxPair{pair.second, pair.first};
}

PairDistance CollisionDetector::measure(const BoxPair& pair, const BodyPoses& poses,
                                        double max_distance) {
  if (settings_.fidelity == Fidelity::AABB) return measureBoxes(pair);
  const auto pose = [&](const SceneElement& element, const Rung& rung) {
    return element.body < 0 ? rung.X_BE : poses.X_WB[element.body] * rung.X_BE;
  };
  const SceneElement& first = scene_->elements()[pair.first];
  const SceneElement& second = scene_->elements()[pair.second];
  const Rung& a = first.rung(settings_.fidelity);
  const Rung& b = second.rung(settings_.fidelity);
  const Isometry3d X_WA = pose(first, a);
  // Relative first: far from the origin the difference is exact where the poses are not.
  const Isometry3d X_AB = X_WA.inverse() * pose(second, b);
  const double margin = a.margin + b.margin;
  PairDistance found = narrow_phase_.distance(*a.shape, *b.shape, X_AB, max_distance + margin);
  found.distance -= margin;
  found.p_ACa = X_WA * found.p_ACa;
  found.p_ACb = X_WA * found.p_ACb;
  found.nhat_AB_A = X_WA.linear() * found.nhat_AB_A;
  // The tight axis-aligned box need not enclose the turned one. Both enclose the element, so the
  // better bound of the two counts, and this rung never says less than the one below.
  const bool boxes_say_more =
      settings_.fidelity == Fidelity::OBB &&
      squaredGap(report_.boxes[pair.first], report_.boxes[pair.second]) >
          std::max(found.distance, 0.0) * std::max(found.distance, 0.0);
  return boxes_say_more ? measureBoxes(pair) : found;
}

PairDistance CollisionDetector::measureBoxes(const BoxPair& pair) const {
  const Aabb& a = report_.boxes[pair.first];
  const Aabb& b = report_.boxes[pair.second];
  const Vector3d gap = (b.min - a.max).cwiseMax(a.min - b.max);
  PairDistance found;
  int axis = 0;
  const double widest = gap.maxCoeff(&axis);
  // Witness points: the nearest points of the two boxes, mid-way where they overlap.
  const Vector3d lower = a.min.cwiseMax(b.min), upper = a.max.cwiseMin(b.max);
  const Vector3d middle = 0.5 * (lower + upper);
  found.p_ACa = middle.cwiseMax(a.min).cwiseMin(a.max);
  found.p_ACb = middle.cwiseMax(b.min).cwiseMin(b.max);
  const bool b_is_above = a.center()[axis] <= b.center()[axis];
  if (widest > 0.0) {
    found.distance = std::sqrt(squaredGap(a, b));
    found.nhat_AB_A = (found.p_ACb - found.p_ACa) / found.distance;
  } else {  // the least translation along an axis that takes them apart
    const double sign = b_is_above ? 1.0 : -1.0;
    found.distance = widest;
    found.nhat_AB_A = sign * Vector3d::Unit(axis);
    found.p_ACa[axis] = b_is_above ? a.max[axis] : a.min[axis];
    found.p_ACb[axis] = b_is_above ? b.min[axis] : b.max[axis];
  }
  return found;
}

void CollisionDetector::record(const BoxPair& pair, const PairDistance& found) {
  const auto& elements = scene_->elements();
  PairReport entry;
  entry.first = elements[pair.first].model;
  entry.second = elements[pair.second].model;
  entry.state = !found.touches()                         ? PairState::NEAR
                : found.certainty == Certainty::DEGRADED ? PairState::UNRESOLVED
                                                         : PairState::CONTACT;
  entry.distance = found.distance;
  entry.fidelity = settings_.fidelity;
  entry.certainty = found.certainty;
  entry.first_contact = 0;
  entry.nb_contacts = 1;
  found_.push_back(entry);
  found_contacts_.push_back({found.p_ACa, found.p_ACb, found.nhat_AB_A, -found.distance, pair});
}

// The sweep at a reach that grows until it holds the nearest pair: what it does not hold is
// further than the reach. Pairs are taken by the gap of their boxes, so that most end at once.
void CollisionDetector::searchMinimum(const BodyPoses& poses) {
  double best = INF;
  for (const PairReport& entry : found_) best = std::min(best, entry.distance);
  Aabb all = noBox();
  for (const Aabb& box : report_.boxes) {
    if (!box.valid()) continue;
    all.min = all.min.cwiseMin(box.min);
    all.max = all.max.cwiseMax(box.max);
  }
  const double extent = (all.max - all.min).norm();
  double swept = settings_.alarm_distance;  // nothing nearer than this is still unknown
  for (double reach = std::max(2.0 * swept, extent / 64.0); best > swept && swept <= extent;
       reach = std::max(4.0 * reach, std::numeric_limits<double>::min())) {
    sweep(reach, reached_);
    swept = reach;
    by_gap_.clear();
    for (const BoxPair& pair : reached_) {
      by_gap_.emplace_back(squaredGap(report_.boxes[pair.first], report_.boxes[pair.second]), pair);
    }
    std::sort(by_gap_.begin(), by_gap_.end());
    for (const auto& [squared_gap, pair] : by_gap_) {
      if (squared_gap > std::max(best, 0.0) * best) break;
      best = std::min(best, measure(byModel(pair), poses, best).distance);
    }
  }
  report_.min_distance = best;
  report_.min_distance_is_bound = best == INF;
}

void CollisionDetector::assembleReport() {
  order_.resize(found_.size());
  std::iota(order_.begin(), order_.end(), 0u);
  const auto key = [&](std::uint32_t i) {
    return std::make_tuple(found_[i].first, found_[i].second, found_contacts_[i].elements.first,
                           found_contacts_[i].elements.second);
  };
  std::sort(order_.begin(), order_.end(),
            [&](std::uint32_t i, std::uint32_t j) { return key(i) < key(j); });
  report_.pairs.clear();
  report_.contacts.clear();
  for (const std::uint32_t i : order_) {
    const PairReport& found = found_[i];
    auto& pairs = report_.pairs;
    if (pairs.empty() || pairs.back().first != found.first || pairs.back().second != found.second) {
      pairs.push_back(found);
      pairs.back().first_contact = static_cast<std::uint32_t>(report_.contacts.size());
    } else {
      mergeInto(pairs.back(), found);
    }
    report_.contacts.push_back(found_contacts_[i]);
  }
  report_.in_collision = false;
  if (!settings_.min_distance) {
    report_.min_distance = settings_.alarm_distance;
    report_.min_distance_is_bound = true;
  }
  for (const PairReport& pair : report_.pairs) {
    report_.in_collision |= pair.state != PairState::NEAR;
    if (pair.distance > report_.min_distance) continue;
    report_.min_distance = pair.distance;
    report_.min_distance_is_bound = false;
  }
}

}  // namespace collision_pairs
