// A quantity over time as one or more publishers tell it: the rules for stamps, gaps, silence and
// contradiction that transforms and joint positions have in common, live and recorded.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace collision_pairs {

/// Nanoseconds since the epoch.
using StampNs = std::int64_t;

constexpr StampNs NEVER = std::numeric_limits<StampNs>::max();
constexpr StampNs EVER_SINCE = std::numeric_limits<StampNs>::min();

inline double inSeconds(StampNs span) { return 1e-9 * static_cast<double>(span); }

/// Limits for poses and their stamps, in seconds. The node's parameters have the same names.
struct PoseLimits {
  /// A pose older than this relative to now is not used; 0: no limit.
  double max_pose_age = 1.0;
  /// … nor one older than this relative to the newest of all links. Between two transforms further
  /// apart than this nothing is interpolated.
  double max_transform_age = 1.0;
  /// A stamp further ahead of now is refused, because clocks of computers differ by less.
  double clock_tolerance = 0.5;
};

/// The same in nanoseconds.
struct TrackLimits {
  TrackLimits(const PoseLimits& limits, bool keeps_all);
  StampNs max_age;  ///< NEVER: no limit
  StampNs max_gap, tolerance;
  StampNs kept;  ///< history before the newest stamp
};

/// Why a sample of this stamp that arrives at `now` is refused; empty if it is not. One that is
/// already too old on arrival is refused, since nothing that it says could ever be used in time.
std::string whyRefused(StampNs stamp, StampNs now, const TrackLimits& limits);

/// Open at both ends.
struct Span {
  StampNs begin, end;
  bool contains(StampNs stamp) const { return begin < stamp && stamp < end; }
};

/// Who sent a sample, and when it arrived.
struct Arrival {
  int publisher;
  StampNs stamp;
  StampNs now;
  /// `now`, or beyond the newest stamp of whatever is looked up together with it, if that is ahead:
  /// no look-up so far was as late.
  StampNs reached;
};

struct Doubt {
  Span span;
  int first, second;  ///< publishers
  std::string why;
};

/// Samples by publisher. Between two samples of one publisher a value is known unless they are too
/// far apart; never between those of two, and never beyond the newest one.
///
/// Two publishers contradict each other if a sample of one is further from both neighbours in time
/// of the other than those neighbours, and the one before them, are from each other: then no
/// reasonable interpolation explains it. In doubt are stamps from max_age (or max_gap, if there is
/// no such limit) before that was noticed, which are still being looked up, until the same time
/// after the contradicting sample. So does one publisher with itself whose samples arrive out of
/// order, as those of two do that are played from a bag.
///
/// Value: `bool contradicts(sample, earlier, before, after, how)` and `bool areConnected(a, b)`,
/// true if who knows where one is knows where the other is; found by its type.
template <class Value>
class Track {
 public:
  struct Sample {
    StampNs stamp;
    Value value;
  };
  struct Neighbours {
    const Value* before = nullptr;
    const Value* after = nullptr;
    double share = 0.0;  ///< of the way from `before` to `after`
    StampNs since = 0;   ///< stamp of `before`
  };

  /// Returns why its values are in doubt, or why it was refused; empty if all is well. `names`: of
  /// the publishers; `is_in_doubt`: for other reasons. Cost: O(publishers * log samples) for
  /// samples in order.
  std::string add(
      const Arrival& arrival, const Value& value, const TrackLimits& limits,
      const std::vector<std::string>& names,
      const std::function<bool(StampNs)>& is_in_doubt = [](StampNs) { return false; });

  bool empty() const { return sources_.empty(); }
  /// Of all publishers; EVER_SINCE if there is none.
  StampNs newest() const;
  /// The newest stamp that `now` has reached, unless it is too old and there is one ahead of now.
  StampNs newestAt(StampNs now, StampNs max_age) const;
  bool find(StampNs stamp, StampNs max_gap, Neighbours& found) const;
  const Doubt* doubtAt(StampNs stamp) const;
  /// True if at that instant, live, the newest sample that had arrived was too old or in doubt.
  bool wasSilentAt(StampNs stamp) const;
  void clear() { *this = Track(); }

 private:
  struct Source {
    int publisher;
    std::deque<Sample> samples;  ///< by stamp, each once
  };
  using Place = typename std::deque<Sample>::const_iterator;

  static Place placeOf(const Source& source, StampNs stamp) {
    return std::lower_bound(source.samples.begin(), source.samples.end(), stamp,
                            [](const Sample& s, StampNs t) { return s.stamp < t; });
  }
  /// The stamps in doubt after that sample of a publisher was found to contradict another one.
  static Span doubtful(const Source& source, Place sample, StampNs now, const TrackLimits& limits) {
    const StampNs lasting = limits.max_age == NEVER ? limits.max_gap : limits.max_age;
    const bool is_first = sample == source.samples.begin();
    const StampNs interpolated = is_first ? sample->stamp - 1 : std::prev(sample)->stamp;
    return {std::min(interpolated, now - lasting), sample->stamp + lasting};
  }
  Source* sourceOf(int publisher);
  /// True if one publisher's samples tell all values within, from none that is in doubt.
  bool isBridged(const Span& span, StampNs max_gap,
                 const std::function<bool(StampNs)>& is_in_doubt) const;
  void noteSilence(const Span& span);
  void forget(const TrackLimits& limits);
  std::string compare(const Source& source, Place added, StampNs now, const TrackLimits& limits,
                      const std::vector<std::string>& names);
  static bool contradictsBetween(const Source& other, Place after, const Sample& sample,
                                 StampNs max_gap, std::string& how);
  std::string note(Span span, int first, int second, const std::string& how,
                   const std::vector<std::string>& names);

