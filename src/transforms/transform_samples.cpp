// Samples of frames that move: rules 1 to 4 of the gate.
#include <algorithm>

#include "transform_gate.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

const char* const PARENT_CHANGES = "its parent changes between two of its transforms";

/// Of a sample among those of one publisher around its stamp, unless they are too far apart.
template <class Samples>
bool contradictsAt(const Samples& others, typename Samples::const_iterator after, StampNs stamp,
                   const FramePose& pose, StampNs max_gap, std::string& how) {
  if (after == others.end()) return false;
  auto before = after;
  if (after->stamp != stamp) {
    if (after == others.begin()) return false;
    before = std::prev(after);
    if (after->stamp - before->stamp > max_gap) return false;
  }
  const bool has_earlier =
      before != others.begin() && before->stamp - std::prev(before)->stamp <= max_gap;
  const auto earlier = has_earlier ? std::prev(before) : before;
  return contradicts(pose, earlier->pose, before->pose, after->pose, how);
}

}  // namespace

bool contradicts(const FramePose& sample, const FramePose& earlier, const FramePose& before,
                 const FramePose& after, std::string& how) {
  if (sample.parent != before.parent && sample.parent != after.parent) {
    how = "they name different parents";
    return true;
  }
  if (before.parent != after.parent) return false;
  const bool has_earlier = earlier.parent == before.parent;
  const auto far = [&](double (*measure)(const FramePose&, const FramePose&), double& off) {
    const double step =
        std::max(measure(before, after), has_earlier ? measure(earlier, before) : 0.0);
    off = std::min(measure(sample, before), measure(sample, after));
    return off > step + SAME_PLACE;
  };
  double metres = 0.0, radians = 0.0;
  const bool is_far = far(distanceOf, metres), is_turned = far(angleOf, radians);
  if (!is_far && !is_turned) return false;
  how = formatted("by %.4g m and %.4g rad", metres, radians);
  return true;
}

TransformGate::Answer TransformGate::admitMoving(Frame& frame, const FramePose& pose, int by,
                                                 StampNs stamp, StampNs now) {
  if (frame.newest != EVER_SINCE && frame.newest - stamp > limits_.kept) {
    return {Store::NOTHING, "it is older than what is kept"};
  }
  noteKind(frame, false, now);
  // While it counts as static, samples are kept for what they say of publishers once it moves.
  const bool is_stored =
      std::any_of(frame.sources.begin(), frame.sources.end(), [&](const Source& source) {
        const Place place = placeOf(source.samples, stamp);
        return place != source.samples.end() && place->stamp == stamp;
      });
  Source* source = sourceOf(frame, by);
  if (!source) return {Store::NOTHING, TOO_MANY_NODES};
  std::string why, how;
  auto place =
      source->samples.begin() + (placeOf(source->samples, stamp) - source->samples.cbegin());
  if (place != source->samples.end()) {  // out of order
    if (contradictsAt(source->samples, Place(place), stamp, pose, limits_.max_gap, how)) {
      why = note(frame, *source, place, by, now, how);
    }
    if (place->stamp == stamp) return {Store::NOTHING, why};  // the first one stays
  }
  place = source->samples.insert(place, {stamp, pose});
  noteParent(frame, pose.parent, stamp);
  noteSample(frame, source->samples, place);
  newest_ = std::max(newest_, stamp);
  const std::string other = compare(frame, *source, place, now);
  if (!other.empty()) why = other;
  forget(frame, now);
  if (frame.both_since != NEVER) why = IS_ON_BOTH;
  if (frame.is_static) return {Store::NOTHING, IS_ON_BOTH};
  return {is_stored ? Store::NOTHING : Store::IT, why};
}

TransformGate::Source* TransformGate::sourceOf(Frame& frame, int publisher) const {
  for (Source& source : frame.sources) {
    if (source.publisher == publisher) return &source;
  }
  if (frame.sources.size() == MOST_PUBLISHERS) return nullptr;
  frame.sources.push_back({publisher, {}});
  return &frame.sources.back();
}

