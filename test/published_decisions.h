// Decisions of the limiter's law that are published in time, and surroundings without anything.
#pragma once

#include <cmath>
#include <string>
#include <vector>

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

/// Certifies everything, and keeps the tube.
struct FreeSurroundings : Surroundings {
  StoppingTube tube;
  Certificate certify(const StoppingTube& of, const KeptDistances&,
                      const std::vector<NearPair>&) override {
    tube = of;
    return {true, "", "", ""};
  }
  double travel(const StoppingTube&) override { return 0.0; }
  bool leadsApart(const StoppingTube&, const NearPair&) override { return true; }
  double distance(const std::string&, const std::string&, double) override { return HUGE_VAL; }
  bool nearPairs(double, const std::vector<double>&, std::vector<NearPair>&,
                 std::string&) override {
    return true;
  }
};

}  // namespace collision_pairs
