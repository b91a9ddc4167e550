#include "transform_kind.h"

namespace collision_pairs {
namespace {

constexpr std::size_t MOST_CHANGES = 1000;  // a limit, since they are external input

StampNs sum(StampNs stamp, StampNs duration) {
  return duration == NEVER || stamp > NEVER - duration ? NEVER : stamp + duration;
}

StampNs difference(StampNs stamp, StampNs duration) {
  return duration == NEVER || stamp < EVER_SINCE + duration ? EVER_SINCE : stamp - duration;
}

}  // namespace

void TransformKind::begin(StampNs now, StampNs max_age, bool was_static) {
  conflict_ = Conflict{difference(now, max_age), now, NEVER, was_static};
  prolong(max_age);
}

void TransformKind::prolong(StampNs max_age) {
  const StampNs heard =
      std::min(std::max(last_moving_, conflict_->begin), std::max(last_static_, conflict_->begin));
  conflict_->end = sum(heard, max_age);
}

bool TransformKind::isStaticAfterConflict() const {
  const StampNs moving = std::max(last_moving_, conflict_->begin);
  const StampNs fixed = std::max(last_static_, conflict_->begin);
  if (fixed == moving) return conflict_->was_static;
  return fixed > moving;
}

void TransformKind::settle(StampNs now) {
  if (!conflict_ || now < conflict_->end || conflict_->end == NEVER) return;
  const bool is_static = isStaticAfterConflict();
  if (ambiguous_.size() < MOST_CHANGES) {
    ambiguous_.push_back({conflict_->since, conflict_->end});
  } else {
    ambiguous_.back().end = conflict_->end;
  }
  if (changes_.size() == MOST_CHANGES) changes_.erase(changes_.begin() + 1);
  changes_.push_back({conflict_->end, is_static});
  conflict_.reset();
}

void TransformKind::noteMoving(StampNs now, StampNs max_age) {
  settle(now);
  last_moving_ = now;
  if (changes_.empty()) return changes_.push_back({EVER_SINCE, false});
  if (!conflict_ && !changes_.back().is_static) return;
  if (!conflict_) return begin(now, max_age, true);
  prolong(max_age);
}

void TransformKind::noteStatic(StampNs now, StampNs max_age, bool again) {
  settle(now);
  last_static_ = now;
  if (changes_.empty()) return changes_.push_back({EVER_SINCE, true});
  if (!conflict_ && changes_.back().is_static) return;
  if (!conflict_) {
    if (sum(last_moving_, max_age) < now) {
      if (again) changes_.push_back({now, true});
      return;
    }
    return begin(now, max_age, false);
  }
  prolong(max_age);
}

TransformKind::Kind TransformKind::at(StampNs stamp) const {
  if (changes_.empty()) return UNHEARD;
  if (conflict_) {
    if (stamp >= conflict_->end) return isStaticAfterConflict() ? STATIC : MOVES;
    if (stamp > conflict_->since) return AMBIGUOUS;
  }
  for (const Span& span : ambiguous_) {
    if (span.contains(stamp)) return AMBIGUOUS;
  }
  auto change = changes_.rbegin();
  while (change->since > stamp) ++change;
  return change->is_static ? STATIC : MOVES;
}

void TransformKind::restart(StampNs now, StampNs max_age) {
  if (changes_.empty()) return;
  const bool is_ambiguous = conflict_.has_value();
  const bool was_static = is_ambiguous ? conflict_->was_static : changes_.back().is_static;
  *this = TransformKind();
  changes_.push_back({EVER_SINCE, was_static});
  if (!is_ambiguous) return;
  last_moving_ = last_static_ = now;
  begin(now, max_age, was_static);
}

}  // namespace collision_pairs
