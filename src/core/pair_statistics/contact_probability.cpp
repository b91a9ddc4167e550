#include "contact_probability.h"

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

}  // namespace collision_pairs
