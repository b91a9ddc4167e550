// The limiter's parameter, joint states and trajectory commands.
#include <iomanip>
#include <limits>
#include <sstream>

#include <gmock/gmock.h>

#include "collision_pairs/input_error.h"
#include "limited_command.h"
#include "limiter_parameters.h"

namespace collision_pairs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string refusal(const std::string& yaml) {
  try {
    LimiterParameters::read(YAML::Load(yaml));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(LimiterParameters, AreReadWithTheirDefaults) {
  const auto read = LimiterParameters::read(
      YAML::Load("{command: jog, joints: [a, b], deceleration: {b: 2, a: 1.5}, ramp_up: 4}"));
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->command, "jog");
  EXPECT_FALSE(read->is_trajectory);
  EXPECT_THAT(read->law.deceleration, ElementsAre(1.5, 2.0));
  EXPECT_EQ(read->law.ramp_up, 4.0);
  EXPECT_EQ(read->law.stop_distance, LimiterSettings().stop_distance);
  EXPECT_THAT(LimiterParameters::read(YAML::Load("{command: c, joints: [a, b], deceleration: 3}"))
                  ->law.deceleration,
              ElementsAre(3.0, 3.0));
}

TEST(LimiterParameters, AreOffWhereThereIsNothing) {
  EXPECT_FALSE(LimiterParameters::read(YAML::Load("{}")).has_value());
  EXPECT_FALSE(LimiterParameters::read(YAML::Node()).has_value());
  EXPECT_FALSE(LimiterParameters::read(YAML::Load("{a: 1}")["b"]).has_value());
}

TEST(LimiterParameters, ThatCannotBeUsedAreRefusedByName) {
  const std::string good = "command: c, joints: [a], deceleration: 1";
  EXPECT_EQ(refusal("{" + good + "}"), "");
  EXPECT_THAT(refusal("{" + good + ", stop_distanse: 1}"),
              HasSubstr("did you mean 'stop_distance'"));
  EXPECT_THAT(refusal("{" + good + ", command_type: Twist}"), HasSubstr("Float64MultiArray"));
  EXPECT_THAT(refusal("{" + good + ", reaction_time: -1}"), HasSubstr("reaction_time"));
  EXPECT_THAT(refusal("{" + good + ", command_timeout: 0}"), HasSubstr("command_timeout"));
  EXPECT_THAT(refusal("{" + good + ", max_joint_state_age: 2}"), HasSubstr("max_joint_state_age"));
  EXPECT_THAT(refusal("{" + good + ", retreat_scale: .nan}"), HasSubstr("retreat_scale"));
  EXPECT_THAT(refusal("{joints: [a], deceleration: 1}"), HasSubstr("no command"));
  EXPECT_THAT(refusal("{command: c, deceleration: 1}"), HasSubstr("no joints"));
  EXPECT_THAT(refusal("{command: c, joints: [a]}"), HasSubstr("no deceleration"));
  EXPECT_THAT(refusal("{command: c, joints: [a], deceleration: 0}"), HasSubstr("deceleration"));
  EXPECT_THAT(refusal("{command: c, joints: [elbow], deceleration: {elbov: 1}}"),
              HasSubstr("did you mean 'elbow'"));
  EXPECT_THAT(refusal("{command: c, joints: [a, b], deceleration: {a: 1}}"), HasSubstr("'b'"));
  EXPECT_NE(refusal("[1, 2]"), "");
}

TEST(LimiterParameters, AreNumbersWithinTheirRangesEndsIncluded) {
  struct Case {
    const char* name;
    double lowest, highest;
    bool has_lowest;
  };
  const Case all[] = {{"reaction_time", 0, 10, true},       {"command_timeout", 0, 10, false},
                      {"max_joint_state_age", 0, 1, false}, {"stop_distance", 0, 10, true},
                      {"obstacle_speed", 0, 100, true},     {"retreat_scale", 0, 1, true},
                      {"ramp_up", 0, 1e6, false},           {"deceleration", 0, 1e6, false}};
  for (const Case& one : all) {
    const auto isRead = [&](double value) {
      YAML::Node yaml = YAML::Load("{command: c, joints: [a], deceleration: 1}");
      std::ostringstream text;
      text << std::setprecision(17) << value;
      yaml[one.name] = text.str();
      return refusal(YAML::Dump(yaml)).empty();
    };
    EXPECT_EQ(isRead(one.lowest), one.has_lowest) << one.name;
    EXPECT_TRUE(isRead(one.lowest + 1e-9)) << one.name;
    EXPECT_FALSE(isRead(one.lowest - 1e-9)) << one.name;
    EXPECT_TRUE(isRead(one.highest)) << one.name;
    EXPECT_FALSE(isRead(one.highest * (1.0 + 1e-9))) << one.name;
  }
}

sensor_msgs::JointState state(double stamp, std::vector<std::string> names,
                              std::vector<double> positions) {
  sensor_msgs::JointState message;
  message.header.stamp = ros::Time(stamp);
  message.name = std::move(names);
  message.position = std::move(positions);
  return message;
}

TEST(JointPositions, OfEachJointTheNewestStampCountsInWhateverOrderTheyCome) {
  JointPositions positions;
  positions.take(state(2.0, {"a", "b"}, {0.2, 0.4}), 2.0, 0.1);
  positions.take(state(1.0, {"a"}, {0.1}), 2.0, 0.1);
  positions.take(state(3.0, {"b"}, {0.6}), 3.0, 0.1);
  positions.take(state(9.0, {"a", "b"}, {9.0, 9.0}), 3.0, 0.1);  // of the future
  EXPECT_EQ(positions.all().at("a").value, 0.2);
  EXPECT_EQ(positions.all().at("b").value, 0.6);
  EXPECT_EQ(positions.oldestOf({"a", "b"}), 2.0);
  EXPECT_THROW(positions.oldestOf({"a", "c"}), InputError);
  positions.take(state(4.0, {"a"}, {std::numeric_limits<double>::quiet_NaN()}), 4.0, 0.1);
  EXPECT_THROW(positions.oldestOf({"a"}), InputError);
}

TEST(LimitedTrajectory, HasTheOrderOfTheCommandAndPositionsOnTheWay) {
  trajectory_msgs::JointTrajectory command;
  command.joint_names = {"b", "a"};
  command.points.resize(1);
  command.points[0].velocities = {2.0, 1.0};
  command.points[0].positions = {20.0, 11.0};
  EXPECT_THAT(velocitiesOf(command, {"a", "b"}), ElementsAre(1.0, 2.0));
  EXPECT_THROW(velocitiesOf(command, {"a", "c"}), InputError);
  EXPECT_THROW(velocitiesOf(command, {"a"}), InputError);
  JointPositions measured;
  measured.take(state(1.0, {"a", "b"}, {10.0, 10.0}), 1.0, 0.1);
  LimiterDecision decision;
  decision.scale = 0.5;
  decision.command = {0.5, 1.0};
  auto limited = limitedTrajectory(command, {"a", "b"}, decision, measured);
  EXPECT_THAT(limited.joint_names, ElementsAre("b", "a"));
  EXPECT_THAT(limited.points[0].velocities, ElementsAre(1.0, 0.5));
  EXPECT_THAT(limited.points[0].positions, ElementsAre(15.0, 10.5));
  measured.clear();  // no position at all rather than one that nobody measured
  limited = limitedTrajectory(command, {"a", "b"}, decision, measured);
  EXPECT_TRUE(limited.points[0].positions.empty());
  command.points.push_back(command.points[0]);
  EXPECT_THROW(velocitiesOf(command, {"a", "b"}), InputError);
  decision.scale = 0.0;
  decision.command = {0.0, 0.0};
  limited = limitedTrajectory(command, {"a", "b"}, decision, measured);
  EXPECT_THAT(limited.points[0].velocities, ElementsAre(0.0, 0.0));
}

}  // namespace
}  // namespace collision_pairs
