// Decisions of the limiter's law that are published in time.
#pragma once

#include "limiter_law.h"

namespace collision_pairs {

/// A decision that is published when it has to be.
inline LimiterDecision published(LimiterLaw& law, const LimiterInput& input,
                                 Surroundings& surroundings) {
  LimiterDecision decision = law.decide(input, surroundings);
  law.published(input.now, decision);
  return decision;
}

inline void publishStop(LimiterLaw& law, double now) { law.published(now, law.stop("told to")); }

}  // namespace collision_pairs
