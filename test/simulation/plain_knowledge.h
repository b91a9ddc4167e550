// What a simulated node may know, by the rules of docs/node.md restated as plainly as they can be:
// who has said what of which frame, of when, and when that arrived.
#pragma once

#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "events.h"

namespace simulation {

using Ns = std::int64_t;
constexpr double CLOCK_TOLERANCE = 0.5;  // s

inline double seconds(Ns span) { return 1e-9 * static_cast<double>(span); }

/// Of one frame.
struct Told {
  std::map<Ns, Pose>
      samples;           ///< by stamp, of the node that says the truth, since the clock went back
  std::vector<Ns> lies;  ///< stamps of those of another
  bool is_lied_about = false;  ///< also on /tf_static
};

class Knowledge {
 public:
  explicit Knowledge(const Scenario& setup) : setup_(setup), told_(setup.links.size()) {}

  void moveClock(Ns ros, double steady) {
    if (ros != ros_) last_step_ = steady;
    ros_ = ros;
    steady_ = steady;
    if (ros < latest_ && seconds(latest_ - ros) <= 0.1) return;
    if (ros < latest_) {
      for (Told& told : told_) told = {};
      ++pass_;
    }
    latest_ = ros;
  }
  Ns ros() const { return ros_; }
  int pass() const { return pass_; }
  bool isClockInDoubt() const {
    return setup_.is_simulated && !setup_.allow_paused && setup_.max_pose_age > 0.0 &&
           steady_ - last_step_ > setup_.max_pose_age;
  }

  /// Whether a transform of that stamp is accepted now.
  bool isUsable(Ns stamp) const {
    const double age = seconds(ros_ - stamp);
    const bool is_old = setup_.max_pose_age > 0.0 && age > setup_.max_pose_age;
    return ros_ > 0 && stamp > 0 && age >= -CLOCK_TOLERANCE && !is_old;
  }
  void hear(int link, Ns stamp, const Pose& X_PB) {
    if (isUsable(stamp)) told_[static_cast<std::size_t>(link)].samples.emplace(stamp, X_PB);
  }
  void hearLie(int link, Ns stamp, bool is_static) {
    Told& told = told_[static_cast<std::size_t>(link)];
    told.is_lied_about = true;
    is_static_for_ever_ = is_static_for_ever_ || (is_static && setup_.max_pose_age == 0.0);
    if (!is_static && isUsable(stamp)) told.lies.push_back(stamp);
  }
  /// Without a limit of the age no node that was heard ever counts as silent: a frame on /tf and
  /// /tf_static stays ambiguous.
  bool isAmbiguousForEver() const { return is_static_for_ever_; }
  const Told& told(int link) const { return told_[static_cast<std::size_t>(link)]; }
  bool isLiedAbout(int link) const {
    for (; link >= 0; link = parentOf(link)) {
      if (told(link).is_lied_about) return true;
    }
    return false;
  }
  /// A lie among truths, two before and one after it, puts stamps around it in doubt.
  bool isInDoubt(int link, Ns stamp) const {
    const double lasting =
        setup_.max_pose_age > 0.0 ? setup_.max_pose_age : setup_.max_transform_age;
    for (; link >= 0; link = parentOf(link)) {
      const auto& truths = told(link).samples;
      for (const Ns lie : told(link).lies) {
        const auto after = truths.upper_bound(lie);
        if (after == truths.end() || std::distance(truths.begin(), after) < 2) continue;
        const auto before = std::prev(after), earlier = std::prev(before);
        const bool is_among = seconds(after->first - earlier->first) < setup_.max_transform_age;
        if (is_among && std::abs(seconds(stamp - lie)) < 0.95 * lasting) return true;
      }
    }
    return false;
  }

  /// Where the link is in the root's frame at that stamp; nothing if it may not be known.
  std::optional<Pose> poseOf(int link, Ns stamp) const {
    Pose X_WB;
    for (; link >= 0; link = parentOf(link)) {
      const SimulatedLink& of = setup_.links[static_cast<std::size_t>(link)];
      std::optional<Pose> X_PB = of.X_PJ;
      if (of.joint != SimulatedLink::FIXED) X_PB = inParent(told(link), stamp);
      if (!X_PB) return std::nullopt;
      X_WB = *X_PB * X_WB;
    }
    return X_WB;
  }
  /// Whether the newest that was said of a frame between the link and the root is older [s].
  bool hasOldOn(int link, double age) const {
    for (; link >= 0; link = parentOf(link)) {
      const auto& samples = told(link).samples;
      const bool is_fixed =
          setup_.links[static_cast<std::size_t>(link)].joint == SimulatedLink::FIXED;
      if (is_fixed) continue;
      if (samples.empty() || seconds(ros_ - samples.rbegin()->first) > age) return true;
    }
    return false;
  }
  /// Whether some link was heard of later, by more than is allowed; not of those lied about.
  bool isBehind(Ns stamp) const {
    for (const Told& told : told_) {
      const auto ahead = told.samples.upper_bound(ros_);
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
  int parentOf(int link) const { return setup_.links[static_cast<std::size_t>(link)].parent; }

  std::optional<Pose> inParent(const Told& told, Ns stamp) const {
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
  Ns ros_ = 0, latest_ = 0;
  double steady_ = 0.0, last_step_ = 0.0;
  int pass_ = 0;
  bool is_static_for_ever_ = false;
};

}  // namespace simulation