/// Rule 2. Known are the stamps of samples, and those between two of one publisher.
void TransformGate::noteSample(Frame& frame, const Samples& samples, Place added) {
  const StampNs stamp = added->stamp;
  SuspectSpans& gaps = frame.suspect[GAP];
  if (frame.newest == EVER_SINCE) {
    frame.oldest = frame.newest = stamp;
  } else if (stamp > frame.newest) {
    const bool is_bridged = added != samples.begin() && isBridge(frame, *std::prev(added), *added);
    if (!is_bridged) {
      const std::string* why = whySuspectAt(frame, frame.newest);
      const bool is_rehung = added != samples.begin() &&
                             stamp - std::prev(added)->stamp <= limits_.max_gap &&
                             added->pose.parent != std::prev(added)->pose.parent;
      gaps.add({frame.newest, stamp}, why ? *why : is_rehung ? PARENT_CHANGES : too_far_apart_);
    }
    frame.newest = stamp;
  } else if (stamp < frame.oldest) {
    gaps.add({stamp - 1, frame.oldest}, too_far_apart_);
    frame.oldest = stamp;
  }
  gaps.remove(stamp, stamp);
  if (added != samples.begin() && isBridge(frame, *std::prev(added), *added)) {
    gaps.remove(std::prev(added)->stamp, stamp);
  }
  const Place next = std::next(added);
  if (next != samples.end() && isBridge(frame, *added, *next)) gaps.remove(stamp, next->stamp);
}

/// Whether a pose between two consecutive samples of one publisher is known.
bool TransformGate::isBridge(const Frame& frame, const Sample& from, const Sample& to) const {
  // tf2 does not interpolate between parents: it would hold the earlier pose.
  return to.stamp - from.stamp <= limits_.max_gap && to.pose.parent == from.pose.parent &&
         !whySuspectAt(frame, from.stamp);
}

void TransformGate::noteParent(Frame& frame, int parent, StampNs stamp) {
  const bool is_newest = stamp > frame.newest;
  if (frame.parent != parent && frame.newest != EVER_SINCE) {
    frame.parent_since = is_newest ? stamp : frame.newest;
  }
  if (is_newest) frame.parent = parent;
}

/// Rule 3: the added sample with the other publishers' neighbours, and their samples with it and
/// its neighbours.
std::string TransformGate::compare(Frame& frame, const Source& source, Place added, StampNs now) {
  const Samples& samples = source.samples;
  const Place first = added == samples.begin() ? added : std::prev(added);
  const Place next = std::next(added);
  const StampNs last = next == samples.end() ? added->stamp : next->stamp;
  std::string why, how;
  for (const Source& other : frame.sources) {
    if (&other == &source || other.samples.empty()) continue;
    const Samples& theirs = other.samples;
    if (contradictsAt(theirs, placeOf(theirs, added->stamp), added->stamp, added->pose,
                      limits_.max_gap, how)) {
      why = note(frame, source, added, other.publisher, now, how);
    }
    for (Place their = placeOf(theirs, first->stamp); their != theirs.end() && their->stamp <= last;
         ++their) {
      const Place after = their->stamp <= added->stamp ? added : next;
      if (!contradictsAt(samples, after, their->stamp, their->pose, limits_.max_gap, how)) continue;
      why = note(frame, other, their, source.publisher, now, how);
    }
  }
  return why;
}

/// Rule 4, after that sample of `source` was found to contradict `other`.
std::string TransformGate::note(Frame& frame, const Source& source, Place sample, int other,
                                StampNs now, const std::string& how) {
  const auto [first, second] = std::minmax(source.publisher, other);
  const std::vector<std::string>& names = publishers_.all();
  const std::string by = first == second
                             ? "'" + names[first] + "' publishes it in two sequences"
                             : "'" + names[first] + "' and '" + names[second] + "' both publish it";
  const std::string why = by + ", and contradict each other: " + how;
  const bool is_first = sample == source.samples.begin();
  const StampNs since = is_first ? sample->stamp - 1 : std::prev(sample)->stamp;
  // Before the next sample of all it would be interpolated from a suspect one.
  const StampNs end = after(sample->stamp, limits_.lasting);
  StampNs next = NEVER;
  for (const Source& of : frame.sources) {
    const Place from = placeOf(of.samples, end);
    if (from != of.samples.end()) next = std::min(next, from->stamp);
  }
  frame.suspect[PUBLISHERS].add(
      {std::min(since, before(now, limits_.lasting)), next == NEVER ? end : next}, why);
  return why;
}

}  // namespace collision_pairs
