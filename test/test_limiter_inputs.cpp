// What the limiter makes of the joint states and times that it has received.
#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>

#include <gmock/gmock.h>

#include "benchmark/simulated_joints.h"
#include "joint_states.h"
#include "limiter_inputs.h"
#include "monitored_robot.h"
#include "published_decisions.h"

namespace collision_pairs::test_limiter_inputs {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr double STEP = 0.001;  // s

// At 2 m/s; commands of 0.2 m/s, and then zeros, come at every phase of the clock, and joint states
// 20 ms late.
TEST(LimiterInputs, WithAClockOf10HertzASimulatedRobotStaysWithinTheTube) {
  constexpr int TICK = 100, LATE = 21, MOST = 5000;  // steps
  LimiterSettings settings;
  settings.deceleration = {5.0};
  settings.ramp_up = 1e6;
  settings.max_joint_state_age = 0.4;
  for (int slower_at = 2000; slower_at < 2100; slower_at += 3) {
    LimiterInputs inputs({{"slide"}, settings.max_joint_state_age, 0.2, true, false});
    LimiterLaw law(settings);
    FreeSurroundings free;
    SimulatedJoints robot({0.0}, {5.0});
    std::deque<double> measured(LATE, 0.0);
    double furthest = std::numeric_limits<double>::infinity();
    LimiterInputs::Clocks clocks;
    for (int i = 0; i < MOST; ++i) {
      const double now = 50.0 + i * STEP;
      clocks = {50.0 + i / TICK * TICK * STEP, now, 0};
      measured.push_back(robot.positions()[0]);
      measured.pop_front();
      if (i % 4 == 0)
        inputs.take(jointState(now - (LATE - 1) * STEP, {"slide"}, {measured.front()}), clocks);
      if (i % 10 == slower_at % 10) {
        const double speed = i < slower_at ? 2.0 : i < slower_at + 30 ? 0.2 : 0.0;
        LimiterInput input = inputs.at(clocks, 0.02).input;
        input.command = {speed};
        const LimiterDecision decision = law.decide(input, free);
        law.published(inputs.follow(clocks).latest, decision);
        robot.command(now + settings.reaction_time - STEP, decision.command);
        if (i == slower_at + 20) {
          furthest = inputs.positions().all().at("slide").value +
                     std::max(free.tube.from[0], free.tube.to[0]) + free.tube.deviation[0];
        }
      }
      robot.step(now, STEP);
    }
    ASSERT_LE(robot.positions()[0], furthest + 1e-6) << slower_at;
    ASSERT_GT(robot.positions()[0], 1.0);
  }
}

TEST(LimiterInputs, EachJointsPositionIsOfItsOwnTime) {
  LimiterInputs inputs({{"a", "b"}, 0.1, 0.2, false, false});
  inputs.take(jointState(100.0, {"a"}, {0.5}), {100.0, 7.0, 0});
  inputs.take(jointState(100.06, {"b"}, {0.5}), {100.06, 7.06, 0});
  const LimiterInput input = inputs.at({100.07, 7.07, 0}, 0.02).input;
  EXPECT_NEAR(input.now - input.stamp, 0.09, 1e-9);
  ASSERT_EQ(input.later.size(), 2u);
  EXPECT_EQ(input.later[0], 0.0);
  EXPECT_NEAR(input.later[1], 0.06, 1e-9);
}

/// Two fingers, the second of which follows the first, and a lid that is not commanded.
class Hand {
 public:
  Hand() {
    load(monitor_, parametersOf(boxLink("palm", 0.1) + boxLink("one", 0.1) + boxLink("two", 0.1) +
                                boxLink("lid", 0.1) +
                                joint("first", "continuous", "palm", "one", "1 0 0", "") +
                                joint("second", "continuous", "palm", "two", "2 0 0",
                                      "<mimic joint='first' multiplier='2'/>") +
                                joint("hinge", "continuous", "palm", "lid", "3 0 0", "")));
  }
  void measure(double at, const std::vector<std::string>& joints,
               const std::vector<double>& positions) {
    inputs_.take(jointState(at, joints, positions), {at, at, 0});
  }
  Snapshot snapshot(double at) {
    monitor_.advance(ros::Time(at));
    return snapshotAt(inputs_.at({at, at, 0}, 0.02), monitor_, input_, state_);
  }
  const RobotState& state() const { return state_; }

