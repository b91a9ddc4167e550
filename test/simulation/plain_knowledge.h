// What a simulated node may know, by the rules of docs/node.md restated as plainly as they can be:
// who has said what of which frame, of when, and when that arrived.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "events.h"

namespace simulation {

using Ns = std::int64_t;
constexpr double CLOCK_TOLERANCE = 0.5;  // s
constexpr Ns EVER = std::numeric_limits<Ns>::min();

inline double seconds(Ns span) { return 1e-9 * static_cast<double>(span); }

/// Of one frame, since the clock went back.
struct Told {
  std::map<Ns, Pose> samples;           ///< by stamp, of the node that says the truth
  std::vector<Ns> lies;                 ///< stamps of those of another, on /tf
  bool is_lied_about = false;           ///< on either topic
  bool is_static_lie = false;           ///< … on /tf_static, or both topics have it: also before
  bool is_plain = true;                 ///< by one node, in order, and no static pose that changes
  Ns moved = EVER, stood = EVER;        ///< when it was last heard of on /tf, and on /tf_static
  std::map<std::string, Pose> statics;  ///< the newest static pose of each node
  std::vector<std::pair<Ns, Pose>> static_poses;  ///< that counted, and since when
  std::optional<Ns> open_since;                   ///< which static pose counts
};

class Knowledge {
 public:
  explicit Knowledge(const Scenario& setup) : setup_(setup), told_(setup.links.size()) {}

  void moveClock(Ns ros, double steady) {
    if (ros != ros_) last_step_ = steady;
    ros_ = ros;
    steady_ = steady;
    if (ros < latest_ && seconds(latest_ - ros) <= 0.1) return;
    if (ros < latest_) forget();
    latest_ = ros;
  }
  /// The clock, but for steps back that do not count.
  Ns latest() const { return latest_; }
  int pass() const { return pass_; }
  bool isClockInDoubt() const {
    return setup_.is_simulated && !setup_.allow_paused && setup_.max_pose_age > 0.0 &&
           latest_ > 0 && steady_ - last_step_ > setup_.max_pose_age;
  }

