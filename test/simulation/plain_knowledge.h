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

/// Of a frame, on /tf.
struct Lie {
  Ns stamp;
  Pose X_PB;
  bool is_in_other_parent;
};

/// Of one frame, since the clock went back.
struct Told {
  std::map<Ns, Said> samples;  ///< by stamp, of the node that says the truth
  std::set<Ns> late;           ///< stamps of those that came after later ones
  std::vector<Lie> lies;       ///< of others
  bool is_lied_about = false;  ///< on either topic
  bool is_static_lie = false;  ///< … on /tf_static, or both topics have it: also before
  bool is_plain = true;        ///< by one node, in order, and no static pose that changes
  bool is_of_others = false;   ///< some samples are of a second node alone
  std::vector<std::pair<Ns, Ns>> disturbed;   ///< spans where what was said may be suspect
  bool is_heard = false;                      ///< ever
  bool is_static = false, is_settled = true;  ///< by which topic; if it is settled, since when
  Ns settled_since = EVER;
  bool was_static = false;       ///< before that
  bool is_static_again = false;  ///< since it is not, a static pose was sent that had been
  bool is_run_static = false, has_run = false;  ///< heard of on one topic since it was unsettled
  Ns run_begin = EVER;
  bool is_run_vague = false;            ///< when it began, or what was before, is open
  Ns moved = EVER, stood = EVER;        ///< when it was last heard of on /tf, and on /tf_static
  std::map<std::string, Said> statics;  ///< the newest static pose of each node
  std::vector<std::pair<Ns, Said>> static_poses;  ///< that counted, and since when
  std::optional<Ns> open_since;                   ///< which static pose counts
};

class Knowledge {
 public:
  explicit Knowledge(const Scenario& setup) : setup_(setup), told_(setup.links.size()) {
    for (std::size_t i = 0; i < told_.size(); ++i) told_[i].is_static = setup.links[i].is_static;
  }

  void moveClock(Ns clock, double steady) {
    steady_ = steady;
    if (clock == ros_ || (clock < ros_ && seconds(ros_ - clock) <= 0.1)) return;
    last_step_ = steady;
    if (clock < ros_) return forget(clock);
    ros_ = clock;
  }
  /// The clock, but for steps back that do not count.
  Ns now() const { return ros_; }
  int pass() const { return pass_; }
  bool isClockSuspect() const {
    return setup_.is_simulated && !setup_.allow_paused && setup_.max_pose_age > 0.0 && ros_ > 0 &&
           steady_ - last_step_ > setup_.max_pose_age;
  }

