// Every box against every other, over packed arrays: what a broad phase must not be slower than.
#pragma once

#include <vector>

#include "collision_pairs/sweep_and_prune.h"

namespace collision_pairs {

/// Sides in arrays of their own and a branch-free inner loop in double that a compiler can
/// vectorise. O(n^2); memory is created once.
class PackedBruteForce {
 public:
  /// All pairs of touching boxes, sorted, but for those of two of the first `nb_static`.
  const std::vector<BoxPair>& pairs(const std::vector<Aabb>& boxes, std::size_t nb_static);

 private:
  void testRow(std::size_t i, std::size_t begin, std::size_t end);

  std::vector<double> lo_[3], hi_[3];
  std::vector<unsigned char> hit_;
  std::vector<BoxPair> pairs_;
};

}  // namespace collision_pairs