  /// Whether a transform of that stamp is accepted now.
  bool isUsable(Ns stamp) const {
    const double age = seconds(ros_ - stamp);
    const bool is_old = setup_.max_pose_age > 0.0 && age > setup_.max_pose_age;
    return ros_ > 0 && stamp > 0 && age >= -CLOCK_TOLERANCE && !is_old;
  }
  void hear(int link, Ns stamp, const Pose& X_PB, const std::string& publisher) {
    Told& told = told_[static_cast<std::size_t>(link)];
    if (of(link).is_static) return hearStatic(told, X_PB, publisher);
    if (!isUsable(stamp)) return;
    const bool is_late = !told.samples.empty() && stamp <= told.samples.rbegin()->first;
    if (is_late || publisher != "honest") told.is_plain = false;
    told.samples.emplace(stamp, X_PB);
    told.moved = ros_;
  }
  void hearLie(int link, Ns stamp, bool is_static) {
    if (!is_static && !isUsable(stamp)) return;
    Told& told = told_[static_cast<std::size_t>(link)];
    const bool is_for_ever = is_static || of(link).is_static;
    told.is_lied_about = true;
    told.is_static_lie = told.is_static_lie || is_for_ever;
    told.is_plain = false;
    (is_static ? told.stood : told.moved) = ros_;
    if (!is_static) told.lies.push_back(stamp);
    if (is_for_ever) endure();
  }
  /// That the root hangs on Scenario::cycle_through.
  void hearRootLie(Ns stamp) {
    if (!isUsable(stamp)) return;
    root_lies_.insert(stamp);
    endure();
  }
  /// Without a limit of the age no node that was heard ever counts as silent: a frame on /tf and
  /// /tf_static stays ambiguous, and a cycle stays.
  bool isAmbiguousForEver() const { return is_ambiguous_for_ever_; }
  const Told& told(int link) const { return told_[static_cast<std::size_t>(link)]; }
  bool isLiedAbout(int link) const {
    for (; link >= 0; link = of(link).parent) {
      if (told(link).is_lied_about) return true;
    }
    return !root_lies_.empty();
  }
  /// Whether a pose at that stamp may be made of a lie.
  bool isLiedAbout(int link, Ns stamp) const {
    for (; link >= 0; link = of(link).parent) {
      if (told(link).is_static_lie) return true;
      for (const Ns lie : told(link).lies) {
        if (std::abs(seconds(stamp - lie)) <= setup_.max_transform_age) return true;
      }
    }
    return isRootHung(stamp);
  }
  /// A lie among truths, two before and one after it, puts stamps around it in doubt.
  bool isInDoubt(int link, Ns stamp) const {
    for (; link >= 0; link = of(link).parent) {
      const auto& truths = told(link).samples;
      for (const Ns lie : told(link).lies) {
        const auto after = truths.upper_bound(lie);
        if (after == truths.end() || std::distance(truths.begin(), after) < 2) continue;
        const auto before = std::prev(after), earlier = std::prev(before);
        const bool is_among = seconds(after->first - earlier->first) < setup_.max_transform_age;
        if (is_among && std::abs(seconds(stamp - lie)) < 0.95 * lasting()) return true;
      }
    }
    return false;
  }
  /// Whether a static frame may have become one that moves, by lies.
  bool isReplaced(int link) const {
    for (; link >= 0; link = of(link).parent) {
      if (of(link).is_static && told(link).is_lied_about) return true;
    }
    return false;
  }
  /// Whether a frame was heard of on both topics lately.
  bool isOnBoth(int link) const {
    for (; link >= 0; link = of(link).parent) {
      const Ns last = std::min(told(link).moved, told(link).stood);
      if (last == EVER) continue;
      const bool is_late = seconds(latest_ - last) > 0.95 * setup_.max_pose_age;
      if (setup_.max_pose_age == 0.0 || !is_late) return true;
    }
    return false;
  }
  /// Whether /tf_static alone places it although its joint, or one above, may move.
  bool isHeld(int link) const {
    for (; link >= 0; link = of(link).parent) {
      const bool is_fixed = of(link).joint == SimulatedLink::FIXED;
      if (!is_fixed && of(link).is_static && !of(link).is_listed) return true;
    }
    return false;
  }
  /// Whether all of it was said by one node each, in order.
  bool isPlain() const {
    return root_lies_.empty() &&
           std::all_of(told_.begin(), told_.end(), [](const Told& told) { return told.is_plain; });
  }
  bool isRootHung(Ns stamp) const {
    const auto after = root_lies_.lower_bound(stamp);
    if (after == root_lies_.end()) return false;
    return *after == stamp || (after != root_lies_.begin() &&
                               seconds(*after - *std::prev(after)) <= setup_.max_transform_age);
  }

  /// Where the link is in the root's frame at that stamp; nothing if it may not be known.
  std::optional<Pose> poseOf(int link, Ns stamp) const {
    Pose X_WB;
    for (; link >= 0; link = of(link).parent) {
      const std::optional<Pose> X_PB = inParent(link, stamp);
      if (!X_PB) return std::nullopt;
      X_WB = *X_PB * X_WB;
    }
    return X_WB;
  }
  std::optional<Pose> inParent(int link, Ns stamp) const {
    if (of(link).joint == SimulatedLink::FIXED) return of(link).X_PJ;
    return of(link).is_static ? standing(told(link), stamp) : moving(told(link), stamp);
  }
  /// Whether the newest that was said of a frame between the link and the root is older [s].
  bool hasOldOn(int link, double age) const {
    for (; link >= 0; link = of(link).parent) {
      const auto& samples = told(link).samples;
      if (of(link).joint == SimulatedLink::FIXED || of(link).is_static) continue;
      if (samples.empty() || seconds(ros_ - samples.rbegin()->first) > age) return true;
    }
    return false;
  }
  /// Whether some link was heard of later, by more than is allowed; not of those lied about. Stamps
  /// count that are no further `ahead` of now.
  bool isBehind(Ns stamp, Ns ahead_of_now = 0) const {
    for (const Told& told : told_) {
      const auto ahead = told.samples.upper_bound(ros_ + ahead_of_now);
      if (told.is_lied_about || ahead == told.samples.begin()) continue;
      const double lag = seconds(std::prev(ahead)->first - stamp);
      if (lag > setup_.max_transform_age + 1e-6) return true;
    }
    return false;
  }
  bool isTooOld(Ns stamp) const {
    return setup_.max_pose_age > 0.0 && seconds(ros_ - stamp) > setup_.max_pose_age + 1e-6;
  }

