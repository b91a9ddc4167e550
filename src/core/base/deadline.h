// When a check must end.
#pragma once

#include <functional>

namespace collision_pairs {

/// Seconds that never go back.
using Clock = std::function<double()>;

class Deadline {
 public:
  /// `budget` seconds from now on; 0: never. The clock must outlive this and is read once at the
  /// start and once a question.
  Deadline(const Clock& clock, double budget)
      : clock_(budget > 0.0 ? &clock : nullptr), end_(clock_ ? clock() + budget : 0.0) {}

  bool isSet() const { return clock_ != nullptr; }
  bool spent() const { return clock_ && (*clock_)() >= end_; }

 private:
  const Clock* clock_;
  double end_;
};

}  // namespace collision_pairs
