// The watch of the velocity limiter: silent beside robots that do what is assumed, and soon awake
// beside those that do not.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "benchmark/simulated_joints.h"
#include "random_inputs.h"
#include "response_watch.h"

namespace collision_pairs::test_response_watch {

constexpr double STEP = 0.001;         // s
constexpr double NOISE = 0.001;        // rad
constexpr double STAMP_ERROR = 0.004;  // s
constexpr double INF = std::numeric_limits<double>::infinity();

/// A robot with noise, whose states come late and by a clock that is behind, and its watch.
class WatchedRobot {
 public:
  WatchedRobot(RandomInputs& random, const LimiterSettings& settings,
               const std::vector<double>& acceleration)
      : settings_(settings),
        random_(random),
        nb_joints_(acceleration.size()),
        watch_(names(nb_joints_), settings, false),
        joints_(std::vector<double>(nb_joints_, 0.0), acceleration),
        state_period_(random.uniform(0.002, 0.02)),
        behind_(random.integer(0, 1) ? 0.0 : random.uniform(0.0, 0.02)) {
    dead_time = [this] {
      return random_.uniform(0.0, std::max(0.0, settings_.reaction_time - 2.0 * STEP));
    };
  }
  static std::vector<std::string> names(std::size_t nb_joints) {
    std::vector<std::string> all;
    for (std::size_t j = 0; j < nb_joints; ++j) all.push_back("joint_" + std::to_string(j));
    return all;
  }

  // What may be wrong with it.
  std::function<double()> dead_time;
  std::vector<double> carried;  ///< rad/s, by which it is moved beside its commands; may be empty
  std::vector<std::size_t> order;

  void publish(const std::vector<double>& command) {
    send(command);
    watch_.published(now_, now_ + STEP, command);
  }
  /// Only to the robot.
  void send(const std::vector<double>& command) {
    std::vector<double> as_taken = command;
    for (std::size_t j = 0; j < order.size(); ++j) as_taken[order[j]] = command[j];
    joints_.command(now_ + dead_time(), std::move(as_taken));
  }
  void step() {
    joints_.step(now_, STEP);
    offset_.resize(nb_joints_, 0.0);
    for (std::size_t j = 0; j < carried.size(); ++j) offset_[j] += carried[j] * STEP;
    now_ += STEP;
    if (now_ >= next_state_) {
      next_state_ = now_ + state_period_;
      State state{now_ + random_.uniform(0.0, 0.02),
                  now_ + random_.uniform(-STAMP_ERROR, STAMP_ERROR)};
      for (std::size_t j = 0; j < nb_joints_; ++j) {
        state.positions.push_back(joints_.positions()[j] + offset_[j] +
                                  random_.uniform(-NOISE, NOISE));
      }
      if (random_.integer(0, 19) > 0) coming_.push_back(std::move(state));
    }
    for (const State& state : coming_) {
      if (state.arrives > now_) continue;
      for (std::size_t j = 0; j < nb_joints_; ++j) {
        watch_.measured({j, std::min(state.stamp - behind_, now_), state.positions[j]}, now_);
      }
    }
    const auto has_come = [&](const State& state) { return state.arrives <= now_; };
    coming_.erase(std::remove_if(coming_.begin(), coming_.end(), has_come), coming_.end());
  }
  void run(double seconds) {
    for (const double end = now_ + seconds; now_ < end;) step();
  }
  /// Seconds of the same command until the watch says something; infinite after the given time.
  double secondsToFault(const std::vector<double>& command, double most) {
    const double begin = now_;
    for (; now_ < begin + most; step()) {
      publish(command);
      if (!watch_.fault(now_).empty()) return now_ - begin;
    }
    return INF;
  }

  ResponseWatch& watch() { return watch_; }
  std::string fault() { return watch_.fault(now_); }
  double now() const { return now_; }

