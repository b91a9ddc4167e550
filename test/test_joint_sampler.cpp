#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "demo_scene.h"
#include "joint_sampler.h"

namespace collision_pairs::test_joint_sampler {

using testing::ElementsAre;

const std::string NO_LIMITS = "<limit effort='1' velocity='1'/>";

/// A chain of one joint of each kind.
std::shared_ptr<const RobotModel> allKinds() {
  std::string links;
  for (const char* name : {"root", "a", "b", "c", "d", "e", "f", "g", "h", "i", "j"})
    links += emptyLink(name);
  return robotFrom(
      links + joint("turn", "revolute", "root", "a", "0 0 0", "<limit lower='-1' upper='3'/>") +
      joint("spin", "continuous", "a", "b", "0 0 0", "") +
      joint("slide", "prismatic", "b", "c", "0 0 0", "<limit lower='0.5' upper='0.75'/>") +
      joint("follow", "revolute", "c", "d", "0 0 0",
            "<limit lower='-9' upper='9'/><mimic joint='turn' multiplier='-2' offset='1'/>") +
      joint("stiff", "fixed", "d", "e", "0 0 0", "") +
      joint("free", "floating", "e", "f", "0 0 0", "") +
      joint("endless", "prismatic", "f", "g", "0 0 0", NO_LIMITS) +
      joint("unlimited", "revolute", "g", "h", "0 0 0", NO_LIMITS) +
      joint("vast", "prismatic", "h", "i", "0 0 0", "<limit lower='-1e16' upper='1e16'/>") +
      joint("wound", "revolute", "i", "j", "0 0 0", "<limit lower='-1e16' upper='1e16'/>"));
}

class Sampler : public testing::Test {
 protected:
  std::vector<double> drawnOf(const std::string& joint, std::uint64_t count) const {
    std::vector<double> drawn, positions;
    for (std::uint64_t i = 0; i < count; ++i) {
      sampler_.draw(i, positions);
      drawn.push_back(positions[robot_->findJoint(joint)]);
    }
    return drawn;
  }

  std::shared_ptr<const RobotModel> robot_ = allKinds();
  JointSampler sampler_{robot_, 7};
};

TEST_F(Sampler, DrawsEvenlyBetweenTheLimits) {
  const double pi = std::acos(-1.0);
  const struct {
    const char* joint;
    double lower, upper;
  } ranges[] = {{"turn", -1, 3},
                {"spin", -pi, pi},
                {"slide", 0.5, 0.75},
                {"unlimited", -pi, pi},
                {"wound", -pi, pi}};
  for (const auto& range : ranges) {
    std::vector<int> tenths(10, 0);
    for (const double q : drawnOf(range.joint, 10000)) {
      const double share = (q - range.lower) / (range.upper - range.lower);
      ASSERT_GE(share, 0.0);
      ASSERT_LT(share, 1.0);
      ++tenths[static_cast<int>(10 * share)];
    }
    // Binomial with mean 1000 and deviation 30: six deviations on either side.
    EXPECT_THAT(tenths, testing::Each(testing::AllOf(testing::Gt(820), testing::Lt(1180))))
        << range.joint;
  }
}

TEST_F(Sampler, DrawsJointsIndependently) {
  const std::vector<double> turn = drawnOf("turn", 10000), slide = drawnOf("slide", 10000);
  int both_low = 0;
  for (std::size_t i = 0; i < turn.size(); ++i) both_low += turn[i] < 1.0 && slide[i] < 0.625;
  EXPECT_NEAR(both_low, 2500, 260);  // six deviations
}

TEST_F(Sampler, AppliesMimicsAndLeavesStandingWhatHasNoRange) {
  std::vector<double> q;
  sampler_.draw(5, q);
  EXPECT_EQ(sampler_.ranges()[robot_->findJoint("follow")].upper, 0.0);  // not by itself
  EXPECT_DOUBLE_EQ(q[robot_->findJoint("follow")], 1.0 - 2.0 * q[robot_->findJoint("turn")]);
  for (const char* joint : {"stiff", "free", "endless", "vast"})
    EXPECT_EQ(q[robot_->findJoint(joint)], 0.0);
  EXPECT_THAT(sampler_.standingJoints(), ElementsAre("free", "endless", "vast"));
}

TEST_F(Sampler, StateDependsOnSeedAndIndexAlone) {
  std::vector<double> first, again, other_index, other_seed;
  sampler_.draw(3, first);
  sampler_.draw(4, other_index);
  JointSampler(robot_, 7).draw(3, again);
  JointSampler(robot_, 8).draw(3, other_seed);
  EXPECT_EQ(first, again);
  EXPECT_NE(first, other_index);
  EXPECT_NE(first, other_seed);
}

// The numbers are those of a second implementation of the paper's generator.
TEST_F(Sampler, NumbersAreTheSameOnEveryMachine) {
  RandomStream random(1, 2);
  const double first = random.uniform(), second = random.uniform();
  EXPECT_EQ(first, 0.39654996185185243);
  EXPECT_EQ(second, 0.31435902473721977);
}

TEST_F(Sampler, JointsBetweenTwoBodiesAreThoseThatMoveThemWithMimicsLed) {
  const auto between = [&](const std::string& a, const std::string& b) {
    std::vector<std::string> names;
    const auto bodyOf = [&](const std::string& l) {
      return robot_->links()[robot_->findLink(l)].body;
    };
    for (const int j : sampler_.jointsBetween(bodyOf(a), bodyOf(b))) {
      names.push_back(robot_->joints()[j].name);
    }
    return names;
  };
  EXPECT_THAT(between("a", "c"), ElementsAre("spin", "slide"));
  EXPECT_THAT(between("c", "e"), ElementsAre("turn"));  // "follow" does as "turn" does
  EXPECT_THAT(between("h", "g"), ElementsAre("unlimited"));
  EXPECT_THAT(between("e", "g"), ElementsAre());  // floating, and endless
}

}  // namespace collision_pairs::test_joint_sampler
