// Classifies pairs of links by whether they need to be checked.
#pragma once

#include <cstdint>

#include "pair_statistics.h"

namespace collision_pairs {

/// The exact one-sided bounds of Clopper and Pearson (The use of confidence or fiducial limits
/// illustrated in the case of the binomial, 1934) on the probability of contact in a state, after
/// `contacts` of `trials` independent states: for any true probability the bound holds with at
/// least `confidence`, which lies in (0, 1). Without trials: 1 and 0.
double upperContactProbability(std::uint64_t contacts, std::uint64_t trials, double confidence);
double lowerContactProbability(std::uint64_t contacts, std::uint64_t trials, double confidence);

/// The fewest trials without a contact whose upper bound is at most `probability`, in (0, 1).
std::uint64_t trialsNeeded(double probability, double confidence);

struct ClassRules {
  /// Of each bound, in (0, 1).
  double confidence = 0.99;
  /// In (0, 1). A pair is NEVER only if the upper bound on the probability of contact is at most
  /// this, and ALWAYS only if that of no contact is.
  double max_probability = 1e-4;
  /// Metres, >= 0. A pair whose distance was at most this is not NEVER.
  double clearance = 0.0;
};

enum class PairClass {
  ADJACENT,   ///< adjacent links
  ALWAYS,     ///< in contact in every state, and with joints at zero; enough trials
  NEVER,      ///< in none, nor with joints at zero, nor in a search; enough trials
  SOMETIMES,  ///< in contact in some state, random or not
  NEAR,       ///< would be NEVER, but came too near
  UNPROVEN    ///< would be ALWAYS or NEVER, but with too few trials, or a joint drawn in part
};

const char* className(PairClass pair_class);

/// Bounds on the probability that the two touch in a random state, at that confidence. Exact for
/// rigid pairs; 1 and 0 where a joint between them is drawn in part.
double upperBound(const PairEvidence& evidence, double confidence);
double lowerBound(const PairEvidence& evidence, double confidence);

/// One state is enough for rigid pairs, whose NEVER and ALWAYS are certain.
PairClass classify(const PairEvidence& evidence, const ClassRules& rules);

}  // namespace collision_pairs
