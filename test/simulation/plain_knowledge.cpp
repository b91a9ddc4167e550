// What becomes of what a simulated node hears.
#include "plain_knowledge.h"

namespace simulation {

/// A frame is not used while it is heard of on both topics. It is of the kind that goes on alone
/// for max_pose_age, which is seen by what is heard then.
void Knowledge::hearOn(Told& told, bool is_static) {
  const Ns last = std::max(told.moved, told.stood);
  const Ns end = told.run_begin + static_cast<Ns>(1e9 * setup_.max_pose_age);
  (is_static ? told.stood : told.moved) = ros_;
  if (!told.is_heard) told.is_static = is_static;
  told.is_heard = true;
  if (told.is_settled && is_static == told.is_static) return;
  if (told.is_settled || is_static != told.is_run_static) {
    endure();
    const bool may_be_over = told.has_run || told.is_run_vague || told.is_static_again;
    told.is_run_vague = !told.is_settled && may_be_over;
    told.is_plain = told.is_settled = told.has_run = told.is_static_again = false;
    told.is_run_static = is_static;
    told.run_begin = ros_;
  } else if (ros_ > last && ros_ < end) {
    told.has_run = told.has_run || ros_ > told.run_begin;
  } else if (setup_.max_pose_age > 0.0 && (!told.has_run || (ros_ == end && is_static))) {
    // Sent twice at once, by a relay, its static pose may count since then.
    told.is_run_vague = told.is_run_vague || (is_static && told.is_static_again);
    told.run_begin = ros_;
    told.has_run = false;
  } else if (setup_.max_pose_age > 0.0 && ros_ > last && is_static && !told.is_static_again) {
    told.is_run_vague = true;  // after silence, what moved has to be sent again
  } else if (setup_.max_pose_age > 0.0 && ros_ > last) {
    told.is_settled = true;
    told.was_static = told.is_static;
    told.is_static = is_static;
    told.settled_since = ros_;
  }
}

/// All but static poses: the clock went back to `clock`.
void Knowledge::forget(Ns clock) {
  for (Told& told : told_) {
    Told fresh;
    fresh.is_lied_about = fresh.is_static_lie = told.is_static_lie;
    fresh.is_plain = !told.is_static_lie && told.statics.size() < 2 && told.is_settled;
    fresh.is_heard = told.is_heard;
    fresh.is_static = told.is_static;
    fresh.is_settled = told.is_settled;
    fresh.is_run_static = told.is_run_static;
    fresh.is_static_again = told.is_static_again;
    // Else it begins with what is heard next, or has begun if nothing else was heard meanwhile.
    const bool goes_on = isOnBoth(told);
    fresh.is_run_vague = !told.is_settled && (told.is_run_vague || !goes_on);
    if (!told.is_settled && goes_on) fresh.run_begin = fresh.moved = fresh.stood = clock;
    fresh.statics = told.statics;
    if (!told.static_poses.empty()) fresh.static_poses = {{EVER, told.static_poses.back().second}};
    if (told.open_since) fresh.open_since = EVER;
    told = fresh;
  }
  ros_ = clock;
  root_lies_.clear();
  newest_ = EVER;
  ++pass_;
}

/// The newest pose counts that was sent twice, or by one node alone.
void Knowledge::hearStatic(Told& told, const Said& X_PB, const std::string& publisher) {
  const auto isThis = [&](const Said& pose) { return isSame(pose, X_PB); };
  const bool is_again = wasSent(told, X_PB);
  told.statics[publisher] = X_PB;
  const bool counts = is_again || told.statics.size() == 1;
  const bool is_first = told.static_poses.empty();
  if (publisher != "honest") told.is_plain = false;
  if (counts && told.open_since) told.disturbed.emplace_back(EVER, after(ros_, lasting()));
  if (counts) told.open_since.reset();
  if (is_first) told.static_poses.emplace_back(EVER, X_PB);
  if (is_first || isThis(told.static_poses.back().second)) return;
  told.is_plain = false;
  told.disturbed.emplace_back(after(ros_, -lasting()) - 2000, std::max(ros_, newest_));
  if (counts) told.static_poses.emplace_back(ros_, X_PB);
  if (!counts && !told.open_since) told.open_since = ros_;
}

/// Not at stamps before it changed or came to stand, nor while it is open what counts.
std::optional<Pose> Knowledge::standing(const Told& told, Ns stamp) const {
  if (told.static_poses.empty()) return std::nullopt;
  if (told.open_since &&
      (*told.open_since == EVER || seconds(*told.open_since - stamp) < lasting())) {
    return std::nullopt;
  }
  const auto& [since, pose] = told.static_poses.back();
  if (stamp < std::max(since, told.settled_since)) return std::nullopt;
  return pose;
}

std::optional<Pose> Knowledge::moving(const Told& told, Ns stamp) const {
  const auto after = told.samples.lower_bound(stamp);
  if (after == told.samples.end()) return std::nullopt;
  if (after->first == stamp) return after->second;
  if (after == told.samples.begin()) return std::nullopt;
  const auto before = std::prev(after);
  if (before->second.is_rehung != after->second.is_rehung) return std::nullopt;
  const double gap = seconds(after->first - before->first);
  if (gap > setup_.max_transform_age) return std::nullopt;
  return between(before->second, after->second, seconds(stamp - before->first) / gap);
}

bool Knowledge::isHeld(int link) const {
  for (const int i : setup_.pathTo(link)) {
    const bool may_stand = of(i).joint == SimulatedLink::FIXED || setup_.isBase(i);
    const Told& told = this->told(i);
    if (!may_stand && told.is_settled && told.is_static && !of(i).is_listed) return true;
  }
  return false;
}

bool Knowledge::isNamed(int link) const {
  for (int i = 0; i < static_cast<int>(told_.size()); ++i) {
    const bool is_end = of(i).parent == link || setup_.hungFrame(i) == linkName(link);
    if (is_end && told(i).is_heard) return true;
  }
  return false;
}

bool Knowledge::isCycle(Ns stamp) const {
  const double lasts = std::min(5.0, setup_.max_pose_age > 0.0 ? setup_.max_pose_age : 5.0) - 1e-6;
  const auto wasHeard = [&](const auto& stamps, auto stampOf) {
    const auto after = stamps.upper_bound(stamp);
    return after != stamps.begin() && seconds(stamp - stampOf(*std::prev(after))) < lasts;
  };
  if (!wasHeard(root_lies_, [](Ns lie) { return lie; })) return false;
  int nb_moving = 0;
  bool is_by_its_frame = true;
  for (int link = setup_.cycle_through; link >= 0; link = of(link).parent) {
    const bool is_fixed = of(link).joint == SimulatedLink::FIXED;
    if (of(link).is_led_away && is_by_its_frame) return false;
    is_by_its_frame = !is_fixed;
    if (is_fixed) continue;
    const Told& told = this->told(link);
    if (told.is_lied_about || !told.is_settled) return false;
    ++nb_moving;
    const bool is_heard =
        told.is_static ? standing(told, stamp).has_value()
                       : wasHeard(told.samples, [](const auto& sample) { return sample.first; });
    if (!is_heard) return false;
  }
  // That links of one body hang on each other in another order than in the URDF is none.
  const bool is_of_body = setup_.is_apart && of(setup_.cycle_through).joint == SimulatedLink::FIXED;
  return nb_moving > (is_of_body ? 1 : 0);
}

bool Knowledge::isForbidden(int link, Ns stamp) const {
  for (const int i : setup_.pathTo(link)) {
    const Told& told = this->told(i);
    const bool has_begun = told.is_settled && told.was_static && !told.is_static;
    if (told.is_lied_about) return false;  // the lie may lead past the rest
    if (told.is_run_vague) continue;
    const bool has_stopped =
        told.is_settled && told.is_static && !told.was_static && told.settled_since != EVER;
    if (has_stopped && seconds(told.run_begin - stamp) > 0.11) return true;  // then it moved
    const Ns alone = told.stood == EVER ? stamp : told.stood;  // at least until max_pose_age later
    const Ns end = std::min(told.settled_since, alone + static_cast<Ns>(1e9 * setup_.max_pose_age));
    if (has_begun && told.run_begin < stamp && stamp < end) return true;
    const bool is_new = told.samples.empty() || told.samples.rbegin()->first < stamp;
    const bool is_one = !told.is_settled && !told.is_static && told.is_run_static;
    if (is_one && is_new && !told.is_static_again) return true;
  }
  return false;
}

}  // namespace simulation
