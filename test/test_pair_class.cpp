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

}  // namespace collision_pairs::test_pair_class
