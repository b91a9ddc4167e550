#include "pair_class.h"

#include <array>
#include <cmath>

#include <boost/math/distributions/binomial.hpp>

namespace collision_pairs {

using Binomial = boost::math::binomial_distribution<double>;

double upperContactProbability(std::uint64_t contacts, std::uint64_t trials, double confidence) {
  if (trials == 0) return 1.0;
  if (contacts == 0) {  // 1 - (1 - confidence)^(1 / trials), without cancellation
    return -std::expm1(std::log1p(-confidence) / static_cast<double>(trials));
  }
  return Binomial::find_upper_bound_on_p(static_cast<double>(trials), static_cast<double>(contacts),
                                         1.0 - confidence);
}

double lowerContactProbability(std::uint64_t contacts, std::uint64_t trials, double confidence) {
  return 1.0 - upperContactProbability(trials - contacts, trials, confidence);
}

std::uint64_t trialsNeeded(double probability, double confidence) {
  const double trials = std::log1p(-confidence) / std::log1p(-probability);
  auto needed = static_cast<std::uint64_t>(std::ceil(trials));
  while (upperContactProbability(0, needed, confidence) > probability) ++needed;  // rounding
  return needed;
}

const char* className(PairClass pair_class) {
  static constexpr std::array<const char*, 6> NAMES = {"Adjacent",  "Always", "Never",
                                                       "Sometimes", "Near",   "Unproven"};
  return NAMES[static_cast<std::size_t>(pair_class)];
}

double upperBound(const PairEvidence& e, double confidence) {
  if (e.rigid) return e.contacts > 0 ? 1.0 : 0.0;
  if (!e.not_moved.empty()) return 1.0;
  return upperContactProbability(e.contacts, e.trials, confidence);
}

double lowerBound(const PairEvidence& e, double confidence) {
  if (e.rigid) return upperBound(e, confidence);
  if (!e.not_moved.empty()) return 0.0;
  return lowerContactProbability(e.contacts, e.trials, confidence);
}

PairClass classify(const PairEvidence& e, const ClassRules& rules) {
  if (e.adjacent) return PairClass::ADJACENT;
  const bool always = e.trials > 0 && e.contacts == e.trials && e.touches_at_zero;
  const bool never = e.contacts == 0 && e.found_state.empty() && !e.touches_at_zero;
  if (!always && !never) return PairClass::SOMETIMES;
  if (!e.not_moved.empty()) return PairClass::UNPROVEN;
  // Of the outcome that was never observed: contact, or no contact.
  const double probability = e.rigid ? 0.0 : upperContactProbability(0, e.trials, rules.confidence);
  if (probability > rules.max_probability) return PairClass::UNPROVEN;
  if (always) return PairClass::ALWAYS;
  const bool comes_near = e.nearest <= rules.clearance || e.is_near_at_zero;
  return comes_near && !e.rigid ? PairClass::NEAR : PairClass::NEVER;
}

}  // namespace collision_pairs