  std::vector<Source> sources_;
  std::vector<Doubt> doubts_;
  std::vector<Span> silences_;
};

template <class Value>
StampNs Track<Value>::newest() const {
  StampNs newest = EVER_SINCE;
  for (const Source& source : sources_) newest = std::max(newest, source.samples.back().stamp);
  return newest;
}

template <class Value>
StampNs Track<Value>::newestAt(StampNs now, StampNs max_age) const {
  StampNs present = EVER_SINCE, ahead = NEVER;
  for (const Source& source : sources_) {
    if (source.samples.back().stamp <= now) {
      present = std::max(present, source.samples.back().stamp);
      continue;
    }
    const Place next = placeOf(source, now + 1);
    ahead = std::min(ahead, next->stamp);
    if (next != source.samples.begin()) present = std::max(present, std::prev(next)->stamp);
  }
  const bool is_old = present == EVER_SINCE || now - present > max_age;
  return is_old && ahead != NEVER ? ahead : present;
}

template <class Value>
bool Track<Value>::find(StampNs stamp, StampNs max_gap, Neighbours& found) const {
  StampNs narrowest = NEVER;
  for (const Source& source : sources_) {
    if (source.samples.back().stamp < stamp) continue;
    const Place after = source.samples.back().stamp == stamp ? std::prev(source.samples.end())
                                                             : placeOf(source, stamp);
    if (after->stamp == stamp) {
      found = {&after->value, &after->value, 0.0, stamp};
      return true;
    }
    if (after == source.samples.begin()) continue;
    const Place before = std::prev(after);
    const StampNs between = after->stamp - before->stamp;
    if (between > max_gap || between >= narrowest) continue;
    narrowest = between;
    found = {&before->value, &after->value,
             static_cast<double>(stamp - before->stamp) / static_cast<double>(between),
             before->stamp};
  }
  return narrowest != NEVER;
}

template <class Value>
const Doubt* Track<Value>::doubtAt(StampNs stamp) const {
  for (const Doubt& doubt : doubts_) {
    if (doubt.span.contains(stamp)) return &doubt;
  }
  return nullptr;
}

template <class Value>
bool Track<Value>::wasSilentAt(StampNs stamp) const {
  return std::any_of(silences_.begin(), silences_.end(),
                     [&](const Span& silence) { return silence.contains(stamp); });
}

template <class Value>
typename Track<Value>::Source* Track<Value>::sourceOf(int publisher) {
  constexpr std::size_t MOST = 16;  // publishers of one frame: names are external input
  for (Source& source : sources_) {
    if (source.publisher == publisher) return &source;
  }
  if (sources_.size() == MOST) return nullptr;
  sources_.push_back({publisher, {}});
  return &sources_.back();
}

template <class Value>
bool Track<Value>::isBridged(const Span& span, StampNs max_gap,
                             const std::function<bool(StampNs)>& is_in_doubt) const {
  return std::any_of(sources_.begin(), sources_.end(), [&](const Source& source) {
    const StampNs first = span.begin + 1, last = span.end - 1;
    const auto isGap = [&](Place after) {
      if (after == source.samples.begin() || after == source.samples.end()) return true;
      const StampNs since = std::prev(after)->stamp;
      return after->stamp - since > max_gap || doubtAt(since) || is_in_doubt(since);
    };
    Place after = placeOf(source, first);
    if (after == source.samples.end() || (after->stamp > first && isGap(after))) return false;
    while (after->stamp < last) {
      if (isGap(++after)) return false;
    }
    return true;
  });
}

