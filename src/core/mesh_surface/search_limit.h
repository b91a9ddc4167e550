// The distance limit beyond which a search for the nearest points of two surfaces skips parts.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision_pairs/pair_distance.h"

namespace collision_pairs {

inline double square(double x) { return x * x; }

/// Decreases as the search finds nearer points; with an Accuracy by up to its tolerance below their
/// distance. Records the smallest bound of all skipped parts, from which the certified lower bound
/// is computed. Squares of metres.
class SearchLimit {
 public:
  SearchLimit(double squared, const Accuracy& accuracy) : squared_(squared), accuracy_(accuracy) {}

  double squared() const { return squared_; }
  double tolerance() const { return accuracy_.tolerance; }

  /// Two points at this distance were found.
  void found(double squared) {
    squared_ = squared;
    if (accuracy_.isExact()) return;
    const double enough = accuracy_.farEnough(std::sqrt(squared));
    squared_ = enough * enough;
  }

  /// True if a part, or a pair of parts, with this lower bound is skipped.
  bool excludes(double squared_bound) {
    if (!(squared_bound > squared_)) return false;
    leaveOut(squared_bound);
    return true;
  }
  void leaveOut(double squared_bound) {
    nearest_left_out_ = std::min(nearest_left_out_, squared_bound);
  }

  /// A lower bound of the distance, metres; `upper` is the upper bound that was found.
  double lowerEnd(double upper) const {
    return accuracy_.isExact() ? upper : std::min(upper, std::sqrt(nearest_left_out_));
  }

 private:
  double squared_;
  double nearest_left_out_ = std::numeric_limits<double>::infinity();
  Accuracy accuracy_;
};

}  // namespace collision_pairs
