#include "collision_pairs/collision_detector.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "anytime_query.h"
#include "check_input.h"
#include "collision_pairs/input_error.h"
#include "element_boxes.h"
#include "found_pairs.h"
#include "ignored_pairs.h"
#include "pair_ladder.h"
#include "scene_element.h"
#include "voxel_search.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr std::ptrdiff_t MOST_LISTED = 160;  // SweepAndPrune uses no more
const char* const CHECK_DID_NOT_END = "the check was ended by an exception";

/// split() adds the time since construction, or since the last split(), to one stage; nothing
/// unless `wanted`.
class StageClock {
 public:
  explicit StageClock(bool wanted) : wanted_(wanted) {
    if (wanted) last_ = std::chrono::steady_clock::now();
  }

  void split(double& stage) {
    if (!wanted_) return;
    const auto now = std::chrono::steady_clock::now();
    stage += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }

 private:
  bool wanted_;
  std::chrono::steady_clock::time_point last_;
};

double steadySeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

CollisionDetector::CollisionDetector(std::shared_ptr<const CollisionScene> scene)
    : scene_(std::move(scene)),
      boxes_(std::make_unique<ElementBoxes>()),
      ladder_(std::make_unique<PairLadder>()),
      anytime_query_(std::make_unique<AnytimeQuery>()),
      voxel_search_(std::make_unique<VoxelSearch>()),
      found_(std::make_unique<FoundPairs>()),
      ignored_(std::make_unique<IgnoredPairs>()),
      clock_(&steadySeconds) {
  boxes_->prepare(*scene_);
  const auto& models = boxes_->models();
  const auto begin = models.begin() + scene_->nbStaticElements();
  const auto end = models.begin() + scene_->endOfMovingElements();
  if (end - begin <= MOST_LISTED) {
    allowed_.emplace(std::vector<std::uint32_t>(begin, end), scene_->filter());
  }
}

CollisionDetector::~CollisionDetector() = default;
CollisionDetector::CollisionDetector(CollisionDetector&&) noexcept = default;
CollisionDetector& CollisionDetector::operator=(CollisionDetector&&) noexcept = default;

void CollisionDetector::setClock(std::function<double()> clock) { clock_ = std::move(clock); }

const CollisionReport& CollisionDetector::detect(const BodyPoses& poses,
                                                 const CheckSettings& settings) {
  begin(poses, settings);
  return run(poses);
}

// What is found stays that of a check that did not end, should anything throw.
void CollisionDetector::begin(const BodyPoses& poses, const CheckSettings& settings) {
  only_added_pairs_ = false;
  report_.verdict = Verdict::UNKNOWN;
  report_.in_collision = true;
  report_.unknown_because = {CHECK_DID_NOT_END};
  report_.pairs.clear();
  report_.contacts.clear();
  report_.nearest.reset();
  report_.min_distance = 0.0;
  report_.min_distance_is_bound = true;
  checkInput(*scene_, poses, settings);
  settings_ = settings;
  if (settings.verdict_only) settings_.alarm_distance = 0.0;
}

void CollisionDetector::beginNarrowPhase(const BodyPoses& poses, const CheckSettings& settings) {
  begin(poses, settings);
  begun_poses_ = poses;
  added_pairs_.clear();
  only_added_pairs_ = true;
}

void CollisionDetector::addCollisionPair(std::uint32_t model_a, std::uint32_t model_b) {
  const std::size_t nb_models = scene_->models().size();
  if (std::max(model_a, model_b) >= nb_models) {
    throw InputError("models " + std::to_string(model_a) + " and " + std::to_string(model_b) +
                     " were added, but the scene has " + std::to_string(nb_models));
  }
  added_pairs_.push_back(std::minmax(model_a, model_b));
}

const CollisionReport& CollisionDetector::endNarrowPhase() {
  if (!only_added_pairs_) throw InputError("endNarrowPhase() without beginNarrowPhase()");
  std::sort(added_pairs_.begin(), added_pairs_.end());
  run(begun_poses_);
  only_added_pairs_ = false;
  return report_;
}

const CollisionReport& CollisionDetector::run(const BodyPoses& poses) {
  StageClock clock(settings_.stage_times), whole(settings_.stage_times);
  const Deadline deadline(clock_, settings_.time_budget);
  beginPairs();
  rebuildBoxes(poses);  // of every element at its pose; loose if tight ones cost more
  if (!scene_->clouds().empty()) takeVoxels(poses);
  clock.split(report_.times.boxes);
  sweep(settings_.alarm_distance, report_.candidates);        // axis, sort, sweep
  const bool are_loose = mayEndEarly() && !deadline.isSet();  // tightened one by one
  if (!are_loose || settings_.list_boxes) dropLooseAndIgnored();
  if (!scene_->clouds().empty()) findCloudPairs();
  clock.split(report_.times.broad_phase);
  if (deadline.isSet()) {
    measureInTime(deadline);  // the nearest candidates first
  } else {
    measureCandidates(are_loose);  // contacts and near pairs among the candidates
  }
  if (!cloud_pairs_.empty()) measureClouds(deadline);
  if (settings_.min_distance && !report_.ended_early) searchMinimum(deadline);
  listBoxes();
  report_.nb_answered_natively = ladder_->numAnsweredNatively();
  clock.split(report_.times.narrow_phase);
  if (ignored_->isAsking()) report_.ignored = ignored_->list();
  const bool has_pairs = noteUnchecked();
  // One per pair of models.
  found_->assemble(*scene_, has_pairs, !settings_.verdict_only, poses.unknown_because, report_);
  whole.split(report_.times.total);
  return report_;
}