 private:
  struct State {
    double arrives, stamp;
    std::vector<double> positions{};
  };
  const LimiterSettings settings_;
  RandomInputs& random_;
  const std::size_t nb_joints_;
  ResponseWatch watch_;
  SimulatedJoints joints_;
  const double state_period_, behind_;
  double now_ = 50.0, next_state_ = 0.0;
  std::vector<double> offset_;
  std::vector<State> coming_;
};

/// Of one joint.
LimiterSettings slideSettings(double deceleration) {
  LimiterSettings settings;
  settings.deceleration = {deceleration};
  return settings;
}

LimiterSettings randomSettings(RandomInputs& random, std::size_t nb_joints) {
  LimiterSettings settings;
  settings.reaction_time = random.uniform(0.02, 0.2);
  settings.command_timeout = random.integer(0, 1) ? 0.2 : 0.05;
  for (std::size_t j = 0; j < nb_joints; ++j) {
    settings.deceleration.push_back(random.uniform(0.5, 8.0));
  }
  return settings;
}

std::vector<double> randomCommand(RandomInputs& random, std::size_t nb_joints) {
  std::vector<double> command(nb_joints);
  for (double& x : command) x = random.integer(0, 3) ? random.uniform(-1.5, 1.5) : 0.0;
  return command;
}

// Jumps, steady commands, silence, after which the limiter or only the guard sends zeros.
TEST(ResponseWatch, SaysNothingOfRobotsThatDoWhatIsAssumed) {
  RandomInputs random;
  const double seconds = std::getenv("COLLISION_PAIRS_LONG") ? 36000.0 : 1800.0, run = 60.0;
  for (double done = 0.0; done < seconds; done += run) {
    const std::size_t nb_joints = 3;
    const LimiterSettings settings = randomSettings(random, nb_joints);
    std::vector<double> acceleration = settings.deceleration;
    for (double& a : acceleration) a *= random.integer(0, 1) ? 1.0 : random.uniform(1.0, 100.0);
    WatchedRobot robot(random, settings, acceleration);
    if (random.integer(0, 2) == 0) robot.dead_time = [] { return 0.0; };
    const double period = random.uniform(0.004, 0.03);
    std::vector<double> command(nb_joints, 0.0);
    const double end = robot.now() + run;
    while (robot.now() < end) {
      const int kind = random.integer(0, 99);
      if (kind < 3) command = randomCommand(random, nb_joints);
      if (kind == 3) {
        for (double& x : command) x = -x;
      }
      if (kind == 4) {  // the limiter hangs, or nobody asks for anything
        robot.run(settings.command_timeout);
        command.assign(nb_joints, 0.0);
        if (random.integer(0, 1)) {
          robot.send(command);
          robot.run(random.uniform(0.0, 0.5));
        }
      }
      robot.publish(command);
      robot.run(period);
      ASSERT_EQ(robot.fault(), "") << "after " << done << " s";
    }
  }
}

/// Robots at rest that do as assumed but for what `spoil` changes; the longest time to the fault.
double slowestNotice(const std::function<std::vector<double>(RandomInputs&, WatchedRobot&)>& spoil,
                     const std::string& says) {
  RandomInputs random;
  double slowest = 0.0;
  for (int round = 0; round < 100; ++round) {
    LimiterSettings settings;
    settings.reaction_time = 0.048;
    settings.deceleration.assign(3, 6.0);
    WatchedRobot robot(random, settings, std::vector<double>(3, 6.0));
    robot.publish({0.0, 0.0, 0.0});
    robot.run(0.5);
    const std::vector<double> command = spoil(random, robot);
    slowest = std::max(slowest, robot.secondsToFault(command, 2.0));
    EXPECT_NE(robot.fault().find(says), std::string::npos) << robot.fault();
  }
  std::cout << "noticed within " << slowest << " s\n";
  return slowest;
}

const std::vector<double> ZEROS = {0.0, 0.0, 0.0};

TEST(ResponseWatch, NoticesJointsInAnotherOrderWithin200Milliseconds) {
  const auto spoil = [](RandomInputs& random, WatchedRobot& robot) -> std::vector<double> {
    robot.order = {1, 0, 2};
    return {random.uniform(0.4, 1.0), random.uniform(-0.3, 0.0), 0.0};
  };
  EXPECT_LT(slowestNotice(spoil, "in the order of the command"), 0.2);
}

TEST(ResponseWatch, NoticesThatARobotSagsOrIsPushedWithin200Milliseconds) {
  const auto spoil = [](RandomInputs& random, WatchedRobot& robot) {
    robot.carried = {0.0, random.uniform(0.1, 1.0), 0.0};
    return ZEROS;
  };
  EXPECT_LT(slowestNotice(spoil, "off what was passed: it moves without a command"), 0.2);
}

TEST(ResponseWatch, NoticesThatTheReactionTimeIsLongerWithin200Milliseconds) {
  const auto spoil = [](RandomInputs& random, WatchedRobot& robot) -> std::vector<double> {
    robot.dead_time = [&random] { return random.uniform(0.15, 0.25); };
    return {0.0, 0.0, random.uniform(0.7, 1.0)};
  };
  EXPECT_LT(slowestNotice(spoil, "joint 'joint_2'"), 0.2);
}

TEST(ResponseWatch, NoticesADriveThatIsOffWithin200Milliseconds) {
  const auto spoil = [](RandomInputs& random, WatchedRobot& robot) -> std::vector<double> {
    robot.dead_time = [] { return 1e9; };
    return {random.uniform(-1.0, -0.5), 0.0, 0.0};
  };
  EXPECT_LT(slowestNotice(spoil, "does not follow; is its drive on"), 0.2);
}

TEST(ResponseWatch, NoticesThatTheDecelerationIsAThirdWithin200MillisecondsAfterTheReactionTime) {
  RandomInputs random;
  LimiterSettings settings;
  settings.reaction_time = 0.048;
  settings.deceleration.assign(3, 6.0);
  double slowest = 0.0;
  for (int round = 0; round < 100; ++round) {
    WatchedRobot robot(random, settings, {6.0, 2.0, 6.0});
    robot.dead_time = [] { return 0.01; };
    std::vector<double> command = {0.0, random.uniform(0.6, 1.0), 0.0};
    robot.publish(command);
    robot.run(0.3);
    robot.watch().clear();  // what it shows when it sets out is forgotten, here
    robot.run(1.5);
    ASSERT_EQ(robot.fault(), "");
    slowest = std::max(slowest, robot.secondsToFault(ZEROS, 2.0));
    EXPECT_NE(robot.fault().find("it goes further; is deceleration too high"), std::string::npos)
        << robot.fault();
  }
  std::cout << "noticed within " << slowest << " s\n";
  EXPECT_LT(slowest, settings.reaction_time + 0.2);
}

TEST(ResponseWatch, ComparesAStateWithAllBeforeItSoThatASlowDriftIsSeen) {
  RandomInputs random;
  WatchedRobot robot(random, slideSettings(2.0), {2.0});
  robot.carried = {0.001};
  const double took = robot.secondsToFault({0.0}, 60.0);
  EXPECT_GT(took, 7.0) << "of tolerance 0.01 the noise may have taken 0.002";
  EXPECT_LT(took, 12.5);
}

TEST(ResponseWatch, LeavesAPushBelowTheToleranceAlone) {
  RandomInputs random;
  WatchedRobot robot(random, slideSettings(2.0), {2.0});
  robot.carried = {0.07};
  EXPECT_EQ(robot.secondsToFault({0.0}, 0.1), INF);
  robot.carried = {0.0};
  EXPECT_EQ(robot.secondsToFault({0.0}, 5.0), INF);
}

TEST(ResponseWatch, FollowsAJointThatIsReportedWithinATurn) {
  const LimiterSettings settings = slideSettings(2.0);
  ResponseWatch watch({"wheel"}, settings, false);
  watch.published(0.0, 0.0, {1.0});
  for (double now = 1.0; now < 20.0; now += 0.01) {
    watch.published(now, now, {1.0});
    watch.measured({0, now, std::remainder(now, 2.0 * M_PI)}, now);
    ASSERT_EQ(watch.fault(now), "") << now;
  }
  watch.measured({0, 20.01, 0.0}, 20.01);
  EXPECT_NE(watch.fault(20.01), "") << "but not anything";
}

// The guard counts from when it hears of a command, and the limiter's thread may be held up after
// it has sent one.
TEST(ResponseWatch, ExpectsTheZerosOfTheGuardAlthoughPublishingTookLong) {
  const LimiterSettings settings = slideSettings(5.0);
  ResponseWatch watch({"slide"}, settings, false);
  SimulatedJoints robot({0.0}, {5.0});
  double now = 10.0;
  const auto run = [&](double seconds) {
    for (const double end = now + seconds; now < end; now += STEP) robot.step(now, STEP);
  };
  for (int i = 0; i < 100; ++i) {
    robot.command(now, {1.0});
    watch.published(now, now, {1.0});
    run(0.01);
    watch.measured({0, now, robot.positions()[0]}, now);
  }
  const double begun = now;
  robot.command(now, {0.9});
  run(settings.command_timeout);
  robot.command(now, {0.0});
  run(0.3);
  watch.published(begun, now, {0.9});
  watch.published(now, now, {0.9});
  watch.measured({0, now, robot.positions()[0]}, now);
  EXPECT_EQ(watch.fault(now), "");
}

TEST(ResponseWatch, OfARobotThatMayStandNoticesOnlyWhatGoesFurtherOrMovesWithoutACommand) {
  const LimiterSettings settings = slideSettings(5.0);
  const auto faultOf = [&](double commanded, double speed) {
    ResponseWatch watch({"elbow"}, settings, true);
    for (double now = 1.0; now < 3.0; now += 0.01) {
      watch.published(now, now, {commanded});
      watch.measured({0, now, speed * now}, now);
    }
    return watch.fault(3.0);
  };
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_EQ(faultOf(sign, sign), "");
    EXPECT_EQ(faultOf(sign, 0.7 * sign), "") << "on its way to positions that are ahead of it";
    EXPECT_EQ(faultOf(sign, 0.0), "");
    EXPECT_NE(faultOf(sign, 1.1 * sign).find("it goes further"), std::string::npos);
    EXPECT_NE(faultOf(sign, -0.1 * sign), "");
    EXPECT_NE(faultOf(0.0, 0.1 * sign).find("without a command"), std::string::npos);
  }
}

