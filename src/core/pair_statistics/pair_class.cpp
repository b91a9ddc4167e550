#include "pair_class.h"

#include "contact_probability.h"

namespace collision_pairs {

const char* className(PairClass pair_class) {
  switch (pair_class) {
    case PairClass::ADJACENT:
      return "Adjacent";
    case PairClass::ALWAYS:
      return "Always";
    case PairClass::NEVER:
      return "Never";
    case PairClass::SOMETIMES:
      return "Sometimes";
    case PairClass::NEAR:
      return "Near";
    case PairClass::UNPROVEN:
      return "Unproven";
  }
  return "";
}

double upperBound(const PairEvidence& e, double confidence) {
  if (e.rigid) return e.contacts > 0 ? 1.0 : 0.0;
  return upperContactProbability(e.contacts, e.trials, confidence);
}

double lowerBound(const PairEvidence& e, double confidence) {
  if (e.rigid) return upperBound(e, confidence);
  return lowerContactProbability(e.contacts, e.trials, confidence);
}

PairClass classify(const PairEvidence& e, const ClassRules& rules) {
  if (e.adjacent) return PairClass::ADJACENT;
  const bool always = e.trials > 0 && e.contacts == e.trials && e.touches_at_zero;
  const bool never = e.contacts == 0 && e.found_state.empty() && !e.touches_at_zero;
  if (!always && !never) return PairClass::SOMETIMES;
  // Of the state that was never seen: contact, or being apart.
  const double doubt = e.rigid ? 0.0 : upperContactProbability(0, e.trials, rules.confidence);
  if (doubt > rules.max_probability) return PairClass::UNPROVEN;
  if (always) return PairClass::ALWAYS;
  return e.rigid || e.nearest > rules.clearance ? PairClass::NEVER : PairClass::NEAR;
}

}  // namespace collision_pairs
