#include "collision_pairs/motion_check.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>

#include "edge_stage.h"
#include "exact_configuration.h"
#include "infinity.h"
#include "motion_pairs.h"
#include "motion_state.h"
#include "open_intervals.h"
#include "pair_certifier.h"
#include "pair_clearances.h"
#include "uncertified_pairs.h"
#include "unknown_because.h"

namespace collision_pairs {
namespace {

// Elements are compared with static ones once their motion is at most the radius of the largest
// one; before that their swept boxes would overlap nearly everything.
constexpr double MOTION_TO_SWEEP = 1.0;
// Relative to the motion and to the size of the largest element: static elements further away than
// the larger of the two are not compared, so this much clearance is certified at no cost.
constexpr double SWEEP_BEYOND_MOTION = 0.25, SWEEP_BEYOND_SIZE = 0.05;

// Limits of a segment: about a second, and 100 MB. Only reached by motions that are millions of
// times longer than the robot, or than the resolution if something is nearly touched.
constexpr std::uint32_t MOST_CHECKS = 300'000;
constexpr std::size_t MOST_OPEN_PAIRS = 1'000'000;

}  // namespace

class MotionCheck::Search {
 public:
  explicit Search(const std::shared_ptr<const CollisionScene>& scene)
      : scene_(*scene),
        pairs_(*scene),
        state_(*scene, pairs_),
        certifier_(*scene, state_),
        clearances_(*scene, state_),
        exact_(scene, state_, clearances_),
        stage_(EdgeStage::of(scene)),
        uncertified_(*scene, pairs_) {}

  const MotionReport& run(const JointMotion& motion, const MotionSettings& settings,
                          const PlacedBodies& placed, const CloudVoxels& voxels,
                          const std::vector<std::string>& reasons) {
    start_ = std::chrono::steady_clock::now();
    settings_ = settings;
    report_ = {};
    report_.unchecked = scene_.unchecked();
    clearances_.begin(settings_);
    clearance_ = INF;
    free_until_ = scene_.mayBeFree(report_.unchecked) ? 1.0 : 0.0;
    uncertified_.clear();
    exact_.begin(settings_, voxels);
    certifier_.begin(settings, voxels);
    state_.begin(motion, placed);
    intervals_.clear();
    setSize();
    const bool may_use_stage =
        EdgeStage::maySettle(settings, motion, placed) && report_.unchecked.empty();
    if (may_use_stage && !edge_ && stage_->isMade()) edge_ = stage_->makeGroup();
    const bool uses_stage = may_use_stage && edge_;
    const bool is_settled = uses_stage && settleByStage();
    if (!is_settled && lookAtAll(uses_stage)) lookAtOpen();
    finishReport(reasons);
    if (may_use_stage && !edge_) stage_->count(report_);
    report_.seconds = secondsSpent();
    return report_;
  }

 private:
  struct Swept {
    OpenPair open;
    double growth;  ///< metres by which the element's box has to be enlarged to contain its motion
  };

  // All of these return false if the search ends: a contact was found, or with only_free a pair
  // that cannot be certified.

  /// What the stage leaves open is searched, with the clearance that all else keeps: so whether the
  /// motion is FREE does not depend on what has been asked before. False if it is not certified so.
  bool settleByStage() {
    using Outcome = BatchStage::EdgeGroup::Outcome;
    const Outcome outcome = edge_->settle(state_.from(), state_.to());
    report_.nb_checks += static_cast<std::uint32_t>(edge_->nbConfigurations());
    if (outcome == Outcome::CONTACT) {
      const auto& elements = scene_.elements();
      const auto [first, second] = edge_->contact();
      at_ = edge_->contactAt();
      noteContact({std::minmax(elements[first].model, elements[second].model)});
      return true;
    }
    if (outcome == Outcome::OPEN && meetsAtSteps()) return true;
    for (const OpenPair& open : openPairsOf(*edge_, scene_, pairs_)) {
      Interval interval;
      intervals_.addPair(open, interval);
      intervals_.push(interval);
    }
    beyond_ = PairTable::APART;
    lookAtOpen();
    if (report_.verdict == Verdict::COLLISION || uncertified_.models().empty()) return true;
    intervals_.clear();
    uncertified_.clear();
    return false;
  }

