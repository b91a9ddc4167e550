#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "collision_pairs/joint_columns.h"
#include "demo_scene.h"

namespace collision_pairs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const char* LIMIT = "<limit lower='-3' upper='3'/>";

/// lead <- half (0.5 lead + 1) <- quarter (0.5 half), a free slide, a weld and a floating base.
std::shared_ptr<const RobotModel> mimickingRobot() {
  const auto mimic = [&](const std::string& leader, double multiplier, double offset) {
    return LIMIT + ("<mimic joint='" + leader + "' multiplier='" + std::to_string(multiplier)) +
           "' offset='" + std::to_string(offset) + "'/>";
  };
  std::string xml = emptyLink("root");
  for (const char* link : {"a", "b", "c", "d", "e", "f"}) xml += boxLink(link, 0.1);
  xml += joint("quarter", "revolute", "root", "a", "0 0 0", mimic("half", 0.5, 0.0)) +
         joint("lead", "revolute", "root", "b", "0 0 0", LIMIT) +
         joint("half", "prismatic", "root", "c", "0 0 0", mimic("lead", 0.5, 1.0)) +
         joint("slide", "prismatic", "root", "d", "0 0 0", LIMIT) +
         joint("weld", "fixed", "root", "e", "0 0 0", "") +
         joint("base", "floating", "root", "f", "0 0 0", "");
  return robotFrom(xml);
}

class JointColumnsTest : public testing::Test {
 protected:
  std::string refusal(const std::vector<std::string>& names, const std::vector<double>& state) {
    try {
      JointColumns(names, *robot_).check(state.data());
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }
  double at(const std::vector<double>& positions, const char* name) const {
    return positions[robot_->findJoint(name)];
  }

  const std::shared_ptr<const RobotModel> robot_ = mimickingRobot();
};

TEST_F(JointColumnsTest, MoveWhatIsNamedAndWhatFollowsIt) {
  const JointColumns columns({"slide", "lead"}, *robot_);
  std::vector<double> positions = robot_->zeroPositions();
  const double state[] = {0.7, 2.0};
  columns.apply(state, positions);
  EXPECT_EQ(at(positions, "slide"), 0.7);
  EXPECT_EQ(at(positions, "lead"), 2.0);
  EXPECT_EQ(at(positions, "half"), 2.0);     // 0.5 * 2 + 1
  EXPECT_EQ(at(positions, "quarter"), 1.0);  // 0.5 * half
  EXPECT_THAT(columns.notNamed(), ElementsAre());
}

TEST_F(JointColumnsTest, LeaveAloneWhatIsNotNamed) {
  const JointColumns columns({"slide"}, *robot_);
  std::vector<double> positions = robot_->zeroPositions();
  const std::vector<double> before = positions;
  const double state[] = {-1.5};
  columns.apply(state, positions);
  EXPECT_EQ(at(positions, "slide"), -1.5);
  for (const char* name : {"lead", "half", "quarter"})
    EXPECT_EQ(at(positions, name), at(before, name));
  EXPECT_THAT(columns.notNamed(), ElementsAre("lead"));
  EXPECT_THAT(columns.atZero(), ElementsAre("lead", "base"));  // floating: no number sets it
}

TEST_F(JointColumnsTest, TakeAMimicThatAgreesWithItsLeaderAndNoOther) {
  EXPECT_EQ(refusal({"lead", "quarter"}, {2.0, 1.0}), "accepted");
  EXPECT_EQ(refusal({"lead", "quarter"}, {2.0, 1.0 + 9e-7}), "accepted");
  EXPECT_THAT(refusal({"lead", "quarter"}, {2.0, 1.1}),
              testing::AllOf(HasSubstr("'quarter' is 1.1"), HasSubstr("it must be 1.0")));
  EXPECT_EQ(refusal({"lead", "quarter"}, {2.0, 1.0 - 9e-7}), "accepted");
  EXPECT_THAT(refusal({"lead", "quarter"}, {2.0, 0.9}), HasSubstr("'quarter' is 0.9"));
  EXPECT_THAT(refusal({"quarter"}, {1.0}),
              HasSubstr("'quarter' mimics 'half'; name that joint instead"));
}

TEST_F(JointColumnsTest, NameTheJointThatIsWrong) {
  EXPECT_THAT(refusal({"slyde"}, {0.0}),
              HasSubstr("joint 'slyde' is not in robot 'test'; did you mean 'slide'?"));
  EXPECT_THAT(refusal({"slide", "slide"}, {0.0, 0.0}), HasSubstr("'slide' is named twice"));
  EXPECT_THAT(refusal({"weld"}, {0.0}), HasSubstr("'weld' is fixed, floating or planar"));
  EXPECT_THAT(refusal({"base"}, {0.0}), HasSubstr("'base' is fixed, floating or planar"));
  for (const double wrong :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(refusal({"lead", "slide"}, {0.0, wrong}),
                HasSubstr("'slide': its position is not"));
  }
}

}  // namespace
}  // namespace collision_pairs
