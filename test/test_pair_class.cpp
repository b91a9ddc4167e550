// How often a pair may be in contact after so many trials, and what it is called for that.
#include <cmath>

#include <gtest/gtest.h>

#include "pair_class.h"

namespace collision_pairs::test_pair_class {

PairEvidence seen(std::uint64_t contacts, std::uint64_t trials) {
  PairEvidence evidence;
  evidence.contacts = contacts;
  evidence.trials = trials;
  evidence.nearest = contacts > 0 ? 0.0 : 0.02;
  evidence.touches_at_zero = trials > 0 && contacts == trials;
  return evidence;
}

class Classes : public testing::Test {
 protected:
  ClassRules rules_;
  std::uint64_t enough_ = trialsNeeded(rules_.max_probability, rules_.confidence);
};

TEST_F(Classes, NeverIsSaidOnlyAfterEnoughTrials) {
  EXPECT_EQ(classify(seen(0, enough_), rules_), PairClass::NEVER);
  EXPECT_EQ(classify(seen(0, enough_ - 1), rules_), PairClass::UNPROVEN);
  EXPECT_EQ(classify(seen(0, 0), rules_), PairClass::UNPROVEN);
}

TEST_F(Classes, AlwaysIsSaidOnlyAfterEnoughTrials) {
  EXPECT_EQ(classify(seen(enough_, enough_), rules_), PairClass::ALWAYS);
  EXPECT_EQ(classify(seen(enough_ - 1, enough_ - 1), rules_), PairClass::UNPROVEN);
}

TEST_F(Classes, OneStateOfTheOtherKindMakesASometimes) {
  EXPECT_EQ(classify(seen(1, 100 * enough_), rules_), PairClass::SOMETIMES);
  EXPECT_EQ(classify(seen(100 * enough_ - 1, 100 * enough_), rules_), PairClass::SOMETIMES);
}

TEST_F(Classes, AContactThatASearchFoundCounts) {
  PairEvidence evidence = seen(0, enough_);
  evidence.found_state = {0.5};
  EXPECT_EQ(classify(evidence, rules_), PairClass::SOMETIMES);
}

TEST_F(Classes, TheZeroStateCountsAsWell) {
  PairEvidence at_zero_only = seen(0, enough_), but_at_zero = seen(enough_, enough_);
  at_zero_only.touches_at_zero = true;
  but_at_zero.touches_at_zero = false;
  EXPECT_EQ(classify(at_zero_only, rules_), PairClass::SOMETIMES);
  EXPECT_EQ(classify(but_at_zero, rules_), PairClass::SOMETIMES);
}

TEST_F(Classes, AdjacentComesBeforeEverything) {
  for (const std::uint64_t contacts : {std::uint64_t{0}, enough_ / 2, enough_}) {
    PairEvidence evidence = seen(contacts, enough_);
    evidence.adjacent = true;
    EXPECT_EQ(classify(evidence, rules_), PairClass::ADJACENT);
  }
}

TEST_F(Classes, OneStateSaysAllOfARigidPair) {
  PairEvidence apart = seen(0, 1), touching = seen(1, 1);
  apart.rigid = touching.rigid = true;
  EXPECT_EQ(classify(apart, rules_), PairClass::NEVER);
  EXPECT_EQ(classify(touching, rules_), PairClass::ALWAYS);
  EXPECT_EQ(upperBound(apart, 0.99), 0.0);
  EXPECT_EQ(lowerBound(touching, 0.99), 1.0);
}

TEST_F(Classes, AsNearAsTheClearanceIsNotNever) {
  rules_.clearance = 0.02;
  EXPECT_EQ(classify(seen(0, enough_), rules_), PairClass::NEAR);
  rules_.clearance = 0.0199;
  EXPECT_EQ(classify(seen(0, enough_), rules_), PairClass::NEVER);
}

/// Probability of at most `contacts` in `trials` states, summed up from the definition.
double atMost(std::uint64_t contacts, std::uint64_t trials, double probability) {
  const auto n = static_cast<double>(trials);
  double sum = 0.0;
  for (std::uint64_t i = 0; i <= contacts; ++i) {
    const auto k = static_cast<double>(i);
    const double log_ways = std::lgamma(n + 1) - std::lgamma(k + 1) - std::lgamma(n - k + 1);
    sum += std::exp(log_ways + k * std::log(probability) + (n - k) * std::log1p(-probability));
  }
  return sum;
}

TEST(ContactProbability, AtTheUpperBoundSoFewContactsHaveTheProbabilityThatIsLeft) {
  for (const double confidence : {0.5, 0.95, 0.99, 0.999999}) {
    for (const std::uint64_t trials : {1u, 2u, 10u, 1000u, 100000u}) {
      for (const std::uint64_t contacts : {0u, 1u, 3u, 9u}) {
        if (contacts >= trials) continue;
        const double bound = upperContactProbability(contacts, trials, confidence);
        const double left = 1.0 - confidence;
        EXPECT_NEAR(atMost(contacts, trials, bound), left, 1e-6 * left)
            << contacts << " of " << trials << " at " << confidence;
      }
    }
  }
}

TEST(ContactProbability, WithoutContactsIsThatOfTheClosedForm) {
  EXPECT_NEAR(upperContactProbability(0, 10000, 0.95), 1.0 - std::pow(0.05, 1e-4), 1e-15);
  EXPECT_NEAR(upperContactProbability(0, 3, 0.875), 0.5, 1e-15);  // 1 - 0.125^(1/3)
}

TEST(ContactProbability, OfAllOrOfNoTrialsIsCertainOnOneSide) {
  EXPECT_EQ(upperContactProbability(0, 0, 0.99), 1.0);
  EXPECT_EQ(lowerContactProbability(0, 0, 0.99), 0.0);
  EXPECT_EQ(upperContactProbability(7, 7, 0.99), 1.0);
  EXPECT_EQ(lowerContactProbability(0, 7, 0.99), 0.0);
}

TEST(ContactProbability, LowerBoundMirrorsTheUpperOne) {
  EXPECT_NEAR(lowerContactProbability(3, 3, 0.875), 0.5, 1e-15);
  EXPECT_LT(lowerContactProbability(40, 100, 0.99), 0.4);
  EXPECT_GT(upperContactProbability(40, 100, 0.99), 0.4);
}

TEST(ContactProbability, TrialsNeededAreTheFewestThatAreEnough) {
  for (const double confidence : {0.5, 0.95, 0.99, 0.9999}) {
    for (const double probability : {0.5, 0.1, 1e-3, 1e-4, 1e-6}) {
      const std::uint64_t trials = trialsNeeded(probability, confidence);
      EXPECT_LE(upperContactProbability(0, trials, confidence), probability);
      EXPECT_GT(upperContactProbability(0, trials - 1, confidence), probability);
    }
  }
  EXPECT_EQ(trialsNeeded(1e-3, 0.95), 2995u);
}

}  // namespace collision_pairs::test_pair_class