  /// Whether a transform of that stamp is accepted now.
  bool isUsable(Ns stamp) const {
    const double age = seconds(ros_ - stamp);
    const bool is_old = setup_.max_pose_age > 0.0 && age > setup_.max_pose_age;
    return ros_ > 0 && stamp > 0 && age >= -CLOCK_TOLERANCE && !is_old;
  }
  void hear(int link, Ns stamp, const Said& X_PB, bool is_static, const std::string& publisher) {
    Told& told = told_[static_cast<std::size_t>(link)];
    if (!is_static && !isUsable(stamp)) return;
    const bool is_again = is_static && wasSent(told, X_PB);
    hearOn(told, is_static);
    told.is_static_again = told.is_static_again || is_again;
    if (is_static) return hearStatic(told, X_PB, publisher);
    newest_ = std::max(newest_, stamp);
    const auto later = told.samples.lower_bound(stamp);
    // Late among others that are near in time: it may contradict them.
    const bool is_late =
        later != told.samples.end() &&
        (later->first == stamp ||
         (later != told.samples.begin() &&
          seconds(later->first - std::prev(later)->first) <= setup_.max_transform_age));
    if (later != told.samples.end()) told.is_plain = false;
    if (later != told.samples.end()) told.late.insert(stamp);
    const bool agrees = publisher == "relay" && told.samples.count(stamp) > 0;
    if ((is_late && !agrees) || publisher == "repeats") {
      told.is_plain = false;
      disturb(told, stamp);
    }
    const bool is_new = told.samples.emplace(stamp, X_PB).second;
    told.is_of_others = told.is_of_others || (is_new && publisher != "honest");
  }
  void hearLie(int link, const Lie& lie, bool is_static) {
    const Ns stamp = lie.stamp;
    if (!is_static && !isUsable(stamp)) return;
    Told& told = told_[static_cast<std::size_t>(link)];
    const bool is_for_ever = is_static || told.is_static;
    hearOn(told, is_static);
    if (!is_static) newest_ = std::max(newest_, stamp);
    disturb(told, is_static ? ros_ : stamp);
    told.is_lied_about = true;
    told.is_static_lie = told.is_static_lie || is_for_ever;
    told.is_plain = false;
    if (!is_static) told.lies.push_back(lie);
    if (is_for_ever) endure();
  }
  /// That the root hangs on Scenario::cycle_through.
  void hearRootLie(Ns stamp) {
    if (!isUsable(stamp)) return;
    root_lies_.insert(stamp);
    newest_ = std::max(newest_, stamp);
    endure();
  }
  /// Without a limit of the age no node that was heard ever counts as silent: a frame on /tf and
  /// /tf_static stays ambiguous, and a cycle stays.
  bool isAmbiguousForEver() const { return is_ambiguous_for_ever_; }
  /// Whether TF has a frame of that name, as far as the truth was told.
  bool isNamed(int link) const;
  const Told& told(int link) const { return told_[static_cast<std::size_t>(link)]; }
  bool isLiedAbout(int link) const {
    for (const int i : setup_.pathTo(link)) {
      if (told(i).is_lied_about) return true;
    }
    return !root_lies_.empty() || isFrameLiedAbout(EVER);
  }
  /// Whether a pose at that stamp may be made of a lie, or of what the other topic had.
  bool isLiedAbout(int link, Ns stamp) const {
    if (isOpen(link, stamp)) return true;
    for (const int i : setup_.pathTo(link)) {
      if (isLieOf(told(i), stamp)) return true;
    }
    return isRootHung(stamp) || isFrameLiedAbout(stamp);
  }
  /// Whether W, or what it hangs on, was lied about: that places what W is said to hang on.
  bool isFrameLiedAbout(Ns stamp) const {
    for (int link = setup_.fixed_frame; link >= 0; link = of(link).parent) {
      if (isLieOf(told(link), stamp)) return true;
    }
    return false;
  }
  /// Whether a lie about W, or about what it hangs on, leads past the joint of that link.
  bool isLedPast(int link) const {
    for (int i = setup_.fixed_frame; i >= 0; i = of(i).parent) {
      if (i != link && told(i).is_lied_about) return true;
    }
    return false;
  }
  /// A lie among truths puts stamps around it suspect if it is further from its neighbours than
  /// these, or the two before, are from each other.
  bool isSuspect(int link, Ns stamp) const {
    // When it was noticed, stamps of longer ago were too old.
    if (seconds(ros_ - stamp) > 0.95 * lasting()) return false;
    for (const int i : setup_.pathTo(link)) {
      const auto& truths = told(i).samples;
      if (isLedPast(i)) return false;
      if (told(i).is_static) continue;     // what was said of it while it moved is over
      if (told(i).is_of_others) continue;  // then it may not be among three of one node
      for (const Lie& lie : told(i).lies) {
        const auto after = truths.upper_bound(lie.stamp);
        if (after == truths.end() || after == truths.begin()) continue;
        const auto before = std::prev(after);
        auto earlier = before;
        if (before != truths.begin() &&
            seconds(before->first - std::prev(before)->first) < setup_.max_transform_age + 1e-6) {
          earlier = std::prev(before);
        }
        if (before->second.is_rehung != after->second.is_rehung) continue;
        // It was judged beside those that had come by then.
        const auto late = told(i).late.lower_bound(earlier->first);
        if (late != told(i).late.end() && *late <= after->first) continue;
        const auto isFar = [&](double (*measure)(const Pose&, const Pose&)) {
          const double step = std::max(measure(before->second, after->second),
                                       measure(earlier->second, before->second));
          return std::min(measure(lie.X_PB, before->second), measure(lie.X_PB, after->second)) >
                 step + 1e-3;
        };
        if (!isFar(metresOf) && !isFar(radiansOf) && !lie.is_in_other_parent) continue;
        const bool is_among = seconds(after->first - before->first) < setup_.max_transform_age;
        if (is_among && std::abs(seconds(stamp - lie.stamp)) < 0.95 * lasting()) return true;
      }
      if (told(i).is_lied_about) return false;  // the lie may lead past the rest
    }
    return false;
  }
  /// Whether a static frame may have become one that moves, by lies.
  bool isReplaced(int link) const {
    for (const int i : setup_.pathTo(link)) {
      if (told(i).is_static && told(i).is_static_lie) return true;
    }
    return false;
  }
  /// Whether a frame was heard of on both topics lately: a static one is until it has moved long.
  bool isOnBoth(int link) const {
    for (const int i : setup_.pathTo(link)) {
      if (isOnBoth(told(i))) return true;
    }
    return false;
  }
  bool isOnBoth(const Told& told) const {
    const bool may_stand = told.is_static && !told.is_settled && !told.is_run_static;
    Ns last = std::min(told.moved, told.stood);
    if (may_stand && told.moved != EVER) last = std::max(last, told.run_begin);
    return isLately(last);
  }
  /// Whether both topics had it lately, whatever it was before.
  bool wasOnBoth(const Told& told) const { return isLately(std::min(told.moved, told.stood)); }
  /// Whether /tf_static alone places it although its joint, or one above, may move.
  bool isHeld(int link) const;
  /// Whether it is open which topic places it at that stamp.
  bool isOpen(int link, Ns stamp) const {
    for (const int i : setup_.pathTo(link)) {
      if (!told(i).is_settled || stamp <= told(i).settled_since) return true;
    }
    return false;
  }
  /// Whether the rules forbid to use it at that stamp: the static pose of a frame that has begun to
  /// move, or one that was sent once after it moved, or before that.
  bool isForbidden(int link, Ns stamp) const;
  /// Whether it is open now which of its static poses counts.
  bool isPoseOpen(int link) const {
    const Scenario::Path& path = setup_.pathTo(link);
    return std::any_of(path.begin(), path.end(), [&](int i) { return told(i).open_since; });
  }
  /// Whether it is open now, or was lately.
  bool isUnsettled(int link) const {
    for (const int i : setup_.pathTo(link)) {
      const Told& told = this->told(i);
      if (!told.is_settled) return true;
      const bool has_changed = told.settled_since != EVER;
      if (has_changed && seconds(ros_ - told.settled_since) < 3.0) return true;
    }
    return false;
  }
  /// Whether the rules leave no question where it is at that stamp.
  bool isCertain(int link, Ns stamp) const {
    const Ns earliest = std::min(stamp, ros_);
    const double lasts = seconds(earliest - (root_lies_.empty() ? EVER / 2 : *root_lies_.rbegin()));
    const bool is_cycle_over = lasts > setup_.max_pose_age + 1e-6 && setup_.max_pose_age > 0.0;
    if (isHeld(link) || !(is_cycle_over || root_lies_.empty())) return false;
    if (mayHangOnItself(stamp)) return false;
    for (const int i : setup_.pathTo(link)) {
      if (of(i).joint == SimulatedLink::FIXED) continue;
      const Told& told = this->told(i);
      if (!told.is_settled || told.is_static_lie || !inParent(i, stamp)) return false;
      const auto after = told.is_static ? told.samples.end() : told.samples.upper_bound(stamp);
      const Ns known = told.is_static ? stamp : std::prev(after)->first;
      if (known <= told.settled_since || isDisturbed(told, known, stamp)) return false;
    }
    return true;
  }
  /// Whether W does by a lie about one of its ancestors, or did lately: then nothing is known.
  bool mayHangOnItself(Ns stamp) const {
    const double lasts = setup_.max_pose_age + setup_.max_transform_age;
    for (int link = setup_.fixed_frame; link >= 0; link = of(link).parent) {
      for (const Lie& lie : told(link).lies) {
        if (setup_.max_pose_age == 0.0 || std::abs(seconds(stamp - lie.stamp)) < lasts) return true;
      }
    }
    return false;
  }
  bool isDisturbed(const Told& told, Ns begin, Ns end) const {
    return std::any_of(told.disturbed.begin(), told.disturbed.end(),
                       [&](const auto& span) { return begin <= span.second && span.first <= end; });
  }
  /// The latest stamp of all that was said, true or not.
  Ns newest() const { return newest_; }
  /// Whether all of it was said by one node each, in order.
  bool isPlain() const {
    return root_lies_.empty() &&
           std::all_of(told_.begin(), told_.end(), [](const Told& told) { return told.is_plain; });
  }
  /// Whether the root is placed by who says that it hangs on a link; round a cycle, it is not.
  bool isRootHung(Ns stamp) const {
    if (isCycle(stamp)) return false;
    const auto after = root_lies_.lower_bound(stamp);
    if (after == root_lies_.end()) return false;
    return *after == stamp || (after != root_lies_.begin() &&
                               seconds(*after - *std::prev(after)) <= setup_.max_transform_age);
  }
  /// Whether the root hangs on a link that hangs on the root, all of which was heard of lately.
  bool isCycle(Ns stamp) const;

