#include "timed_climb.h"

#include <algorithm>
#include <tuple>

namespace collision_pairs {

const std::vector<TimedClimb::Result>& TimedClimb::run(const std::vector<BoxPair>& candidates,
                                                       const CheckSettings& settings,
                                                       const Deadline& deadline,
                                                       PairLadder& ladder) {
  settings_ = &settings;
  ladder_ = &ladder;
  results_.clear();
  still_open_.clear();
  boundByBoxes(candidates, deadline);
  climb(Round::HULLS, deadline);
  climb(Round::ALL, deadline);
  results_.insert(results_.end(), still_open_.begin(), still_open_.end());
  return results_;
}

void TimedClimb::boundByBoxes(const std::vector<BoxPair>& candidates, const Deadline& deadline) {
  const double reach = settings_->alarm_distance;
  for (const BoxPair& candidate : candidates) {
    const BoxPair pair = ladder_->byModel(candidate);
    const bool aligned = ladder_->rungOf(pair, settings_->fidelity) == Fidelity::AABB;
    if (aligned && !settings_->verdict_only) {
      sortOut({pair, ladder_->measure(pair, Fidelity::AABB, reach)});
    } else {
      sortOut({pair, aligned || deadline.spent() ? ladder_->boundOfAlignedBoxes(pair, reach)
                                                 : ladder_->boundOfBoxes(pair, reach)});
    }
  }
}

void TimedClimb::climb(Round round, const Deadline& deadline) {
  std::swap(open_, still_open_);
  still_open_.clear();
  const auto suspicion = [](const Result& open) {
    return std::make_tuple(open.answer.found.distance, open.pair.first, open.pair.second);
  };
  std::sort(open_.begin(), open_.end(),
            [&](const Result& a, const Result& b) { return suspicion(a) < suspicion(b); });
  for (std::size_t i = 0; i < open_.size(); ++i) {
    if (deadline.spent()) {
      still_open_.insert(still_open_.end(), open_.begin() + static_cast<std::ptrdiff_t>(i),
                         open_.end());
      return;
    }
    const Result result{open_[i].pair, step(open_[i], round)};
    if (settings_->verdict_only && result.answer.found.certainty == Certainty::BOUND) {
      results_ = {result};
      still_open_.clear();
      return;
    }
    sortOut(result);
  }
}

PairLadder::Answer TimedClimb::step(const Result& open, Round round) {
  const double reach = settings_->alarm_distance;
  if (round == Round::HULLS && ladder_->needsTriangles(open.pair, settings_->fidelity)) {
    return ladder_->boundOfHulls(open.pair, open.answer, reach);
  }
  if (settings_->verdict_only) return ladder_->touches(open.pair, settings_->fidelity);
  return ladder_->climb(open.pair, settings_->fidelity, reach, settings_->tolerance);
}

void TimedClimb::sortOut(const Result& result) {
  const bool open = result.answer.found.certainty == Certainty::UNFINISHED;
  (open ? still_open_ : results_).push_back(result);
}

}  // namespace collision_pairs