template <class Value>
std::string Track<Value>::add(const Arrival& arrival, const Value& value, const TrackLimits& limits,
                              const std::vector<std::string>& names,
                              const std::function<bool(StampNs)>& is_in_doubt) {
  const auto [publisher, stamp, now, reached] = arrival;
  const StampNs before = newest();
  if (before != EVER_SINCE && before - stamp > limits.kept) {
    return "it is older than what is kept";
  }
  // Before the source is added, which has no sample yet.
  const StampNs used = newestAt(now, limits.max_age);
  Neighbours last;
  const bool was_known = before != EVER_SINCE && now - used <= limits.max_age &&
                         reached - used <= limits.max_gap && !doubtAt(used) && !is_in_doubt(used) &&
                         find(used, 0, last) && areConnected(*last.before, value);
  Source* source = sourceOf(publisher);
  if (!source) return "too many nodes publish it";
  auto place = source->samples.end();
  std::string why, how;
  if (!source->samples.empty() && source->samples.back().stamp >= stamp) {  // out of order
    place = source->samples.begin() + (placeOf(*source, stamp) - source->samples.cbegin());
    if (contradictsBetween(*source, place, {stamp, value}, limits.max_gap, how)) {
      why = note(doubtful(*source, place, now, limits), publisher, publisher, how, names);
    }
    if (place->stamp == stamp) return why;  // the first one stays
  }
  if (!was_known && limits.max_age != NEVER) noteSilence({used, reached});
  // What it tells of earlier stamps was not known until now.
  const Span filled{place == source->samples.begin() ? stamp - 1 : std::prev(place)->stamp,
                    std::min(before, place == source->samples.end() ? stamp + 1 : place->stamp)};
  if (filled.begin < filled.end && !isBridged(filled, limits.max_gap, is_in_doubt))
    noteSilence(filled);
  place = source->samples.insert(place, {stamp, value});
  const std::string other = compare(*source, place, now, limits, names);
  if (limits.kept != NEVER) forget(limits);
  return other.empty() ? why : other;
}

/// One that goes on is one entry.
template <class Value>
void Track<Value>::noteSilence(const Span& span) {
  if (silences_.empty() || span.begin > silences_.back().end || span.end < silences_.back().begin) {
    return silences_.push_back(span);
  }
  Span& last = silences_.back();
  last = {std::min(last.begin, span.begin), std::max(last.end, span.end)};
}

template <class Value>
void Track<Value>::forget(const TrackLimits& limits) {
  const StampNs oldest = newest() - limits.kept;
  for (Source& source : sources_) {
    while (!source.samples.empty() && source.samples.front().stamp < oldest) {
      source.samples.pop_front();
    }
  }
  const auto erase = [](auto& list, const auto& is_over) {
    if (!list.empty()) list.erase(std::remove_if(list.begin(), list.end(), is_over), list.end());
  };
  erase(sources_, [](const Source& source) { return source.samples.empty(); });
  erase(doubts_, [&](const Doubt& doubt) { return doubt.span.end < oldest; });
  erase(silences_, [&](const Span& silence) { return silence.end < oldest; });
}

template <class Value>
bool Track<Value>::contradictsBetween(const Source& other, Place after, const Sample& sample,
                                      StampNs max_gap, std::string& how) {
  if (after == other.samples.end()) return false;
  Place before = after;
  if (after->stamp != sample.stamp) {
    if (after == other.samples.begin()) return false;
    before = std::prev(after);
    if (after->stamp - before->stamp > max_gap) return false;
  }
  const bool has_earlier =
      before != other.samples.begin() && before->stamp - std::prev(before)->stamp <= max_gap;
  const Place earlier = has_earlier ? std::prev(before) : before;
  return contradicts(sample.value, earlier->value, before->value, after->value, how);
}

/// Compares the added sample with the other publishers' neighbours, and their samples with it and
/// its neighbours.
template <class Value>
std::string Track<Value>::compare(const Source& source, Place added, StampNs now,
                                  const TrackLimits& limits,
                                  const std::vector<std::string>& names) {
  const Place first = added == source.samples.begin() ? added : std::prev(added);
  const Place next = std::next(added);
  const StampNs last = next == source.samples.end() ? added->stamp : next->stamp;
  std::string why, how;
  for (const Source& other : sources_) {
    if (&other == &source || other.samples.empty()) continue;
    if (contradictsBetween(other, placeOf(other, added->stamp), *added, limits.max_gap, how)) {
      why =
          note(doubtful(source, added, now, limits), source.publisher, other.publisher, how, names);
    }
    for (Place theirs = placeOf(other, first->stamp);
         theirs != other.samples.end() && theirs->stamp <= last; ++theirs) {
      const Place after = theirs->stamp <= added->stamp ? added : next;
      if (!contradictsBetween(source, after, *theirs, limits.max_gap, how)) continue;
      why =
          note(doubtful(other, theirs, now, limits), source.publisher, other.publisher, how, names);
    }
  }
  return why;
}

/// A contradiction that goes on is one doubt.
template <class Value>
std::string Track<Value>::note(Span span, int first, int second, const std::string& how,
                               const std::vector<std::string>& names) {
  if (first > second) std::swap(first, second);
  const std::string by = first == second
                             ? "'" + names[first] + "' publishes it in two sequences"
                             : "'" + names[first] + "' and '" + names[second] + "' both publish it";
  const std::string why = by + ", and contradict each other: " + how;
  for (Doubt& doubt : doubts_) {
    if (doubt.first != first || doubt.second != second || span.begin > doubt.span.end ||
        span.end < doubt.span.begin) {
      continue;
    }
    doubt.span = {std::min(doubt.span.begin, span.begin), std::max(doubt.span.end, span.end)};
    doubt.why = why;
    return why;
  }
  doubts_.push_back({span, first, second, why});
  return why;
}

}  // namespace collision_pairs