  void lookAtOpen() {
    const std::uint32_t most_checks = report_.nb_checks + MOST_CHECKS;
    bool is_open = true;
    while (is_open && !intervals_.isEmpty()) {
      Interval interval = intervals_.pop();
      const bool goes_on = report_.nb_checks < most_checks &&
                           intervals_.nbPairs() < MOST_OPEN_PAIRS &&
                           interval.begin < relevantUntil() && !isTimeOver();
      is_open = goes_on ? look(interval) : giveUp(interval);
    }
  }

  void setSize() {
    size_ = settings_.resolution;
    for (const std::uint32_t element : pairs_.beside_static) {
      const double radius = scene_.elements()[element].box_half.norm();
      if (radius < INF) size_ = std::max(size_, radius);
    }
  }

  /// At the middle of the segment; the cheapest check first. `was_sampled`: not meetsAtSteps().
  bool lookAtAll(bool was_sampled) {
    beyond_ = 0.0;
    const bool samples = settings_.only_free && !settings_.only_moved && !settings_.from_start;
    if (samples && !was_sampled && meetsAtSteps()) return false;
    moveTo(0.0, 1.0);
    const bool looks = !samples && !settings_.only_moved;
    if (looks && exact_.meets(true) && confirmContact() && !settings_.from_start) return false;
    Interval before, after;
    OpenPair open;
    open.clearance = settings_.clearance;
    for (const std::uint32_t element : pairs_.beside_static) {
      if (settings_.only_moved && !state_.moves(element)) continue;
      open.pair = {element, ALL_STATIC};
      OpenPair one = open;
      if (!lookAt(one, before, after)) return false;
    }
    for (const MotionPairs::Pair& pair : pairs_.pairs) {
      open.pair = {pair.first, pair.second};
      open.frame = pair.frame;
      if (settings_.only_moved && !state_.moves(pair)) continue;
      using Voxels = PairCertifier::Voxels;
      const Voxels known = certifier_.voxelsOf(open.pair);
      open.clearance = clearances_.ofElements(open.pair);
      if (known == Voxels::UNKNOWN || known == Voxels::IN_PART) noteUncertified(open.pair, 0.0);
      if (known == Voxels::UNKNOWN || known == Voxels::NONE || open.clearance < 0.0) continue;
      OpenPair one = open;
      if (!lookAt(one, before, after)) return false;
    }
    return goesOn() && pushIntervals(before, after);
  }
  bool look(Interval& interval) {
    moveTo(interval.begin, std::min(interval.end, relevantUntil()));
    Interval before, after;
    while (!interval.isEmpty()) {
      OpenPair open = intervals_.popPair(interval);
      if (!lookAt(open, before, after)) return false;
    }
    return pushIntervals(before, after);
  }

  bool giveUp(Interval& interval) {
    while (!interval.isEmpty()) {
      const OpenPair open = intervals_.popPair(interval);
      noteUncertified(open.pair, open.begin);
    }
    return goesOn();
  }

  double secondsSpent() const {
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start_;
    return spent.count();
  }
  bool isTimeOver() const {
    return settings_.time_budget > 0.0 && secondsSpent() >= settings_.time_budget;
  }

  bool goesOn() const { return !settings_.only_free || uncertified_.models().empty(); }

  /// From that fraction on. Returns goesOn().
  bool noteUncertified(const BoxPair& pair, double begin) {
    free_until_ = std::min(free_until_, begin);
    uncertified_.note(pair, settings_.only_free);
    return goesOn();
  }

  /// After a contact only what can change free_until is of interest.
  double relevantUntil() const { return report_.verdict == Verdict::COLLISION ? free_until_ : INF; }

  void moveTo(double begin, double end) {
    at_ = 0.5 * begin + 0.5 * end;
    state_.moveTo(at_, std::max(at_ - begin, end - at_));
    swept_.clear();
    ++report_.nb_checks;
  }

  bool lookAt(OpenPair& open, Interval& before, Interval& after) {
    if (open.begin >= relevantUntil()) return true;
    open.end = std::min(open.end, relevantUntil());
    if (open.begin > at_) {
      intervals_.addPair(open, after);
    } else if (open.end < at_) {
      intervals_.addPair(open, before);
    } else if (open.pair.second != ALL_STATIC) {
      return settle(open, before, after);
    } else if (!isReadyToSweep(open)) {
      cut(open, {0.0, 0.0}, open.clearance, before, after);
    }
    return true;
  }

