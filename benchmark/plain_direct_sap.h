// Direct sweep and prune as SOFA's DirectSAPNarrowPhase does it, plainly: the reference that the
// broad phase is measured against.
#pragma once

#include <cstdint>
#include <vector>

#include "collision_pairs/sweep_and_prune.h"

namespace collision_pairs {

/// All end points of all boxes in one list, sorted by value and then by box, swept with a list of
/// active boxes; each active box is tested on all three axes in double. As in the original, boxes
/// that exactly touch on the sweep axis are found in one order of ids only, and boxes must be
/// sound. Memory is created once. O(n log n + n * active boxes).
class PlainDirectSap {
 public:
  void begin(double alarm_distance);
  void add(const Aabb& box);
  /// The pairs in the order in which they are met.
  const std::vector<BoxPair>& end();

 private:
  struct EndPoint {
    double value;
    std::uint32_t box;
    bool is_begin;
  };
  int greatestVarianceAxis() const;
  void createEndPoints(int axis);
  void sweep();

  double alarm_distance_ = 0.0;
  std::vector<Aabb> boxes_;
  std::vector<EndPoint> end_points_;
  std::vector<EndPoint*> order_;
  std::vector<std::uint32_t> active_;
  std::vector<BoxPair> pairs_;
};

}  // namespace collision_pairs
