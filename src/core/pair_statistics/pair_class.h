// What the evidence says of a pair of links: may it be left unchecked?
#pragma once

#include <string>

#include "pair_statistics.h"

namespace collision_pairs {

struct ClassRules {
  /// Of each bound, in (0, 1).
  double confidence = 0.99;
  /// In (0, 1). A pair is NEVER in contact only if the upper bound on the probability of contact is
  /// at most this, and ALWAYS only if that of being apart is.
  double max_probability = 1e-4;
  /// Metres, >= 0. A pair that came nearer, or as near, is not NEVER.
  double clearance = 0.0;
};

enum class PairClass {
  ADJACENT,   ///< hang together
  ALWAYS,     ///< in contact in every state, with joints at zero too; asked often enough
  NEVER,      ///< in none, nor with joints at zero, nor in a search; asked often enough
  SOMETIMES,  ///< in contact in some state, random or not
  NEAR,       ///< would be NEVER, but came too near
  UNPROVEN    ///< would be ALWAYS or NEVER, but was asked too rarely
};

const char* className(PairClass pair_class);

/// Bounds on the probability that the two touch in a random state, at that confidence. Certain for
/// rigid pairs.
double upperBound(const PairEvidence& evidence, double confidence);
double lowerBound(const PairEvidence& evidence, double confidence);

/// Rigid pairs need no second state; of them, NEVER and ALWAYS are certain.
PairClass classify(const PairEvidence& evidence, const ClassRules& rules);

}  // namespace collision_pairs
