#include "stamps.h"

#include <algorithm>
#include <cmath>

#include "user_text.h"

namespace collision_pairs {
namespace {

constexpr double KEPT = 10.0;              // s of history, as in tf2
constexpr std::size_t MOST_SPANS = 10000;  // stamps are external input

StampNs nanoseconds(double seconds) {
  return seconds < 9e9 ? static_cast<StampNs>(std::llround(1e9 * seconds)) : NEVER;
}

}  // namespace

StampLimits::StampLimits(const PoseLimits& limits)
    : max_age(limits.max_pose_age == 0.0 ? NEVER : nanoseconds(limits.max_pose_age)),
      max_gap(nanoseconds(limits.max_transform_age)),
      tolerance(nanoseconds(limits.clock_tolerance)),
      kept(nanoseconds(KEPT)),
      lasting(max_age == NEVER ? max_gap : max_age) {}

std::string whyBehind(StampNs lag, const StampLimits& limits) {
  if (lag <= limits.max_gap) return "";
  return "its newest transform is " + inWords(inSeconds(lag)) +
         " older than the newest of all links, and max_transform_age is " +
         inWords(inSeconds(limits.max_gap));
}

std::vector<SuspectSpans::Suspect>::iterator SuspectSpans::firstEndingAfter(StampNs stamp) {
  return std::upper_bound(spans_.begin(), spans_.end(), stamp,
                          [](StampNs s, const Suspect& suspect) { return s < suspect.span.end; });
}

void SuspectSpans::add(Span span, std::string why) {
  if (span.begin >= span.end) return;
  const auto first = firstEndingAfter(span.begin);
  auto last = first;
  for (; last != spans_.end() && last->span.begin < span.end; ++last) {
    span = {std::min(span.begin, last->span.begin), std::max(span.end, last->span.end)};
  }
  if (first != last) {
    *first = {span, std::move(why)};
    spans_.erase(std::next(first), last);
    return;
  }
  spans_.insert(first, {span, std::move(why)});
  if (spans_.size() <= MOST_SPANS) return;
  spans_[1].span.begin = spans_[0].span.begin;
  spans_.erase(spans_.begin());
}

const std::string* SuspectSpans::at(StampNs stamp) const {
  const auto found = const_cast<SuspectSpans*>(this)->firstEndingAfter(stamp);
  return found != spans_.end() && found->span.begin < stamp ? &found->why : nullptr;
}

void SuspectSpans::remove(StampNs begin, StampNs end) {
  const auto first = firstEndingAfter(begin);
  auto last = first;
  std::vector<Suspect> rest;
  for (; last != spans_.end() && last->span.begin < end; ++last) {
    const Span span = last->span;
    if (span.begin < begin) rest.push_back({{span.begin, begin}, last->why});
    if (end < span.end) rest.push_back({{end, span.end}, last->why});
  }
  spans_.insert(spans_.erase(first, last), rest.begin(), rest.end());
}

void SuspectSpans::endBy(StampNs end) {
  if (spans_.empty()) return;
  spans_.back().span.end = std::min(spans_.back().span.end, end);
  if (spans_.back().span.begin >= spans_.back().span.end) spans_.pop_back();
}

void SuspectSpans::forgetBefore(StampNs stamp) {
  spans_.erase(spans_.begin(), firstEndingAfter(stamp));
}

}  // namespace collision_pairs