  bool pushIntervals(Interval& before, Interval& after) {
    if (!swept_.empty() && !sweep(before, after)) return false;
    intervals_.push(before);
    intervals_.push(after);
    return true;
  }
  /// Adds the open parts on either side of the certified one.
  void cut(const OpenPair& open, const CertifiedInterval& certified, double clearance_after,
           Interval& before, Interval& after) {
    OpenPair part = open;
    if (certified.before < at_ - open.begin) {
      part.end = at_ - std::max(certified.before, 0.0);
      intervals_.addPair(part, before);
    }
    if (certified.after < open.end - at_) {
      part.begin = at_ + std::max(certified.after, 0.0);
      part.end = open.end;
      part.clearance = clearance_after;
      intervals_.addPair(part, after);
    }
  }

  bool settle(OpenPair& open, Interval& before, Interval& after) {
    if (isTimeOver()) return noteUncertified(open.pair, open.begin);
    CertifiedInterval certified;
    using Outcome = PairCertifier::Outcome;
    Outcome outcome = certifier_.measure(at_, open, certified);
    if (outcome == Outcome::CONTACT && (at_ >= relevantUntil() || confirmContact())) {
      if (!settings_.from_start) return false;
      // At the resolution the last free configuration is near enough.
      const double rest = at_ - open.begin;
      const bool can_be_cut = rest > SHORTEST_INTERVAL && open.speed * rest > settings_.resolution;
      outcome = can_be_cut ? Outcome::OPEN : Outcome::GIVEN_UP;
    } else if (outcome == Outcome::CONTACT) {
      outcome = Outcome::GIVEN_UP;  // undecidable because of rounding
    }
    if (certified.before >= 0.0) clearance_ = std::min(clearance_, certified.clearance);
    if (outcome == Outcome::CERTIFIED) return true;
    if (outcome == Outcome::GIVEN_UP) return noteUncertified(open.pair, open.begin);
    double clearance_after = open.clearance;
    if (outcome == Outcome::NEARER) {
      clearance_after = 0.0;  // the search for a contact continues
      if (!settings_.from_start) open.clearance = 0.0;
      if (!noteUncertified(open.pair, settings_.from_start ? at_ : open.begin)) return false;
    }
    cut(open, certified, clearance_after, before, after);
    return true;
  }

  bool confirmContact() {
    if (!exact_.meets(false)) return false;
    noteContact(exact_.pairs());
    return true;
  }

  bool meetsAtSteps() {
    if (!exact_.meetsAtSteps(at_, report_.nb_checks)) return false;
    noteContact(exact_.pairs());
    return true;
  }

  void noteContact(std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs) {
    report_.verdict = Verdict::COLLISION;
    report_.contact_at = at_;
    report_.pairs = std::move(pairs);
    free_until_ = std::min(free_until_, settings_.from_start ? at_ : 0.0);
  }

  bool isReadyToSweep(OpenPair& open) {
    const std::uint32_t element = open.pair.first;
    const double length = std::max(at_ - open.begin, open.end - at_);
    const MotionBound bound = state_.bound(element, -1);
    open.speed = bound.speed;
    const Twist twist = state_.twist(element, -1);
    const double speed = twist.v.norm() + twist.omega.norm() * state_.sphere(element).radius;
    const double growth =
        std::min(bound.speed * length, speed * length + 0.5 * bound.acceleration * length * length);
    if (!(growth < INF) && length > 0.0) refuseBox(scene_, scene_.elements()[element].model);
    if (growth > MOTION_TO_SWEEP * size_) return false;
    swept_.push_back({open, ROUNDED_UP * (growth + bound.deviation) + bound.rounding});
    return true;
  }