void CollisionDetector::beginPairs() {
  found_->clear();
  ignored_->begin(settings_.may_ignore, settings_.ignore_revision);
  report_.ignored.clear();
  report_.times = {};
  report_.nb_degraded = 0;
  report_.narrow_phase = scene_->narrowPhase();
  report_.tolerance = settings_.tolerance;
  report_.nb_unresolved = 0;
  report_.nb_settled = {};
  report_.budget_spent = false;
  report_.min_distance = settings_.alarm_distance;
  report_.ended_early = false;
  nb_contacts_ = 0;
  if (settings_.fidelity == Fidelity::SPHERES && !std::exchange(has_spheres_, true)) {
    // Links with spheres only by ~link_fidelity get theirs when a pair first needs them.
    makeSpheres(scene_->elements());
  }
  ladder_->begin(*scene_, boxes_->X_WE(), boxes_->boxes());
  voxel_search_->begin(*scene_, boxes_->X_WE(), boxes_->boxes(), *ladder_);
}

void CollisionDetector::rebuildBoxes(const BodyPoses& poses) {
  some_are_loose_ = !settings_.list_boxes && scene_->clouds().empty();
  report_.nb_boxes = scene_->nbStaticElements();
  report_.nb_boxes += boxes_->rebuild(poses, !some_are_loose_, settings_.selection.get());
  report_.left_out.clear();
  for (const std::uint32_t element : boxes_->withoutBox()) {
    const std::uint32_t model = scene_->elements()[element].model;
    if (report_.left_out.empty() || report_.left_out.back() != model) {
      report_.left_out.push_back(model);
    }
  }
}

// A candidate is a pair of tight boxes, whichever boxes were swept.
void CollisionDetector::dropLooseAndIgnored() {
  if (!some_are_loose_ && !ignored_->isAsking()) return;
  const double squared_reach = squaredReach(settings_.alarm_distance);
  const auto is_none = [&](const BoxPair& pair) {
    return !boxes_->inReach(pair, squared_reach) || isIgnored(pair);
  };
  auto& candidates = report_.candidates;
  candidates.erase(std::remove_if(candidates.begin(), candidates.end(), is_none), candidates.end());
}

bool CollisionDetector::isIgnored(const BoxPair& pair) {
  const auto& elements = scene_->elements();
  return ignored_->has(elements[pair.first].model, elements[pair.second].model);
}

const PairFilter& CollisionDetector::filter() const {
  return settings_.selection ? settings_.selection->filter() : scene_->filter();
}

bool CollisionDetector::noteUnchecked() {
  report_.unchecked = scene_->unchecked();
  if (scene_->models().empty()) return false;
  const char* why = nullptr;
  // Of pairs out of reach, which are not listed: report_.ignored has been taken.
  const auto isKept = [this](std::uint32_t first, std::uint32_t second) {
    return !ignored_->has(first, second);
  };
  if (settings_.selection && settings_.selection->empty()) {
    why = "the selection leaves no pair to check";
  } else if (ignored_->isAsking() && !ignored_->keepsSome() &&
             !hasPair(*scene_, filter(), isKept)) {
    why = "every pair is ignored";
  }
  if (why && report_.unchecked.empty()) report_.unchecked = why;
  return why == nullptr;
}

void CollisionDetector::listBoxes() {
  report_.boxes.clear();
  if (settings_.list_boxes) {
    report_.boxes = boxes_->boxes();
    for (const SceneCloud& cloud : scene_->clouds()) report_.boxes[cloud.element] = noBox();
  } else if (mayEndEarly()) {
    report_.candidates.clear();  // some may be pairs of loose boxes
  }
}

void CollisionDetector::sweep(double reach, std::vector<BoxPair>& candidates) {
  const auto& boxes = boxes_->boxes();
  const auto& models = boxes_->models();
  const bool is_listed = allowed_ && !settings_.selection;
  sweep_.setBroadPhase(settings_.broad_phase);
  sweep_.begin(reach, &scene_->staticBoxes(), &filter(), is_listed ? &*allowed_ : nullptr);
  const std::size_t end = scene_->endOfMovingElements();
  for (std::size_t i = scene_->nbStaticElements(); i < end; ++i) {
    sweep_.add(boxes[i], models[i]);
  }
  candidates = sweep_.end();
  if (!only_added_pairs_) return;
  const auto was_not_added = [&](const BoxPair& pair) { return !isAsked(pair); };
  candidates.erase(std::remove_if(candidates.begin(), candidates.end(), was_not_added),
                   candidates.end());
}

