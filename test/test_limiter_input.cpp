// The limiter's parameter, and joint states. Trajectory commands: test_limiter_trajectory.cpp.
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>

#include <gmock/gmock.h>

#include "collision_pairs/input_error.h"
#include "documented_defaults.h"
#include "joint_states.h"
#include "limited_command.h"
#include "limiter_parameters.h"
#include "refusal.h"

namespace collision_pairs::test_limiter_input {
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

const std::pair<const char*, double LimiterSettings::*> NUMBERS[] = {
    {"reaction_time", &LimiterSettings::reaction_time},
    {"command_timeout", &LimiterSettings::command_timeout},
    {"max_joint_state_age", &LimiterSettings::max_joint_state_age},
    {"stop_distance", &LimiterSettings::stop_distance},
    {"self_stop_distance", &LimiterSettings::self_stop_distance},
    {"obstacle_speed", &LimiterSettings::obstacle_speed},
    {"retreat_scale", &LimiterSettings::retreat_scale},
    {"ramp_up", &LimiterSettings::ramp_up},
    {"tracking_tolerance", &LimiterSettings::tracking_tolerance}};

std::string refusalOf(const std::string& yaml) {
  return refusal([&] { LimiterParameters::read(YAML::Load(yaml)); });
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
  const auto one =
      LimiterParameters::read(YAML::Load("{command: c, joints: [a, b], deceleration: 3}"));
  EXPECT_THAT(one->law.deceleration, ElementsAre(3.0, 3.0));
}

TEST(LimiterParameters, NameJointsAsJointStatesDoWithoutTheirSlash) {
  const auto read = LimiterParameters::read(
      YAML::Load("{command: jog, joints: [/a, b], deceleration: {/b: 2, /a: 1.5}}"));
  EXPECT_THAT(read->joints, ElementsAre("a", "b"));
  EXPECT_THAT(read->law.deceleration, ElementsAre(1.5, 2.0));
  EXPECT_THAT(refusalOf("{command: jog, joints: [a], deceleration: {a: 1, /a: 2}}"),
              HasSubstr("two numbers for joint 'a'"));
}

TEST(LimiterParameters, HaveTheDefaultsThatThePageStates) {
  auto page = documentedDefaults("limiter.md");
  for (const auto& [name, number] : NUMBERS) {
    EXPECT_EQ(std::stod(page.at(name)), LimiterSettings().*number) << name;
    page.erase(name);
  }
  EXPECT_EQ(LimiterParameters().joint_states, "joint_states");
  EXPECT_FALSE(LimiterParameters().is_trajectory);
  EXPECT_THAT(
      page,
      ElementsAre(Pair("command", "(required)"), Pair("command_type", "std_msgs/Float64MultiArray"),
                  Pair("deceleration", "(required;"), Pair("joint_states", "joint_states"),
                  Pair("joints", "(required)")));
}

TEST(LimiterParameters, AreOffWhereThereIsNothing) {
  EXPECT_FALSE(LimiterParameters::read(YAML::Load("{}")).has_value());
  EXPECT_FALSE(LimiterParameters::read(YAML::Node()).has_value());
  EXPECT_FALSE(LimiterParameters::read(YAML::Load("{a: 1}")["b"]).has_value());
}

TEST(LimiterParameters, ThatCannotBeUsedAreRefusedByName) {
  const std::string good = "command: c, joints: [a], deceleration: 1";
  EXPECT_EQ(refusalOf("{" + good + "}"), "accepted");
  EXPECT_THAT(refusalOf("{" + good + ", stop_distanse: 1}"),
              HasSubstr("did you mean 'stop_distance'"));
  EXPECT_THAT(refusalOf("{" + good + ", command_type: Twist}"), HasSubstr("Float64MultiArray"));
  const std::string quick = "{" + good + ", reaction_time: 0.005";
  EXPECT_EQ(refusalOf(quick + "}"), "accepted");
  EXPECT_THAT(refusalOf(quick + ", command_type: trajectory_msgs/JointTrajectory}"),
              HasSubstr("reaction_time is 0.005 s, but each point of a trajectory takes 0.01 s"));
  EXPECT_THAT(refusalOf("{" + good + ", retreat_scale: .nan}"), HasSubstr("retreat_scale"));
  EXPECT_THAT(refusalOf("{joints: [a], deceleration: 1}"), HasSubstr("no command"));
  EXPECT_THAT(refusalOf("{command: c, deceleration: 1}"), HasSubstr("no joints"));
  EXPECT_THAT(refusalOf("{command: c, joints: [a]}"), HasSubstr("no deceleration"));
  EXPECT_THAT(refusalOf("{command: c, joints: [elbow], deceleration: {elbov: 1}}"),
              HasSubstr("did you mean 'elbow'"));
  EXPECT_THAT(refusalOf("{command: c, joints: [a, b], deceleration: {a: 1}}"), HasSubstr("'b'"));
  EXPECT_NE(refusalOf("[1, 2]"), "accepted");
}

TEST(LimiterParameters, AreNumbersWithinTheirRangesEndsIncluded) {
  struct Case {
    const char* name;
    double lowest, highest;
    bool has_lowest;
  };
  const Case all[] = {{"reaction_time", 0, 10, true},       {"command_timeout", 0, 10, false},
                      {"max_joint_state_age", 0, 1, false}, {"stop_distance", 0, 10, true},
                      {"self_stop_distance", 0, 10, true},  {"obstacle_speed", 0, 100, true},
                      {"retreat_scale", 0, 1, true},        {"ramp_up", 0, 1e6, false},
                      {"tracking_tolerance", 0, 10, false}, {"deceleration", 0, 1e6, false}};
  for (const Case& one : all) {
    const auto readAs = [&](double value) {
      YAML::Node yaml = YAML::Load("{command: c, joints: [a], deceleration: 1}");
      std::ostringstream text;
      text << std::setprecision(17) << value;
      yaml[one.name] = text.str();
      return refusalOf(YAML::Dump(yaml));
    };
    EXPECT_EQ(readAs(one.lowest) == "accepted", one.has_lowest) << one.name;
    EXPECT_EQ(readAs(one.lowest + 1e-9), "accepted") << one.name;
    EXPECT_THAT(readAs(one.lowest - 1e-9), HasSubstr(one.name));
    EXPECT_EQ(readAs(one.highest), "accepted") << one.name;
    EXPECT_THAT(readAs(one.highest * (1.0 + 1e-9)), HasSubstr(one.name));
  }
}

TEST(LimiterParameters, AreReadEachToItsPlace) {
  const std::string good = "{command: c, joints: [a], deceleration: 1";
  for (const auto& [name, number] : NUMBERS) {
    const auto read = LimiterParameters::read(YAML::Load(good + ", " + name + ": 0.75}"));
    for (const auto& [other, value] : NUMBERS) {
      EXPECT_EQ(read->law.*value, number == value ? 0.75 : LimiterSettings().*value) << name;
    }
    EXPECT_THAT(refusalOf(good + ", " + name + "z: 1}"),
                HasSubstr(std::string("'") + name +
                          "z' is not a setting of the limiter; did you mean '" + name + "'?"));
  }
  const auto words = LimiterParameters::read(YAML::Load(
      good + ", joint_states: measured, command_type: trajectory_msgs/JointTrajectory}"));
  EXPECT_EQ(words->joint_states, "measured");
  EXPECT_TRUE(words->is_trajectory);
  EXPECT_THAT(words->joints, ElementsAre("a"));
  const auto usual =
      LimiterParameters::read(YAML::Load(good + ", command_type: std_msgs/Float64MultiArray}"));
  EXPECT_EQ(usual->joint_states, "joint_states");
  EXPECT_FALSE(usual->is_trajectory);
  for (const char* word : {"command", "command_type", "joints", "joint_states", "deceleration"}) {
    EXPECT_THAT(refusalOf(good + ", " + word + "z: 1}"),
                HasSubstr(std::string("did you mean '") + word + "'?"));
  }
}

TEST(LimiterParameters, ThatAreOutOfRangeAreToldTheirRange) {
  const std::string good = "{command: c, joints: [elbow, wrist], deceleration: ";
  EXPECT_THAT(refusalOf(good + "0}"),
              HasSubstr("a number from 0.000000 (excluded) to 1000000.000000"));
  EXPECT_THAT(refusalOf(good + "{elbow: 1, wrist: 0}}"), HasSubstr("deceleration/wrist"));
  EXPECT_THAT(refusalOf(good + "1, reaction_time: 11}"),
              HasSubstr("a number from 0.000000 to 10.0000"));
  EXPECT_THAT(refusalOf(good + "{elbow: 1, wrist: 1, wrst: 1}}"),
              HasSubstr("'wrst' is not in joints; did you mean 'wrist'?"));
}

TEST(JointPositions, OfEachJointTheNewestStampCountsInWhateverOrderTheyCome) {
  JointPositions positions;
  positions.take(jointState(2.0, {"a", "b"}, {0.2, 0.4}), 2.0, 0.1);
  positions.take(jointState(1.0, {"a"}, {0.1}), 2.0, 0.1);
  positions.take(jointState(3.0, {"b"}, {0.6}), 3.0, 0.1);
  positions.take(jointState(9.0, {"a", "b"}, {9.0, 9.0}), 3.0, 0.1);  // of the future
  EXPECT_EQ(positions.all().at("a").value, 0.2);
  EXPECT_EQ(positions.all().at("b").value, 0.6);
  EXPECT_THROW(positions.oldestOf({"a", "b"}, 3.0, 0.1), InputError) << "ahead of the clock";
  EXPECT_EQ(positions.oldestOf({"a", "b"}, 3.2, 0.1), 2.0) << "the clock goes on without more";
  EXPECT_EQ(positions.newestStampOf({"a", "b", "c"}), 3.0);
  EXPECT_THROW(positions.oldestOf({"a", "c"}, 3.2, 0.1), InputError);
  positions.take(jointState(4.0, {"a"}, {std::numeric_limits<double>::quiet_NaN()}), 4.0, 0.1);
  EXPECT_THROW(positions.oldestOf({"a"}, 4.0, 0.1), InputError);
}

TEST(JointPositions, AheadOfTheClockAreTakenUpToTheToleranceAndAgainAtTheSameStamp) {
  JointPositions positions;
  positions.take(jointState(2.5, {"a", "c"}, {0.2, 0.4}), 2.0, 0.5);
  EXPECT_EQ(positions.all().size(), 2u);
  positions.take(jointState(2.5, {"a"}, {0.3}), 2.0, 0.5);
  EXPECT_EQ(positions.all().at("a").value, 0.3);
  EXPECT_EQ(refusal([&] { positions.oldestOf({"b"}, 2.0, 0.5); }), "nobody reports joint 'b'");
  positions.take(jointState(2.5, {"a"}, {HUGE_VAL}), 2.0, 0.5);
  EXPECT_EQ(refusal([&] { positions.oldestOf({"a"}, 2.0, 0.5); }),
            "the position of joint 'a' is not finite");
}

// Whatever names arrive, those of the past and those that are refused.
TEST(JointPositions, AreOfTenThousandNamesAtMost) {
  JointPositions positions;
  for (int i = 0; i < 30000; ++i) {
    positions.take(jointState(i % 2 ? 1.0 : 9.0, {"joint" + std::to_string(i)}, {0.5}), 1.0, 0.1);
  }
  EXPECT_EQ(positions.all().size(), 5000u);
  positions.take(jointState(1.0, {"joint1"}, {0.7}), 1.0, 0.1);
  EXPECT_EQ(positions.all().at("joint1").value, 0.7);
  positions.take(jointState(1.0, {"uneven"}, {}), 1.0, 0.1);
  EXPECT_EQ(refusal([&] { positions.oldestOf({"uneven"}, 1.0, 0.1); }),
            "nobody reports joint 'uneven'");
  EXPECT_EQ(refusal([&] { positions.oldestOf({"joint29999"}, 1.0, 0.1); }),
            "nobody reports joint 'joint29999'");
}

TEST(JointPositions, AreMeasuredNoLaterThanTheyArrive) {
  RandomInputs random;
  for (int i = 0; i < 1000; ++i) {
    JointPositions positions;
    const double arrived = random.uniform(1.0, 9.0), offset = random.uniform(-0.5, 0.1);
    positions.take(jointState(arrived + offset, {"a"}, {0.2}), arrived, 0.1);
    EXPECT_LE(positions.oldestOf({"a"}, arrived, 0.1), arrived) << offset;
    EXPECT_NEAR(positions.oldestOf({"a"}, arrived, 0.1), arrived + std::min(offset, 0.0), 1e-6);
    EXPECT_NEAR(positions.newestStampOf({"a"}), arrived + offset, 1e-6);
  }
}

// Of a clock that is late, or of a sender whose clock is ahead: nobody knows which.
TEST(JointPositions, ThatAreRefusedLeaveNoOlderOnesInForce) {
  JointPositions positions;
  positions.take(jointState(2.0, {"a", "b"}, {0.2, 0.3}), 2.0, 0.1);
  positions.take(jointState(2.2, {"a"}, {0.4}), 2.0, 0.1);
  EXPECT_EQ(refusal([&] {
              positions.oldestOf({"a", "b"}, 2.0, 0.1);
            }),
            "the position of joint 'a' is stamped 0.20 s ahead of the clock: is /clock late, or "
            "the clock of a computer ahead?");
  EXPECT_EQ(positions.oldestOf({"b"}, 2.0, 0.1), 2.0) << "of other joints it says nothing";
  positions.take(jointState(2.05, {"a"}, {0.3}), 2.0, 0.1);  // late, and not the newest
  EXPECT_THROW(positions.oldestOf({"a"}, 2.05, 0.1), InputError);
  positions.take(jointState(2.3, {"a"}, {0.5}), 2.3, 0.1);
  EXPECT_EQ(positions.oldestOf({"a"}, 2.3, 0.1), 2.3) << "the clock has caught up";
  positions.take(jointState(9.0, {"a"}, {0.5}), 2.3, 0.1);
  positions.clear();
  EXPECT_EQ(refusal([&] { positions.oldestOf({"a"}, 2.3, 0.1); }), "nobody reports joint 'a'");
}

}  // namespace collision_pairs::test_limiter_input
