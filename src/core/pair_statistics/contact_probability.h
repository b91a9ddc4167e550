// What a count of contacts says about the probability of one.
#pragma once

#include <cstdint>

namespace collision_pairs {

/// The exact one-sided bounds of Clopper and Pearson (The use of confidence or fiducial limits
/// illustrated in the case of the binomial, 1934) on the probability of contact in a state, after
/// `contacts` of `trials` independent states: whatever the probability is, the bound is on the
/// right side of it with at least `confidence`, which lies in (0, 1). Without trials: 1 and 0.
double upperContactProbability(std::uint64_t contacts, std::uint64_t trials, double confidence);
double lowerContactProbability(std::uint64_t contacts, std::uint64_t trials, double confidence);

/// The fewest trials without a contact whose upper bound is at most `probability`, in (0, 1).
std::uint64_t trialsNeeded(double probability, double confidence);

}  // namespace collision_pairs