  /// Where the link is in W at that stamp; nothing if it may not be known.
  std::optional<Pose> poseOf(int link, Ns stamp) const {
    const Scenario::Path& path = setup_.pathTo(link);
    Pose X_PL, X_PW;  // P: the last that both hang on
    for (std::size_t i = 0; i < path.links.size(); ++i) {
      const std::optional<Pose> X_AB = inParent(path.links[i], stamp);
      if (!X_AB) return std::nullopt;
      Pose& X = i < path.nb_up ? X_PL : X_PW;
      X = *X_AB * X;
    }
    return inverse(X_PW) * X_PL;
  }
  std::optional<Pose> inParent(int link, Ns stamp) const {
    if (of(link).joint == SimulatedLink::FIXED) return of(link).X_PJ;
    return told(link).is_static ? standing(told(link), stamp) : moving(told(link), stamp);
  }
  /// Whether the newest that was said of a frame between the link and the root is older [s].
  bool hasOldOn(int link, double age) const {
    for (const int i : setup_.pathTo(link)) {
      const auto& samples = told(i).samples;
      if (!told(i).is_settled) return true;
      if (of(i).joint == SimulatedLink::FIXED || told(i).is_static) continue;
      if (samples.empty() || seconds(ros_ - samples.rbegin()->first) > age) return true;
    }
    return false;
  }
  /// Whether some link that places others was heard of later, by more than is allowed. Not after a
  /// lie, which may lead past a link, so that it places no others.
  bool isBehind(Ns stamp) const {
    const auto isLied = [](const Told& told) { return told.is_lied_about; };
    if (std::any_of(told_.begin(), told_.end(), isLied)) return false;
    for (int link = 0; link < static_cast<int>(told_.size()); ++link) {
      const Told& told = this->told(link);
      const auto ahead = told.samples.upper_bound(ros_);
      if (!setup_.isOnPath(link)) continue;
      if (!told.is_settled || told.is_static) continue;
      if (ahead == told.samples.begin()) continue;
      const double lag = seconds(std::prev(ahead)->first - stamp);
      if (lag > setup_.max_transform_age + 1e-6) return true;
    }
    return false;
  }
  bool isTooOld(Ns stamp) const { return isTooOld(stamp, ros_); }
  bool isTooOld(Ns stamp, Ns now) const {
    return setup_.max_pose_age > 0.0 && seconds(now - stamp) > setup_.max_pose_age + 1e-6;
  }
  static bool isSame(const Said& a, const Said& b) {
    return distanceOf(a, b) < 1e-4 && a.is_rehung == b.is_rehung;
  }

