#include <gtest/gtest.h>

#include "contact_probability.h"
#include "pair_class.h"

namespace collision_pairs {
namespace {

PairEvidence seen(std::uint64_t contacts, std::uint64_t trials) {
  PairEvidence evidence;
  evidence.contacts = contacts;
  evidence.trials = trials;
  evidence.nearest = contacts > 0 ? 0.0 : 0.02;
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

}  // namespace
}  // namespace collision_pairs