  /// Finds the static elements that elements of `swept_` may touch during their motion.
  bool sweep(Interval& before, Interval& after) {
    double most = 0.0;
    for (const Swept& swept : swept_) most = std::max(most, swept.growth);
    const double reach = settings_.clearance + beyond_ +
                         std::max(SWEEP_BEYOND_MOTION * most, SWEEP_BEYOND_SIZE * size_);
    clearance_ = std::min(clearance_, reach);
    sweep_.begin(reach, &scene_.staticBoxes(), &pairs_.static_pairs);
    for (const auto& [open, growth] : swept_) {
      const SceneElement& element = scene_.elements()[open.pair.first];
      Aabb box = element.boxAt(state_.pose(open.pair.first));
      box.min.array() -= growth;
      box.max.array() += growth;
      sweep_.add(box, element.model);
    }
    const std::vector<BoxPair>& found = sweep_.end();
    for (const std::uint32_t refused : sweep_.refused()) {
      refuseBox(scene_, scene_.elements()[sweptAs(refused).pair.first].model);
    }
    for (const auto& [fixed, moving] : found) {
      OpenPair open = sweptAs(moving);
      const auto& elements = scene_.elements();
      const bool in_order = elements[fixed].model < elements[open.pair.first].model;
      open.pair = in_order ? BoxPair{fixed, open.pair.first} : BoxPair{open.pair.first, fixed};
      open.clearance = clearances_.ofElements(open.pair);
      if (open.clearance < 0.0) continue;
      open.clearance += beyond_;
      if (!settle(open, before, after)) return false;
    }
    return true;
  }

  const OpenPair& sweptAs(std::uint32_t box) const {
    return swept_[box - scene_.nbStaticElements()].open;
  }

  void finishReport(const std::vector<std::string>& reasons) {
    report_.nb_queries = certifier_.nbQueries();
    if (report_.unchecked.empty() && clearances_.leaveOutAll()) {
      report_.unchecked = "every pair is left out";
      if (!scene_.mayBeFree(report_.unchecked)) free_until_ = 0.0;
    }
    const bool has_ended = !goesOn();  // and other pairs may be in contact before the one found
    const bool is_known = !has_ended && reasons.empty();
    report_.free_until = is_known ? std::min(free_until_, std::nextafter(1.0, 0.0)) : 0.0;
    const bool is_in_contact = report_.verdict == Verdict::COLLISION;
    if (!is_in_contact) {
      report_.pairs.assign(uncertified_.models().begin(), uncertified_.models().end());
      const std::vector<std::string> names = uncertified_.names();
      report_.unknown_because = unknownBecause(
          scene_, report_.unchecked, {{"motions that could not be certified", names}}, reasons);
    }
    report_.verdict = verdictOf(is_in_contact, !report_.unknown_because.empty());
    if (report_.verdict != Verdict::FREE) return;
    report_.free_until = 1.0;
    report_.clearance = settings_.only_free ? clearances_.least() : clearance_;
  }

  const CollisionScene& scene_;
  const MotionPairs pairs_;
  MotionState state_;
  PairCertifier certifier_;
  PairClearances clearances_;
  ExactConfiguration exact_;
  const std::shared_ptr<EdgeStage> stage_;
  std::unique_ptr<BatchStage::EdgeGroup> edge_;  // null until the stage is made
  SweepAndPrune sweep_;

  MotionSettings settings_;
  std::chrono::steady_clock::time_point start_;
  MotionReport report_;
  UncertifiedPairs uncertified_;
  double clearance_ = INF;   ///< certified so far
  double free_until_ = 1.0;  ///< from there on some pair is not certified
  double beyond_ = 0.0;      ///< metres that static elements keep beyond their clearance
  double size_ = 0.0;        ///< metres, of the largest element with static ones near it
  double at_ = 0.0;          ///< the current configuration
  OpenIntervals intervals_;
  std::vector<Swept> swept_;
};

MotionCheck::MotionCheck(std::shared_ptr<const CollisionScene> scene)
    : scene_(std::move(scene)), search_(std::make_unique<Search>(scene_)) {}
MotionCheck::~MotionCheck() = default;
MotionCheck::MotionCheck(MotionCheck&&) noexcept = default;
MotionCheck& MotionCheck::operator=(MotionCheck&&) noexcept = default;

const MotionReport& MotionCheck::check(const JointMotion& motion, const MotionSettings& settings,
                                       const PlacedBodies& placed, const CloudVoxels& voxels,
                                       const std::vector<std::string>& reasons) {
  return search_->run(motion, settings, placed, voxels, reasons);
}

}  // namespace collision_pairs
