// The remaining work of a search along a motion: intervals, and the pairs open on them.
#pragma once

#include <algorithm>
#include <vector>

#include "pair_certifier.h"

namespace collision_pairs {

/// An interval of the fraction, and the pairs that are open in some part of it.
struct Interval {
  static constexpr int NONE = -1;

  double begin = 0.0, end = 0.0;
  double motion = 0.0;  ///< metres: largest motion of any of the pairs in its part
  int first_open = NONE;

  bool isEmpty() const { return first_open == NONE; }
};

/// Returns the interval with the most motion first, which may contain the deepest contact. The
/// order depends only on the intervals.
class OpenIntervals {
 public:
  void clear() {
    intervals_.clear();
    slots_.clear();
    free_ = Interval::NONE;
  }

  bool isEmpty() const { return intervals_.empty(); }
  /// Pairs, once for each interval on which they are open, and unused entries for reuse.
  std::size_t nbPairs() const { return slots_.size(); }
  void push(const Interval& interval) {
    if (interval.isEmpty()) return;
    intervals_.push_back(interval);
    std::push_heap(intervals_.begin(), intervals_.end(), &hasLowerPriority);
  }
  Interval pop() {
    std::pop_heap(intervals_.begin(), intervals_.end(), &hasLowerPriority);
    const Interval interval = intervals_.back();
    intervals_.pop_back();
    return interval;
  }

  void addPair(const OpenPair& open, Interval& interval) {
    interval.begin = interval.isEmpty() ? open.begin : std::min(interval.begin, open.begin);
    interval.end = interval.isEmpty() ? open.end : std::max(interval.end, open.end);
    interval.motion = std::max(interval.motion, open.speed * (open.end - open.begin));
    int slot = free_;
    if (slot == Interval::NONE) {
      slot = static_cast<int>(slots_.size());
      slots_.emplace_back();
    } else {
      free_ = slots_[slot].next;
    }
    slots_[slot] = {open, interval.first_open};
    interval.first_open = slot;
  }
  /// Removes a pair from an interval that is not empty; its ends are kept.
  OpenPair popPair(Interval& interval) {
    const int slot = interval.first_open;
    interval.first_open = slots_[slot].next;
    slots_[slot].next = free_;
    free_ = slot;
    return slots_[slot].open;
  }

 private:
  struct Slot {
    OpenPair open;
    int next = Interval::NONE;  ///< the next one of the same interval, or the next unused one
  };
  static bool hasLowerPriority(const Interval& a, const Interval& b) {
    return a.motion != b.motion ? a.motion < b.motion : a.begin > b.begin;
  }

  std::vector<Interval> intervals_;  // a heap
  std::vector<Slot> slots_;
  int free_ = Interval::NONE;
};

}  // namespace collision_pairs
