// Settles as many pairs as a deadline allows, those most likely in contact first.
#pragma once

#include <functional>
#include <vector>

#include "collision_pairs/check_settings.h"
#include "pair_ladder.h"

namespace collision_pairs {

/// Seconds of a monotonic clock.
using Clock = std::function<double()>;

class Deadline {
 public:
  /// `budget` seconds from now; 0: never. The clock must outlive this and is read once at the start
  /// and once a question.
  Deadline(const Clock& clock, double budget)
      : clock_(budget > 0.0 ? &clock : nullptr), end_(clock_ ? clock() + budget : 0.0) {}

  bool isSet() const { return clock_ != nullptr; }
  bool spent() const { return clock_ && (*clock_)() >= end_; }

 private:
  const Clock* clock_;
  double end_;
};

/// All pairs are bounded by their boxes. Two rounds follow, each in order of increasing lower
/// bound: first hulls for pairs that need triangles, and all other pairs to completion; then the
/// triangles. The deadline is tested before each step of each pair, so it is exceeded by one narrow
/// query at most; boxes are compared even after it, about 10 ns per pair.
///
/// Never drops a pair, and keeps only memory between calls.
class AnytimeQuery {
 public:
  /// If `answer.found.certainty` is UNFINISHED, the distance is a lower bound; everything else is
  /// settled.
  struct Result {
    BoxPair pair;  ///< by model
    PairLadder::Answer answer;
  };

  /// False: it was the last.
  using Take = std::function<bool(const Result& result)>;

  /// Calls `take` once for each candidate, in no particular order, until it returns false.
  void run(const std::vector<BoxPair>& candidates, const CheckSettings& settings,
           const Deadline& deadline, PairLadder& ladder, const Take& take);

 private:
  enum class Round { HULLS, ALL };

  void boundByBoxes(const std::vector<BoxPair>& candidates, const Deadline& deadline,
                    const Take& take);
  void refine(Round round, const Deadline& deadline, const Take& take);
  PairLadder::Answer step(const Result& open, Round round);
  void sortOut(const Result& result, const Take& take);

  const CheckSettings* settings_ = nullptr;
  PairLadder* ladder_ = nullptr;
  std::vector<Result> open_, still_open_;
  bool has_ended_ = false;
};

}  // namespace collision_pairs
