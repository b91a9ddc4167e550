// The trajectory commands that the limiter passes, and the zeros in place of those it refuses.
#include <cmath>

#include <gmock/gmock.h>

#include "joint_states.h"
#include "limited_command.h"
#include "printed.h"
#include "random_inputs.h"
#include "refusal.h"
#include "trajectory_command.h"

namespace collision_pairs::test_limiter_trajectory {
using testing::ElementsAre;
using testing::IsEmpty;

class TrajectoryOfTwo : public testing::Test {
 protected:
  TrajectoryOfTwo() {
    command_.header.frame_id = "base";
    command_.joint_names = {"b", "a"};
    command_.points.resize(1);
    command_.points[0].velocities = {2.0, 1.0};
    command_.points[0].positions = {20.0, 11.0};
    command_.points[0].time_from_start = ros::Duration(3.0);
    measured_.take(jointState(1.0, {"a", "b"}, {10.0, 12.0}), 1.0, 0.1);
    decision_.scale = 0.5;
    decision_.command = {0.5, 1.0};
    parameters_.joints = {"a", "b"};
    parameters_.law.reaction_time = 3.0;
    parameters_.law.max_joint_state_age = 0.1;
  }
  std::string refused() const {
    return refusal(
        [&] { velocitiesOf(command_, parameters_.joints, parameters_.law.reaction_time); });
  }
  trajectory_msgs::JointTrajectory passed() const {
    return limitedTrajectory(command_, parameters_, decision_, measured_, now_);
  }
  std::string limited() const { return printed(passed()); }
  trajectory_msgs::JointTrajectory command_;
  LimiterParameters parameters_;
  JointPositions measured_;
  double now_ = 1.05;
  LimiterDecision decision_;
};

TEST_F(TrajectoryOfTwo, IsPassedWithAllThatItSays) {
  const std::string begin = "header frame_id base joint_names[0] b joint_names[1] a points[0] ",
                    end = " time_from_start 3.000000000";
  const std::string velocities = "velocities[0] 1 velocities[1] 0.5";
  EXPECT_EQ(limited(), begin + "positions[0] 15 positions[1] 10.5 " + velocities + end)
      << "b, at 12 and on its way to 20, no further than 1.0 leads in 3 s";
  decision_.scale = 0.0;
  EXPECT_EQ(limited(), begin + "positions[0] 12 positions[1] 10 " + velocities + end);
  decision_ = {};
  decision_.scale = 1.0;
  decision_.command = {0.5, 0.0};  // b stays, wherever it should go
  EXPECT_EQ(limited(),
            begin + "positions[0] 12 positions[1] 11 velocities[0] velocities[1] 0.5" + end);
  decision_.command = {0.5, 1.0};
  decision_.scale = 0.0;
  command_.points[0].positions[0] = std::nan("");
  EXPECT_EQ(limited(), begin + "positions[0] 12 positions[1] 10 " + velocities + end);
  measured_.take(jointState(1.01, {"b"}, {std::nan("")}), 1.01, 0.1);
  EXPECT_EQ(limited(), begin + velocities + end) << "not from what nobody knows";
  command_.points[0].positions.pop_back();
  EXPECT_EQ(limited(), begin + velocities + end);
}

// A trajectory controller drops a point of the past, and begins a ramp anew with each point.
TEST_F(TrajectoryOfTwo, StopsNowAndInItsOwnTime) {
  command_.header.stamp = ros::Time(17.0);
  decision_.command = {0.5, 1.0};
  EXPECT_TRUE(passed().header.stamp.isZero()) << "later it is not certified";
  for (const double given : {0.0, -1.0}) {
    command_.points[0].time_from_start = ros::Duration(given);
    EXPECT_EQ(passed().points[0].time_from_start, ros::Duration(0.01)) << "else it is dropped";
  }
  decision_ = {};
  decision_.command = {0.0, 0.0};
  const auto stop = [&](double given) {
    command_.points[0].time_from_start = ros::Duration(given);
    const auto limited = passed();
    EXPECT_TRUE(limited.header.stamp.isZero()) << "at once";
    EXPECT_EQ(limited.header.frame_id, "base");
    EXPECT_THAT(limited.points[0].velocities, ElementsAre(0.0, 0.0));
    EXPECT_THAT(limited.points[0].positions, ElementsAre(12.0, 10.0));
    return limited.points[0].time_from_start.toSec();
  };
  EXPECT_DOUBLE_EQ(stop(3.0), 3.0);
  EXPECT_DOUBLE_EQ(stop(0.1), 0.1);
  EXPECT_DOUBLE_EQ(stop(0.0), 0.01) << "a point of now is dropped";
  EXPECT_DOUBLE_EQ(stop(-1.0), 0.01);
  command_.points.clear();
  EXPECT_EQ(passed().points[0].time_from_start, ros::Duration(0.01));
}

// The controller takes all of that time, and a robot that is to stop in a metre would not.
TEST_F(TrajectoryOfTwo, IsReachedWithinTheReactionTime) {
  EXPECT_EQ(refused(), "accepted");
  command_.points[0].time_from_start = ros::Duration(3.001);
  EXPECT_EQ(refused(),
            "the command has a time_from_start of 3.001 s, but must be in effect within "
            "reaction_time, 3 s");
  const auto zeros = passed().points[0];
  EXPECT_THAT(zeros.velocities, ElementsAre(0.0, 0.0));
  EXPECT_EQ(zeros.time_from_start, ros::Duration(0.01));
}

// A controller that begins a ramp with each point, and gets one every 20 ms, slows down more and
// more slowly; but on the way that it has in the reaction time at its velocity.
TEST_F(TrajectoryOfTwo, ZerosThatRepeatStopTheRobotOnTheWayOfTheReactionTime) {
  constexpr double PERIOD = 0.02, VELOCITY = 0.5, STEP = 0.001;
  parameters_.law.reaction_time = 0.1;
  decision_ = {};
  decision_.command = {0.0, 0.0};
  for (const double given : {-1.0, 0.0, 0.03, 0.1, 0.11, 1.0}) {
    command_.points[0].time_from_start = ros::Duration(given);
    const double ramp = passed().points[0].time_from_start.toSec();
    double velocity = VELOCITY, way = 0.0;
    for (int period = 0; period < 500; ++period) {
      const double rate = velocity / ramp;
      for (double t = 0.0; t < PERIOD - 1e-9; t += STEP) {
        way += STEP * velocity;
        velocity = std::max(0.0, velocity - STEP * rate);
      }
    }
    EXPECT_LT(velocity, 1e-6) << given;
    EXPECT_LE(way, VELOCITY * (parameters_.law.reaction_time + STEP)) << given;
  }
}

// A controller would go there in the time of a stop, from wherever the robot is now.
TEST_F(TrajectoryOfTwo, HasNoPositionsWhereTheRobotMayNoLongerBe) {
  for (const double scale : {0.0, 0.5}) {
    decision_.scale = scale;
    const auto has = [&](double now) {
      now_ = now;
      const auto point = passed().points[0];
      EXPECT_EQ(point.velocities.size(), 2u);
      return !point.positions.empty();
    };
    EXPECT_TRUE(has(1.09));
    EXPECT_FALSE(has(1.11)) << "nobody has reported for so long";
    EXPECT_TRUE(has(0.91)) << "stamps may be a little ahead";
    EXPECT_FALSE(has(0.5)) << "the clock went back";
    measured_.take(jointState(1.3, {"a"}, {0.0}), 1.1, 0.1);
    EXPECT_FALSE(has(1.1)) << "newer ones are refused, which are ahead of the clock";
    measured_.clear();
    measured_.take(jointState(1.0, {"a", "b"}, {10.0, 12.0}), 1.0, 0.1);
  }
}

TEST_F(TrajectoryOfTwo, LeadsNowhereThatItsVelocitiesDoNot) {
  RandomInputs random;
  for (int i = 0; i < 1000; ++i) {
    decision_.scale = random.uniform(0.0, 1.0);
    decision_.command = {random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0)};
    command_.points[0].positions = {12.0 + random.uniform(-2.0, 2.0),
                                    10.0 + random.uniform(-2.0, 2.0)};
    command_.points[0].time_from_start = ros::Duration(random.uniform(-1.0, 2.0));
    const auto limited = passed().points[0];
    const double seconds = limited.time_from_start.toSec();
    for (std::size_t joint : {0, 1}) {
      const double moved = limited.positions[joint] - (joint == 0 ? 12.0 : 10.0);
      EXPECT_GE(moved * limited.velocities[joint], 0.0) << "against its velocity";
      const double reach = std::abs(limited.velocities[joint]) * std::max(0.0, seconds);
      EXPECT_LE(std::abs(moved), reach + 1e-14);
      EXPECT_LE(std::abs(moved), 2.0 * decision_.scale);
    }
  }
}

