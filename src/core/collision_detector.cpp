#include "collision_pairs/collision_detector.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>

#include "collision_pairs/input_error.h"
#include "pair_ladder.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double INF = std::numeric_limits<double>::infinity();
constexpr double MAX_REACH = 1e150;  // metres: the square of what is swept must be finite

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
    : scene_(std::move(scene)), ladder_(std::make_unique<PairLadder>()) {}

CollisionDetector::~CollisionDetector() = default;
CollisionDetector::CollisionDetector(CollisionDetector&&) noexcept = default;
CollisionDetector& CollisionDetector::operator=(CollisionDetector&&) noexcept = default;

void CollisionDetector::setScene(std::shared_ptr<const CollisionScene> scene) {
  scene_ = std::move(scene);
  X_WE_.clear();
}

void CollisionDetector::reset() { *this = CollisionDetector(std::move(scene_)); }

const CollisionReport& CollisionDetector::detect(const BodyPoses& poses,
                                                 const CheckSettings& settings) {
  checkInput(poses, settings);
  settings_ = settings;
  if (settings.verdict_only) settings_.alarm_distance = 0.0;
  only_added_pairs_ = false;
  return run(poses);
}

void CollisionDetector::beginNarrowPhase(const BodyPoses& poses, const CheckSettings& settings) {
  checkInput(poses, settings);
  settings_ = settings;
  if (settings.verdict_only) settings_.alarm_distance = 0.0;
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
  if (!(settings.alarm_distance >= 0.0 && settings.alarm_distance <= MAX_REACH)) {
    throw InputError("the alarm distance is " + std::to_string(settings.alarm_distance) +
                     ", but must be 0 or more metres, and finite");
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
  found_.clear();
  found_contacts_.clear();
  ladder_->begin(*scene_, X_WE_, report_.boxes);
  if (settings_.verdict_only) {
    findFirstContact();
  } else {
    measureCandidates();  // contacts and near pairs among the candidates
  }
  if (settings_.min_distance) searchMinimum();
  clock.split(report_.times.narrow_phase);
  assembleReport();  // one entry for each pair of models
  whole.split(report_.times.total);
  return report_;
}

void CollisionDetector::rebuildBoxes(const BodyPoses& poses) {
  const auto& elements = scene_->elements();
  if (X_WE_.size() != elements.size()) prepareStaticElements();
  report_.left_out.clear();
  report_.nb_boxes = scene_->nbStaticElements();
  for (std::size_t i = scene_->nbStaticElements(); i < elements.size(); ++i) {
    const SceneElement& element = elements[i];
    X_WE_[i] = poses.X_WB[element.body] * element.X_BE;
    report_.boxes[i] = poses.known[element.body] ? element.boxAt(X_WE_[i]) : noBox();
    if (report_.boxes[i].valid()) {
      ++report_.nb_boxes;
    } else if (report_.left_out.empty() || report_.left_out.back() != element.model) {
      report_.left_out.push_back(element.model);
    }
  }
}

void CollisionDetector::prepareStaticElements() {
  const auto& elements = scene_->elements();
  X_WE_.resize(elements.size());
  report_.boxes.resize(elements.size());
  for (std::uint32_t i = 0; i < scene_->nbStaticElements(); ++i) {
    X_WE_[i] = elements[i].X_BE;
    report_.boxes[i] = scene_->staticBoxes().box(i);
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

void CollisionDetector::findFirstContact() {
  report_.nb_degraded = 0;
  report_.nb_settled = {};
  for (const BoxPair& candidate : report_.candidates) {
    const BoxPair pair = byModel(candidate);
    if (!ladder_->touches(pair, settings_.fidelity)) continue;
    PairDistance contact;
    contact.distance = 0.0;
    contact.certainty = Certainty::BOUND;
    record(pair, contact, settings_.fidelity);
    found_.back().nb_contacts = 0;
    return;
  }
}

void CollisionDetector::measureCandidates() {
  report_.nb_degraded = 0;
  report_.nb_settled = {};
  for (const BoxPair& candidate : report_.candidates) {
    const BoxPair pair = byModel(candidate);
    const auto [found, rung] = ladder_->climb(pair, settings_.fidelity, settings_.alarm_distance);
    ++report_.nb_settled[static_cast<int>(rung)];
    if (found.certainty == Certainty::DEGRADED) ++report_.nb_degraded;
    if (found.distance <= settings_.alarm_distance && found.certainty != Certainty::BEYOND) {
      record(pair, found, rung);
    }
  }
}

BoxPair CollisionDetector::byModel(const BoxPair& pair) const {
  const auto& elements = scene_->elements();
  return elements[pair.first].model < elements[pair.second].model
             ? pair
             : BoxPair{pair.second, pair.first};
}

void CollisionDetector::record(const BoxPair& pair, const PairDistance& found, Fidelity rung) {
  const auto& elements = scene_->elements();
  PairReport entry;
  entry.first = elements[pair.first].model;
  entry.second = elements[pair.second].model;
  entry.state = !found.touches()                         ? PairState::NEAR
                : found.certainty == Certainty::DEGRADED ? PairState::UNRESOLVED
                                                         : PairState::CONTACT;
  entry.distance = found.distance;
  entry.fidelity = rung;
  entry.certainty = found.certainty;
  entry.first_contact = 0;
  entry.nb_contacts = 1;
  found_.push_back(entry);
  found_contacts_.push_back({found.p_ACa, found.p_ACb, found.nhat_AB_A, -found.distance, pair});
}

// The sweep at a reach that grows until it holds the nearest pair: what it does not hold is
// further than the reach. Pairs are taken by the gap of their boxes, so that most end at once.
void CollisionDetector::searchMinimum() {
  double best = INF;
  for (const PairReport& entry : found_) best = std::min(best, entry.distance);
  Aabb all = noBox();
  for (const Aabb& box : report_.boxes) {
    if (!box.valid()) continue;
    all.min = all.min.cwiseMin(box.min);
    all.max = all.max.cwiseMax(box.max);
  }
  // The empty scene and half-spaces have none that is finite.
  const double extent = all.valid() ? std::min((all.max - all.min).norm(), MAX_REACH) : 0.0;
  double swept = settings_.alarm_distance;  // nothing nearer than this is still unknown
  for (double reach = std::max(2.0 * swept, extent / 64.0); best > swept && swept < extent;
       reach = std::min(std::max(4.0 * reach, 1e-300), MAX_REACH)) {
    sweep(reach, reached_);
    swept = reach;
    measureNearestFirst(reached_, best);
  }
  report_.min_distance = best;
  report_.min_distance_is_bound = best == INF;
}

void CollisionDetector::measureNearestFirst(const std::vector<BoxPair>& pairs, double& best) {
  by_gap_.clear();
  for (const BoxPair& pair : pairs) {
    by_gap_.emplace_back(squaredGap(report_.boxes[pair.first], report_.boxes[pair.second]), pair);
  }
  std::sort(by_gap_.begin(), by_gap_.end());
  for (const auto& [squared_gap, pair] : by_gap_) {
    if (squared_gap > std::max(best, 0.0) * best) break;
    best = std::min(best, ladder_->climb(byModel(pair), settings_.fidelity, best).found.distance);
  }
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