TEST(ResponseWatch, LetsCommandsPassOnceTheyHaveRestedForASecondAndNothingElseHappened) {
  const LimiterSettings settings = slideSettings(2.0);
  ResponseWatch watch({"slide"}, settings, false);
  watch.measured({0, 1.0, 0.0}, 1.0);
  watch.measured({0, 1.01, 0.5}, 1.01);
  const std::string first = watch.fault(1.01);
  EXPECT_NE(first.find("joint 'slide' is 0.500"), std::string::npos) << first;
  watch.measured({0, 1.5, 0.9}, 1.5);
  EXPECT_EQ(watch.fault(2.4), first);
  watch.asked(2.4);
  EXPECT_EQ(watch.fault(3.3), first);
  EXPECT_EQ(watch.fault(3.41), "");
  watch.asked(3.42);
  EXPECT_EQ(watch.fault(3.43), "");
  watch.measured({0, 3.5, 0.0}, 3.5);
  watch.asked(9.0);  // nobody looked meanwhile
  EXPECT_EQ(watch.fault(9.0), "");
}

TEST(ResponseWatch, DoesNotCompareWhatIsOlderNotFiniteOrOfAnotherTime) {
  const LimiterSettings settings = slideSettings(2.0);
  ResponseWatch watch({"slide"}, settings, false);
  watch.measured({0, 1.0, 0.0}, 1.0);
  watch.measured({0, 0.9, 5.0}, 1.1);
  watch.measured({0, 1.0, 5.0}, 1.1);
  watch.measured({0, 1.2, std::nan("")}, 1.2);
  watch.measured({0, 2.3, 5.0}, 2.3);
  EXPECT_EQ(watch.fault(2.3), "");
  watch.measured({0, 2.4, 0.0}, 3.4);  // it came so late that commands of its time are forgotten
  EXPECT_EQ(watch.fault(3.4), "");
  watch.clear();
  watch.measured({0, 2.4, 0.0}, 2.4);
  EXPECT_EQ(watch.fault(2.4), "");
  watch.measured({0, 2.5, 1.0}, 2.5);
  EXPECT_NE(watch.fault(2.5), "");
}

}  // namespace collision_pairs::test_response_watch
