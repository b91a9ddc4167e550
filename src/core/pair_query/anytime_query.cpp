#include "anytime_query.h"

#include <algorithm>
#include <tuple>

namespace collision_pairs {

void AnytimeQuery::run(const std::vector<BoxPair>& candidates, const CheckSettings& settings,
                       const Deadline& deadline, PairLadder& ladder, const Take& take) {
  settings_ = &settings;
  ladder_ = &ladder;
  still_open_.clear();
  has_ended_ = false;
  boundByBoxes(candidates, deadline, take);
  refine(Round::HULLS, deadline, take);
  refine(Round::ALL, deadline, take);
  for (std::size_t i = 0; i < still_open_.size() && !has_ended_; ++i) {
    has_ended_ = !take(still_open_[i]);
  }
}

void AnytimeQuery::boundByBoxes(const std::vector<BoxPair>& candidates, const Deadline& deadline,
                                const Take& take) {
  const double reach = settings_->alarm_distance;
  for (const BoxPair& candidate : candidates) {
    const BoxPair pair = ladder_->byModel(candidate);
    const bool aligned = ladder_->rungOf(pair, settings_->fidelity) == Fidelity::AABB;
    if (aligned && !settings_->verdict_only) {
      sortOut({pair, ladder_->measure(pair, Fidelity::AABB, reach)}, take);
    } else {
      sortOut({pair, aligned || deadline.spent() ? ladder_->boundOfAlignedBoxes(pair, reach)
                                                 : ladder_->boundOfBoxes(pair, reach)},
              take);
    }
    if (has_ended_) return;
  }
}

void AnytimeQuery::refine(Round round, const Deadline& deadline, const Take& take) {
  std::swap(open_, still_open_);
  still_open_.clear();
  const auto suspicion = [](const Result& open) {
    return std::make_tuple(open.answer.found.distance, open.pair.first, open.pair.second);
  };
  std::sort(open_.begin(), open_.end(),
            [&](const Result& a, const Result& b) { return suspicion(a) < suspicion(b); });
  for (std::size_t i = 0; i < open_.size() && !has_ended_; ++i) {
    if (deadline.spent()) {
      still_open_.insert(still_open_.end(), open_.begin() + static_cast<std::ptrdiff_t>(i),
                         open_.end());
      return;
    }
    sortOut({open_[i].pair, step(open_[i], round)}, take);
  }
}

PairLadder::Answer AnytimeQuery::step(const Result& open, Round round) {
  const double reach = settings_->alarm_distance;
  if (round == Round::HULLS && ladder_->needsTriangles(open.pair, settings_->fidelity)) {
    return ladder_->boundOfHulls(open.pair, open.answer, reach);
  }
  if (settings_->verdict_only) return ladder_->touches(open.pair, settings_->fidelity);
  return ladder_->refine(open.pair, settings_->fidelity, reach, settings_->tolerance);
}

void AnytimeQuery::sortOut(const Result& result, const Take& take) {
  if (result.answer.found.certainty == Certainty::UNFINISHED) {
    still_open_.push_back(result);
  } else {
    has_ended_ = !take(result);
  }
}

}  // namespace collision_pairs