 private:
  Monitor monitor_{TransformSettings()};
  LimiterInputs inputs_{{{"first"}, 0.1, 0.2, false, false, 0.01, 1.0}};
  LimiterInput input_;
  RobotState state_;
};

TEST(LimiterInputs, AJointThatFollowsAnotherHasToBeWhereThatHasIt) {
  for (const double off : {0.0, 0.009, -0.009, 0.011, -0.5, double(NAN)}) {
    Hand hand;
    hand.measure(100.0, {"first", "second", "hinge"}, {0.3, 0.6 + off, 0.0});
    const auto reasons = hand.snapshot(100.0).poses.unknown_because;
    if (std::abs(off) < 0.01) {
      EXPECT_THAT(reasons, IsEmpty()) << off;
    } else {
      EXPECT_THAT(reasons, ElementsAre(testing::HasSubstr("joint 'second' is "))) << off;
    }
  }
  Hand hand;
  hand.measure(100.0, {"second"}, {5.0});
  hand.measure(100.2, {"first", "hinge"}, {0.3, 0.0});
  EXPECT_THAT(hand.snapshot(100.2).poses.unknown_because, IsEmpty()) << "an old one says nothing";
}

TEST(LimiterInputs, AJointThatIsNotCommandedStandsWhereItWasReportedWithinThePoseAge) {
  Hand hand;
  hand.measure(100.0, {"hinge"}, {0.7});
  for (const double later : {0.05, 0.5, 0.9}) {
    hand.measure(100.0 + later, {"first"}, {0.3});
    const Snapshot snapshot = hand.snapshot(100.0 + later);
    const RobotModel& robot = snapshot.scene->scene->robot();
    EXPECT_EQ(hand.state().positions[robot.findJoint("hinge")], 0.7) << later;
    EXPECT_FALSE(hand.state().placed[robot.links()[robot.findLink("lid")].body]) << later;
  }
  hand.measure(101.2, {"first"}, {0.3});
  EXPECT_NE(hand.snapshot(101.2).poses.unknown_because.size(), 0u) << "TF does not know it either";
}

TEST(LimiterInputs, HandOnWhatIsNewOfAJointOnce) {
  LimiterInputs inputs({{"slide"}, 0.1, 0.2, false, false});
  const auto taken = inputs.take(jointState(99.99, {"slide"}, {0.5}), {100.0, 7.0, 0});
  ASSERT_EQ(taken.positions.size(), 1u);
  EXPECT_NEAR(taken.positions[0].stamp, 6.99, 1e-9);
  EXPECT_EQ(taken.positions[0].value, 0.5);
  EXPECT_TRUE(inputs.take(jointState(100.0, {"other"}, {0.1}), {100.0, 7.0, 0}).positions.empty());
  EXPECT_TRUE(inputs.take(jointState(99.98, {"slide"}, {0.6}), {100.01, 7.01, 0}).positions.empty())
      << "older";
  EXPECT_EQ(inputs.take(jointState(100.02, {"slide"}, {0.6}), {100.02, 7.02, 0}).positions.size(),
            1u);
}

TEST(LimiterInputs, SayWhenTheComputersClockWasSet) {
  LimiterInputs inputs({{"slide"}, 0.1, 0.2, false, false});
  inputs.take(jointState(100.0, {"slide"}, {0.5}), {100.0, 7.0, 0});
  EXPECT_FALSE(inputs.take(jointState(100.01, {"slide"}, {0.5}), {100.01, 7.0102, 0}).has_jumped);
  for (const double by : {-0.015, 0.015, -5.0, 60.0}) {
    LimiterInputs set = inputs;
    EXPECT_TRUE(set.take(jointState(100.02, {"slide"}, {0.5}), {100.02 + by, 7.02, 0}).has_jumped)
        << by;
    EXPECT_FALSE(set.take(jointState(100.03, {"slide"}, {0.5}), {100.03 + by, 7.03, 0}).has_jumped)
        << by;
  }
}

// As of robot_state_publisher: nobody knows which position belongs to which name.
TEST(LimiterInputs, OfAMessageWhoseNamesAndPositionsDifferInNumberNothingIsUsed) {
  const std::string why =
      "no position of joint 'a': names and positions of its joint state differ in number";
  const std::vector<std::vector<double>> uneven = {{}, {0.1}, {0.1, 0.2, 0.3}};
  for (const std::vector<double>& positions : uneven) {
    LimiterInputs inputs({{"a", "b"}, 0.1, 0.2, false, false});
    EXPECT_THAT(inputs.take(jointState(100.0, {"/a", "b"}, positions), {100.0, 7.0, 0}).positions,
                IsEmpty());
    EXPECT_THAT(inputs.at({100.0, 7.0, 0}, 0.02).unknown_because, ElementsAre(why));
    EXPECT_EQ(
        inputs.take(jointState(100.01, {"a", "b"}, {0.5, 0.6}), {100.01, 7.01, 0}).positions.size(),
        2u);
    inputs.take(jointState(100.1, {"a", "b"}, positions), {100.1, 7.1, 0});
    EXPECT_THAT(inputs.at({100.1, 7.1, 0}, 0.02).unknown_because, IsEmpty())
        << "what came before is young";
    EXPECT_EQ(inputs.positions().all().at("a").value, 0.5);
    inputs.take(jointState(100.12, {"a", "b"}, positions), {100.12, 7.12, 0});
    EXPECT_THAT(inputs.at({100.12, 7.12, 0}, 0.02).unknown_because, ElementsAre(why));
    inputs.take(jointState(100.13, {"a"}, {0.7}), {100.13, 7.13, 0});
    inputs.take(jointState(100.13, {"b"}, {0.7}), {100.13, 7.13, 0});
    EXPECT_THAT(inputs.at({100.13, 7.13, 0}, 0.02).unknown_because, IsEmpty());
  }
}

TEST(LimiterInputs, OfANameThatComesTwiceTheFirstPositionCounts) {
  LimiterInputs inputs({{"a"}, 0.1, 0.2, false, false});
  for (const char* again : {"a", "/a"}) {
    inputs.take(jointState(100.0, {"a", "b", again}, {0.5, 0.6, -5.0}), {100.0, 7.0, 0});
    EXPECT_EQ(inputs.positions().all().at("a").value, 0.5);
  }
}

}  // namespace collision_pairs::test_limiter_inputs