bool CollisionDetector::isAsked(const BoxPair& pair) const {
  if (!only_added_pairs_) return true;
  const auto& elements = scene_->elements();
  const BoxPair ab = ladder_->byModel(pair);
  return std::binary_search(added_pairs_.begin(), added_pairs_.end(),
                            std::make_pair(elements[ab.first].model, elements[ab.second].model));
}

// The pairs whose boxes overlap most come first: they touch most often.
void CollisionDetector::sortByOverlap() {
  by_gap_.clear();
  for (const BoxPair& pair : report_.candidates) {
    if (isIgnored(pair)) continue;  // at less cost than tight boxes
    const Aabb &a = boxes_->boxes()[pair.first], &b = boxes_->boxes()[pair.second];
    const double gap = (a.min.cwiseMax(b.min) - a.max.cwiseMin(b.max)).maxCoeff();
    by_gap_.emplace_back(gap, pair);
  }
  std::sort(by_gap_.begin(), by_gap_.end());
  reached_.clear();
  for (const auto& [gap, pair] : by_gap_) reached_.push_back(pair);
}

// Contact requires that the tight boxes overlap too. For a verdict they are tested last, because
// OBBs or hulls dismiss most pairs of loose boxes at less cost than two tight boxes.
void CollisionDetector::measureCandidates(bool are_loose) {
  const double squared_reach = squaredReach(settings_.alarm_distance);
  if (settings_.verdict_only) sortByOverlap();
  for (const BoxPair& candidate : settings_.verdict_only ? reached_ : report_.candidates) {
    const BoxPair pair = ladder_->byModel(candidate);
    if (are_loose) {
      boxes_->place(pair.first);
      boxes_->place(pair.second);
      const bool by_boxes = ladder_->rungOf(pair, settings_.fidelity) == Fidelity::AABB;
      const bool tight_first = by_boxes || !settings_.verdict_only;
      if (tight_first && !boxes_->inReach(pair, squared_reach)) continue;
      if (!settings_.verdict_only && isIgnored(pair)) continue;
    }
    const auto [found, rung] = settings_.verdict_only
                                   ? ladder_->touches(pair, settings_.fidelity)
                                   : ladder_->refine(pair, settings_.fidelity,
                                                     settings_.alarm_distance, settings_.tolerance);
    const bool is_apart = found.certainty == Certainty::BEYOND;
    if (are_loose && !is_apart && !boxes_->inReach(pair, squared_reach)) continue;
    take(pair, found, rung);
    if (report_.ended_early) return;
  }
}

void CollisionDetector::measureInTime(const Deadline& deadline) {
  anytime_query_->run(report_.candidates, settings_, deadline, *ladder_,
                      [this](const AnytimeQuery::Result& result) {
                        const PairDistance& found = result.answer.found;
                        if (settings_.verdict_only && found.certainty == Certainty::BOUND) {
                          found_->clear();  // a verdict's contact is all that is reported
                          report_.nb_settled = {};
                          report_.nb_degraded = 0;
                        }
                        take(result.pair, found, result.answer.rung);
                        return !report_.ended_early;
                      });
  report_.budget_spent = report_.nb_unresolved > 0;
}

// A verdict ends at tight boxes that are apart by any double; contact has a band. So does this.
void CollisionDetector::endAtBoxes(const BoxPair& pair, PairDistance& found) {
  const bool of_cloud = scene_->cloudOf(pair.first) >= 0 || scene_->cloudOf(pair.second) >= 0;
  if (!found.touches() || found.certainty == Certainty::DEGRADED || of_cloud ||
      boxes_->inReach(pair, squaredReach(0.0))) {
    return;
  }
  const auto& boxes = boxes_->boxes();
  found.distance = std::sqrt(squaredGap(boxes[pair.first], boxes[pair.second]));
  found.certainty = Certainty::DEGRADED;
}

void CollisionDetector::take(const BoxPair& pair, PairDistance found, Fidelity rung,
                             const Eigen::Vector3i& voxel) {
  endAtBoxes(pair, found);
  if (found.certainty == Certainty::UNFINISHED) {
    ++report_.nb_unresolved;
  } else {
    ++report_.nb_settled[static_cast<int>(rung)];
  }
  if (found.certainty == Certainty::DEGRADED) ++report_.nb_degraded;
  if (found.distance > settings_.alarm_distance || found.certainty == Certainty::BEYOND) return;
  const PairState state = found_->add(*scene_, pair, found, rung, voxel);
  if (state == PairState::CONTACT && mayEndEarly()) countContact(contactOf(pair, found, voxel));
}

void CollisionDetector::countContact(const Contact& contact) {
  const bool is_enough =
      settings_.verdict_only || (settings_.is_enough && settings_.is_enough(contact));
  report_.ended_early = is_enough || ++nb_contacts_ == settings_.max_contacts;
}

}  // namespace collision_pairs