 private:
  const SimulatedLink& of(int link) const { return setup_.links[static_cast<std::size_t>(link)]; }
  double lasting() const {
    return setup_.max_pose_age > 0.0 ? setup_.max_pose_age : setup_.max_transform_age;
  }
  /// Whether what arrived then is not older than is allowed.
  bool isLately(Ns arrival) const {
    if (arrival == EVER || setup_.max_pose_age == 0.0) return arrival != EVER;
    return seconds(ros_ - arrival) <= 0.95 * setup_.max_pose_age;
  }
  /// At EVER: of any stamp.
  bool isLieOf(const Told& told, Ns stamp) const {
    return told.is_static_lie ||
           std::any_of(told.lies.begin(), told.lies.end(), [&](const Lie& lie) {
             return stamp == EVER ||
                    std::abs(seconds(stamp - lie.stamp)) <= setup_.max_transform_age;
           });
  }
  void endure() { is_ambiguous_for_ever_ |= setup_.max_pose_age == 0.0; }
  Ns after(Ns stamp, double span) const { return stamp + static_cast<Ns>(1e9 * span + 1e3); }
  /// By a sample that may contradict those around it, up to a gap away. It lasts to the first of
  /// the later samples that have arrived.
  void disturb(Told& told, Ns stamp) const {
    const double span = setup_.max_transform_age + lasting();
    const auto later = told.samples.upper_bound(after(stamp, span));
    const Ns end = later == told.samples.end() ? after(stamp, span) : later->first;
    told.disturbed.emplace_back(std::min(after(stamp, -span), after(ros_, -lasting())) - 2000, end);
  }

  void hearOn(Told& told, bool is_static);
  void forget(Ns clock);
  static bool wasSent(const Told& told, const Said& X_PB) {
    return std::any_of(told.statics.begin(), told.statics.end(),
                       [&](const auto& sent) { return isSame(sent.second, X_PB); });
  }
  void hearStatic(Told& told, const Said& X_PB, const std::string& publisher);
  std::optional<Pose> standing(const Told& told, Ns stamp) const;
  std::optional<Pose> moving(const Told& told, Ns stamp) const;

  const Scenario& setup_;
  std::vector<Told> told_;
  std::set<Ns> root_lies_;
  Ns ros_ = 0, newest_ = EVER;
  double steady_ = 0.0, last_step_ = 0.0;
  int pass_ = 0;
  bool is_ambiguous_for_ever_ = false;
};

}  // namespace simulation
