// The limit beyond which a search for the nearest points of two surfaces skips parts of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision_pairs/pair_distance.h"

namespace collision_pairs {

/// Comes nearer as the search finds nearer points: with an Accuracy to where parts may still be
/// nearer, but by no more than its tolerance. Remembers the nearest part that was left out, so that
/// in the end what is certain is known. All are squares of metres.
class SearchLimit {
 public:
  SearchLimit(double squared, const Accuracy& accuracy) : squared_(squared), accuracy_(accuracy) {}

  double squared() const { return squared_; }
  double tolerance() const { return accuracy_.tolerance; }

  /// Two points were found whose distance this is.
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

  /// Metres; no more than the distance, of which `upper` is an upper bound that was found.
  double lowerEnd(double upper) const {
    return accuracy_.isExact() ? upper : std::min(upper, std::sqrt(nearest_left_out_));
  }

 private:
  double squared_;
  double nearest_left_out_ = std::numeric_limits<double>::infinity();
  Accuracy accuracy_;
};

}  // namespace collision_pairs
