// The remaining work of a search along a motion: intervals, and the pairs open on them.
#pragma once

#include <algorithm>
#include <vector>

#include "pair_cover.h"

namespace collision_pairs {

/// An interval of the fraction, and the pairs that are open in some part of it.
struct Way {
  static constexpr int NONE = -1;

  double begin = 0.0, end = 0.0;
  double motion = 0.0;  ///< metres: largest motion of any of the pairs in its part
  int first_open = NONE;

  bool isEmpty() const { return first_open == NONE; }
};

/// Returns the interval with the most motion first, which may contain the deepest contact. The
/// order depends only on the ways.
class OpenWays {
 public:
  void clear() {
    ways_.clear();
    slots_.clear();
    free_ = Way::NONE;
  }

  bool isEmpty() const { return ways_.empty(); }
  /// Pairs, once for each way on which they are open, and unused entries for reuse.
  std::size_t nbPairs() const { return slots_.size(); }
  void push(const Way& way) {
    if (way.isEmpty()) return;
    ways_.push_back(way);
    std::push_heap(ways_.begin(), ways_.end(), &isLessSuspicious);
  }
  Way pop() {
    std::pop_heap(ways_.begin(), ways_.end(), &isLessSuspicious);
    const Way way = ways_.back();
    ways_.pop_back();
    return way;
  }

  void addPair(const OpenPair& open, Way& way) {
    way.begin = way.isEmpty() ? open.begin : std::min(way.begin, open.begin);
    way.end = way.isEmpty() ? open.end : std::max(way.end, open.end);
    way.motion = std::max(way.motion, open.speed * (open.end - open.begin));
    int slot = free_;
    if (slot == Way::NONE) {
      slot = static_cast<int>(slots_.size());
      slots_.emplace_back();
    } else {
      free_ = slots_[slot].next;
    }
    slots_[slot] = {open, way.first_open};
    way.first_open = slot;
  }
  /// Removes a pair from a way that is not empty; the interval is kept.
  OpenPair takePair(Way& way) {
    const int slot = way.first_open;
    way.first_open = slots_[slot].next;
    slots_[slot].next = free_;
    free_ = slot;
    return slots_[slot].open;
  }

 private:
  struct Slot {
    OpenPair open;
    int next = Way::NONE;  ///< the next one of the same way, or the next unused one
  };
  static bool isLessSuspicious(const Way& a, const Way& b) {
    return a.motion != b.motion ? a.motion < b.motion : a.begin > b.begin;
  }

  std::vector<Way> ways_;  // a heap
  std::vector<Slot> slots_;
  int free_ = Way::NONE;
};

}  // namespace collision_pairs