TEST_F(TrajectoryOfTwo, IsRefusedWithTheReason) {
  EXPECT_EQ(refused(), "accepted");
  command_.joint_names = {"b", "c"};
  EXPECT_EQ(refused(), "the command has no velocity for joint 'a'");
  command_.joint_names = {"b", "a", "c"};
  EXPECT_EQ(refused(), "the command has 2 velocities for 3 joints, but 2 joints are limited");
  command_.joint_names = {"b", "a"};
  command_.points[0].velocities.push_back(1.0);
  EXPECT_EQ(refused(), "the command has 3 velocities for 2 joints, but 2 joints are limited");
  command_.points.resize(2);
  EXPECT_EQ(refused(), "the command has 2 points, but must have one");
  command_.points.clear();
  EXPECT_EQ(refused(), "the command has 0 points, but must have one");
}

// They stop all joints, whatever a command names that cannot be used.
TEST_F(TrajectoryOfTwo, ThatIsRefusedIsAnsweredByZerosOfTheLimitersJoints) {
  const auto refused_one = command_;
  const auto expectZeros = [&](const std::vector<double>& positions) {
    EXPECT_NE(refused(), "accepted");
    const auto zeros = passed();
    EXPECT_THAT(zeros.joint_names, ElementsAre("a", "b"));
    ASSERT_EQ(zeros.points.size(), 1u);
    EXPECT_THAT(zeros.points[0].velocities, ElementsAre(0.0, 0.0));
    EXPECT_EQ(zeros.points[0].positions, positions);
    EXPECT_EQ(zeros.points[0].time_from_start, ros::Duration(0.01));
    command_ = refused_one;
  };
  const std::vector<double> measured = {10.0, 12.0};
  const std::vector<std::vector<std::string>> others = {
      {}, {"a"}, {"b", "c"}, {"a", "a"}, {"a", "b", "c"}};
  for (const auto& names : others) {
    command_.joint_names = names;
    expectZeros(measured);
  }
  command_.points[0].velocities.pop_back();
  expectZeros(measured);
  command_.points.push_back(command_.points[0]);
  expectZeros(measured);
  command_.points[0].velocities.clear();
  command_.points[0].positions.clear();
  expectZeros({});
  command_.points.clear();
  expectZeros({});
  command_ = {};
  expectZeros({});
}

}  // namespace collision_pairs::test_limiter_trajectory
