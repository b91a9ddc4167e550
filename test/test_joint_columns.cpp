#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "collision_pairs/joint_columns.h"
#include "demo_scene.h"
#include "refusal.h"

namespace collision_pairs::test_joint_columns {

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
  std::string refusalOf(const std::vector<std::string>& names, const std::vector<double>& state) {
    return refusal([&] { JointColumns(names, *robot_).check(state.data()); });
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

TEST_F(JointColumnsTest, DropALeadingSlash) {
  EXPECT_EQ(JointColumns({"/lead", "slide"}, *robot_).sourceOf(robot_->findJoint("lead")).column,
            0);
  EXPECT_THAT(refusalOf({"/lead", "lead"}, {0.0, 0.0}), HasSubstr("is named twice"));
  EXPECT_THAT(refusalOf({"//lead"}, {0.0}), HasSubstr("joint '//lead' is not in robot"));
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
  EXPECT_EQ(refusalOf({"lead", "quarter"}, {2.0, 1.0}), "accepted");
  EXPECT_EQ(refusalOf({"lead", "quarter"}, {2.0, 1.0 + 9e-7}), "accepted");
  EXPECT_THAT(refusalOf({"lead", "quarter"}, {2.0, 1.1}),
              testing::AllOf(HasSubstr("'quarter' is 1.1"), HasSubstr("it must be 1.0")));
  EXPECT_EQ(refusalOf({"lead", "quarter"}, {2.0, 1.0 - 9e-7}), "accepted");
  EXPECT_THAT(refusalOf({"lead", "quarter"}, {2.0, 0.9}), HasSubstr("'quarter' is 0.9"));
  EXPECT_THAT(refusalOf({"quarter"}, {1.0}),
              HasSubstr("'quarter' mimics 'half'; name that joint instead"));
}

TEST_F(JointColumnsTest, RefuseAnglesOfWhichTheDigitsDoNotSayWhereInATurnTheyAre) {
  const std::string urdf =
      "<robot name='r'><link name='a'/><link name='b'/><link name='c'/>"
      "<joint name='turn' type='continuous'><parent link='a'/><child link='b'/></joint>"
      "<joint name='slide' type='prismatic'><parent link='b'/><child link='c'/>"
      "<limit lower='-1' upper='1' effort='1' velocity='1'/></joint></robot>";
  const auto robot = RobotModel::fromUrdf(urdf, nullptr);
  const JointColumns columns({"turn", "slide"}, *robot);
  const double near[] = {1e6, 1e7}, far[] = {-1.001e6, 0.0};
  columns.check(near);
  EXPECT_THROW(columns.check(far), InputError);
}

TEST_F(JointColumnsTest, NameTheJointThatIsWrong) {
  EXPECT_THAT(refusalOf({"slyde"}, {0.0}),
              HasSubstr("joint 'slyde' is not in robot 'test'; did you mean 'slide'?"));
  EXPECT_THAT(refusalOf({"slide", "slide"}, {0.0, 0.0}), HasSubstr("'slide' is named twice"));
  EXPECT_THAT(refusalOf({"weld"}, {0.0}), HasSubstr("'weld' is fixed, floating or planar"));
  EXPECT_THAT(refusalOf({"base"}, {0.0}), HasSubstr("'base' is fixed, floating or planar"));
  for (const double wrong :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(refusalOf({"lead", "slide"}, {0.0, wrong}),
                HasSubstr("'slide': its position is not"));
  }
}

/// A chain root - a - b - c, whose joints are `x`, `y` and `z`: lines of the URDF inside <joint>.
std::shared_ptr<const RobotModel> chainOf(const std::string& x, const std::string& y,
                                          const std::string& z) {
  return robotFrom(emptyLink("root") + boxLink("a", 0.1) + boxLink("b", 0.1) + boxLink("c", 0.1) +
                   joint("x", "continuous", "root", "a", "0 0 0", x) +
                   joint("y", "continuous", "a", "b", "0 0 0", y) +
                   joint("z", "continuous", "b", "c", "0 0 0", z));
}

std::string mimicOf(const char* leader) { return std::string("<mimic joint='") + leader + "'/>"; }

TEST(MissingLeader, MakesAJointOfItsOwnThatIsUnknownUnlessNamed) {
  const auto robot = chainOf("", "<mimic joint='nobody'/>", "<mimic joint='y' multiplier='2'/>");
  EXPECT_THAT(robot->warnings(),
              ElementsAre(HasSubstr("joint 'y' mimics 'nobody', which does not exist")));
  const JointColumns few({"x"}, *robot);
  EXPECT_THAT(few.notNamed(), ElementsAre("y"));
  EXPECT_THAT(few.atZero(), ElementsAre());
  std::vector<double> positions = robot->unnamedPositions();
  const double state[] = {0.3, 0.7};
  few.apply(state, positions);
  EXPECT_EQ(positions[robot->findJoint("x")], 0.3);
  EXPECT_TRUE(std::isnan(positions[robot->findJoint("y")]));
  EXPECT_TRUE(std::isnan(positions[robot->findJoint("z")]));
  JointColumns({"x", "y"}, *robot).apply(state, positions);
  EXPECT_EQ(positions[robot->findJoint("y")], 0.7);
  EXPECT_EQ(positions[robot->findJoint("z")], 1.4);
}

TEST(MissingLeader, IsOneThatIsFixedOrInACycleToo) {
  const std::string fixed = emptyLink("root") + boxLink("a", 0.1) + boxLink("b", 0.1) +
                            joint("weld", "fixed", "root", "a") +
                            joint("y", "continuous", "a", "b", "0 0 0", "<mimic joint='weld'/>");
  EXPECT_THAT(robotFrom(fixed)->warnings(), ElementsAre(HasSubstr("which has no position")));
  for (const char* of_x : {"x", "y", "z"}) {
    for (const char* of_y : {"x", "y", "z"}) {
      for (const char* of_z : {"x", "y", "z"}) {
        // Always a cycle: each mimics some joint.
        const auto robot = chainOf(mimicOf(of_x), mimicOf(of_y), mimicOf(of_z));
        std::vector<double> positions = robot->unnamedPositions();
        for (const double position : positions) EXPECT_TRUE(std::isnan(position));
        EXPECT_GE(robot->warnings().size(), 1u);
        const std::vector<std::string> leaders = JointColumns({}, *robot).notNamed();
        EXPECT_EQ(leaders.size(), robot->warnings().size());
        JointColumns(leaders, *robot).apply(std::vector<double>{1, 1, 1}.data(), positions);
        EXPECT_THAT(positions, ElementsAre(1.0, 1.0, 1.0));
      }
    }
  }
}

}  // namespace collision_pairs::test_joint_columns