 private:
  const SimulatedLink& of(int link) const { return setup_.links[static_cast<std::size_t>(link)]; }
  double lasting() const {
    return setup_.max_pose_age > 0.0 ? setup_.max_pose_age : setup_.max_transform_age;
  }
  void endure() { is_ambiguous_for_ever_ |= setup_.max_pose_age == 0.0; }

  /// All but static poses.
  void forget() {
    for (Told& told : told_) {
      Told fresh;
      fresh.is_lied_about = fresh.is_static_lie = told.is_static_lie;
      fresh.is_plain = !told.is_static_lie && told.statics.size() < 2;
      fresh.statics = told.statics;
      if (!told.static_poses.empty())
        fresh.static_poses = {{EVER, told.static_poses.back().second}};
      if (told.open_since) fresh.open_since = EVER;
      told = fresh;
    }
    root_lies_.clear();
    ++pass_;
  }

  /// The newest pose counts that was sent twice, or by one node alone.
  void hearStatic(Told& told, const Pose& X_PB, const std::string& publisher) {
    // Poses within 0.1 mm and 0.1 mrad are the same.
    const auto isThis = [&](const Pose& pose) { return distanceOf(pose, X_PB) < 1e-4; };
    const bool is_again = std::any_of(told.statics.begin(), told.statics.end(),
                                      [&](const auto& sent) { return isThis(sent.second); });
    told.statics[publisher] = X_PB;
    told.stood = ros_;
    const bool counts = is_again || told.statics.size() == 1;
    const bool is_first = told.static_poses.empty();
    if (publisher != "honest") told.is_plain = false;
    if (counts) told.open_since.reset();
    if (is_first) told.static_poses.emplace_back(EVER, X_PB);
    if (is_first || isThis(told.static_poses.back().second)) return;
    told.is_plain = false;
    if (counts) told.static_poses.emplace_back(ros_, X_PB);
    if (!counts && !told.open_since) told.open_since = ros_;
  }

  /// Not at stamps shortly before it changed, nor while it is open what counts.
  std::optional<Pose> standing(const Told& told, Ns stamp) const {
    const auto isShortlyBefore = [&](Ns change) { return seconds(change - stamp) < lasting(); };
    if (told.static_poses.empty()) return std::nullopt;
    if (told.open_since && (*told.open_since == EVER || isShortlyBefore(*told.open_since))) {
      return std::nullopt;
    }
    for (auto change = told.static_poses.rbegin(); change != told.static_poses.rend(); ++change) {
      if (change->first <= stamp) return change->second;
      if (isShortlyBefore(change->first)) return std::nullopt;
    }
    return std::nullopt;
  }

  std::optional<Pose> moving(const Told& told, Ns stamp) const {
    const auto after = told.samples.lower_bound(stamp);
    if (after == told.samples.end()) return std::nullopt;
    if (after->first == stamp) return after->second;
    if (after == told.samples.begin()) return std::nullopt;
    const auto before = std::prev(after);
    const double gap = seconds(after->first - before->first);
    if (gap > setup_.max_transform_age) return std::nullopt;
    return between(before->second, after->second, seconds(stamp - before->first) / gap);
  }

  const Scenario& setup_;
  std::vector<Told> told_;
  std::set<Ns> root_lies_;
  Ns ros_ = 0, latest_ = 0;
  double steady_ = 0.0, last_step_ = 0.0;
  int pass_ = 0;
  bool is_ambiguous_for_ever_ = false;
};

}  // namespace simulation
