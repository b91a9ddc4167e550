#include "transform_gate.h"

#include <algorithm>

#include "user_text.h"

namespace collision_pairs {
namespace {

constexpr std::size_t MOST_NAMES = 10000;  // frames or publishers: names are external input

bool differ(const FramePose& a, const FramePose& b) {
  return a.parent != b.parent || distanceOf(a, b) > SAME_PLACE || angleOf(a, b) > SAME_PLACE;
}

std::string whyRefused(StampNs stamp, StampNs now, const StampLimits& limits) {
  if (stamp == 0) return "its stamp is zero";
  if (stamp - now > limits.tolerance) {
    return "its stamp is " + inWords(inSeconds(stamp - now)) + " ahead of the clock";
  }
  if (now - stamp > limits.max_age) {
    return "it was " + inWords(inSeconds(now - stamp)) +
           " old when it arrived, and max_pose_age is " + inWords(inSeconds(limits.max_age));
  }
  if (stamp > LAST_STAMP) return "its stamp is beyond what tf2 can store";
  return "";
}

}  // namespace

const char* const TransformGate::TOO_MANY_NODES = "too many nodes publish it";
const char* const TransformGate::SENT_ONCE =
    "several nodes publish it on /tf_static, and the newest pose was sent once; send it again";
const char* const TransformGate::CHANGED = "its static transform changed";
const char* const TransformGate::IS_ON_BOTH =
    "it is published both on /tf and on /tf_static, so its pose is ambiguous; stop one of the two "
    "publishers";

int Names::add(const std::string& name) {
  const int known = find(name);
  if (known >= 0 || all_.size() == MOST_NAMES) return known;
  numbers_.emplace(name, static_cast<int>(all_.size()));
  all_.push_back(name);
  return static_cast<int>(all_.size()) - 1;
}

int Names::find(const std::string& name) const {
  const auto found = numbers_.find(name);
  return found == numbers_.end() ? -1 : found->second;
}

TransformGate::TransformGate(const PoseLimits& limits)
    : limits_(limits),
      too_far_apart_("no two of its transforms around that stamp are within " +
                     inWords(inSeconds(limits_.max_gap)) + " of each other") {}

TransformGate::Answer TransformGate::admit(int number, const FramePose& pose, bool is_static,
                                           const std::string& publisher, StampNs stamp,
                                           StampNs now) {
  last_now_ = now;
  const std::string why = is_static ? "" : whyRefused(stamp, now, limits_);
  if (!why.empty()) return {Store::NOTHING, why};
  const int by = publishers_.add(publisher);
  if (by < 0) return {Store::NOTHING, "more than 10000 nodes publish on TF"};
  frames_.resize(names_.all().size());
  Frame& frame = frames_[number];
  const bool was_heard = frame.is_heard, was_static = frame.is_static;
  Answer answer =
      is_static ? admitStatic(frame, pose, by, now) : admitMoving(frame, pose, by, stamp, now);
  frame.is_heard = true;
  // By whichever kind it is noticed: the buffer stores nothing of the other.
  if (was_heard && frame.is_static != was_static) {
    answer.store = Store::KIND;
    frame.since = frame.is_static ? now : EVER_SINCE;
  }
  return answer;
}

StampNs TransformGate::endOfBoth(const Frame& frame) const {
  const StampNs moving = std::max(frame.last_moving, frame.both_since);
  const StampNs fixed = std::max(frame.last_static, frame.both_since);
  return after(std::min(moving, fixed), limits_.max_age);
}

/// Rules 5 and 6, but for a frame that becomes static after it was silent.
void TransformGate::noteKind(Frame& frame, bool is_static, StampNs now) {
  const auto isNewerStatic = [&] {
    const StampNs moving = std::max(frame.last_moving, frame.both_since);
    const StampNs fixed = std::max(frame.last_static, frame.both_since);
    return fixed == moving ? frame.is_static : fixed > moving;
  };
  if (frame.both_since != NEVER && endOfBoth(frame) <= now && limits_.max_age != NEVER) {
    const bool has_changed = isNewerStatic() != frame.is_static;
    frame.suspect[BOTH_KINDS].endBy(has_changed ? now : endOfBoth(frame));
    frame.is_static = frame.is_static != has_changed;
    if (has_changed && frame.is_static) {
      frame.static_pose = frame.newest_static;
      if (!frame.newest_counts) {
        frame.suspect[STATIC_POSE].add({before(now, limits_.lasting), NEVER}, SENT_ONCE);
      }
    }
    frame.both_since = NEVER;
  }
  const StampNs other = is_static ? frame.last_moving : frame.last_static;
  const StampNs silent = after(other, limits_.max_age);  // from then on
  const bool is_other_heard = other != EVER_SINCE && (is_static ? now <= silent : now < silent);
  const bool was_static = frame.is_static;
  (is_static ? frame.last_static : frame.last_moving) = now;
  const bool is_lasting = was_static || limits_.max_age == NEVER;  // static poses do not age
  const bool begins = is_other_heard || (was_static != is_static && is_lasting);
  if (frame.both_since == NEVER && begins) frame.both_since = now;
  if (frame.both_since == NEVER) return;
  SuspectSpans& spans = frame.suspect[BOTH_KINDS];
  spans.add({before(frame.both_since, limits_.max_age), NEVER}, IS_ON_BOTH);
  if (isNewerStatic() == frame.is_static) spans.endBy(endOfBoth(frame));
}

TransformGate::Answer TransformGate::admitStatic(Frame& frame, const FramePose& pose, int by,
                                                 StampNs now) {
  forget(frame, now);
  const bool is_again =
      std::any_of(frame.statics.begin(), frame.statics.end(),
                  [&](const StaticPose& sent) { return !differ(sent.pose, pose); });
  auto own = std::find_if(frame.statics.begin(), frame.statics.end(),
                          [&](const StaticPose& sent) { return sent.publisher == by; });
  if (own == frame.statics.end()) {
    if (frame.statics.size() == MOST_PUBLISHERS) return {Store::NOTHING, TOO_MANY_NODES};
    own = frame.statics.insert(own, {by, pose});
  }
  own->pose = pose;
  const bool counts = is_again || frame.statics.size() == 1;
  const auto note = [&] {  // after what it was noted for
    frame.newest_static = {by, pose};
    frame.newest_counts = counts;
  };
  if (!frame.is_heard) {
    note();
    frame.static_pose = frame.newest_static;
    frame.is_static = true;
    frame.last_static = now;
    return {Store::IT, ""};
  }
  const bool was_static = frame.is_static;
  noteKind(frame, true, now);
  note();
  SuspectSpans& spans = frame.suspect[STATIC_POSE];  // also of when it was static before
  if (counts && spans.isOpen()) spans.endBy(after(now, limits_.lasting));
  if (!frame.is_static) {
    if (frame.both_since != NEVER) return {Store::NOTHING, IS_ON_BOTH};
    if (!is_again) {
      return {Store::NOTHING,
              "it moved, so its static pose does not count before it is sent again"};
    }
    frame.is_static = true;
  }
  if (!was_static) frame.static_pose = frame.newest_static;
  std::string why = frame.both_since != NEVER ? IS_ON_BOTH : "";
  if (was_static && !differ(frame.static_pose.pose, pose)) return {Store::NOTHING, why};
  if (counts) {
    if (was_static) frame.since = reached(now);
    frame.static_pose = frame.newest_static;
    return {Store::IT, why};
  }
  const int other = frame.static_pose.publisher;
  why = other == by ? SENT_ONCE
                    : "'" + publishers_.all()[other] + "' and '" + publishers_.all()[by] +
                          "' contradict each other on /tf_static; stop one of them, and start "
                          "the other again";
  spans.add({before(now, limits_.lasting), NEVER}, why);
  return {Store::NOTHING, why};
}

void TransformGate::forget(Frame& frame, StampNs now) const {
  const StampNs late =
      limits_.max_age == NEVER ? limits_.kept : after(limits_.max_age, limits_.tolerance);
  const StampNs window =
      std::min(limits_.kept, after(after(late, limits_.max_gap), limits_.max_gap));
  const StampNs oldest = before(frame.newest, frame.newest == EVER_SINCE ? NEVER : window);
  for (Source& source : frame.sources) {
    while (!source.samples.empty() && source.samples.front().stamp < oldest) {
      source.samples.pop_front();
    }
  }
  const auto isOver = [](const Source& source) { return source.samples.empty(); };
  frame.sources.erase(std::remove_if(frame.sources.begin(), frame.sources.end(), isOver),
                      frame.sources.end());
  if (frame.newest != EVER_SINCE) {
    frame.oldest = std::max(frame.oldest, frame.newest - limits_.kept);
  }
  for (SuspectSpans& spans : frame.suspect) spans.forgetBefore(before(now, limits_.kept));
}

void TransformGate::restart(StampNs now) {
  for (Frame& frame : frames_) {
    const bool is_both = frame.both_since != NEVER && last_now_ < endOfBoth(frame);
    const bool is_open = frame.suspect[STATIC_POSE].isOpen();
    const std::string why = is_open ? *frame.suspect[STATIC_POSE].at(last_now_) : "";
    Frame fresh;
    fresh.is_heard = frame.is_heard;
    fresh.is_static = frame.is_static;
    fresh.statics = std::move(frame.statics);
    fresh.static_pose = frame.static_pose;  // of tf2's new buffer the only one
    fresh.newest_static = frame.newest_static;
    fresh.newest_counts = frame.newest_counts;
    if (is_open) fresh.suspect[STATIC_POSE].add({EVER_SINCE, NEVER}, why);
    if (is_both) {
      fresh.last_moving = fresh.last_static = fresh.both_since = now;
      fresh.suspect[BOTH_KINDS].add({before(now, limits_.max_age), endOfBoth(fresh)}, IS_ON_BOTH);
    }
    frame = std::move(fresh);
  }
  newest_ = EVER_SINCE;
  last_now_ = now;
}

bool TransformGate::isHeard(int number) const {
  return number < static_cast<int>(frames_.size()) && frames_[number].is_heard &&
         (frames_[number].is_static || !frames_[number].sources.empty());
}

StampNs TransformGate::newestStamp(int number) const {
  return number < static_cast<int>(frames_.size()) ? frames_[number].newest : EVER_SINCE;
}

StampNs TransformGate::newestAt(const Frame& frame, StampNs now) const {
  StampNs present = EVER_SINCE, ahead = NEVER;
  for (const Source& source : frame.sources) {
    const Place next = placeOf(source.samples, now + 1);
    if (next != source.samples.end()) ahead = std::min(ahead, next->stamp);
    if (next != source.samples.begin()) present = std::max(present, std::prev(next)->stamp);
  }
  const bool is_old = present == EVER_SINCE || now - present > limits_.max_age;
  return is_old && ahead != NEVER ? ahead : present;
}

StampNs TransformGate::newestAt(int number, StampNs now) const {
  return isStatic(number) ? NEVER : newestAt(frames_[number], now);
}

const std::string* TransformGate::whySuspectAt(const Frame& frame, StampNs stamp) {
  for (const Reason reason : {BOTH_KINDS, PUBLISHERS, GAP}) {
    if (const std::string* why = frame.suspect[reason].at(stamp)) return why;
  }
  return nullptr;
}

bool TransformGate::isKnown(int number, StampNs stamp) const {
  if (!isHeard(number)) return false;
  const Frame& frame = frames_[number];
  if (!frame.is_static) {
    return frame.oldest <= stamp && stamp <= frame.newest && !whySuspectAt(frame, stamp);
  }
  return stamp >= frame.since && !frame.suspect[BOTH_KINDS].at(stamp) &&
         !frame.suspect[STATIC_POSE].at(stamp);
}

bool TransformGate::isSettled(int number) const {
  const Frame& frame = frames_[number];
  return frame.since == EVER_SINCE && frame.suspect[BOTH_KINDS].size() == 0 &&
         frame.suspect[STATIC_POSE].size() == 0;
}

std::string TransformGate::whyUnknown(int number, StampNs stamp) const {
  if (number >= static_cast<int>(frames_.size()) || !frames_[number].is_heard) {
    return "TF does not say where it is";
  }
  const Frame& frame = frames_[number];
  if (const std::string* both = frame.suspect[BOTH_KINDS].at(stamp)) return *both;
  if (frame.is_static) {
    const std::string* why = frame.suspect[STATIC_POSE].at(stamp);
    return why ? *why : CHANGED;
  }
  if (const std::string* why = whySuspectAt(frame, stamp)) return *why;
  if (frame.newest == EVER_SINCE) {
    return "no transform of it was received since the clock went back";
  }
  if (stamp > frame.newest) {
    return "its newest transform is " + inWords(inSeconds(stamp - frame.newest)) +
           " older than that stamp (no extrapolation)";
  }
  return too_far_apart_;
}

int TransformGate::parentAt(int number, StampNs stamp) const {
  if (number >= static_cast<int>(frames_.size())) return -1;  // named by what was refused only
  if (frames_[number].is_static) return frames_[number].static_pose.pose.parent;
  return stamp >= frames_[number].parent_since ? frames_[number].parent : -1;
}

std::size_t TransformGate::nbKept(int number) const {
  std::size_t count = frames_[number].statics.size();
  for (const Source& source : frames_[number].sources) count += source.samples.size();
  for (const SuspectSpans& spans : frames_[number].suspect) count += spans.size();
  return count;
}

}  // namespace collision_pairs
