// A robot that follows commands as said stays within the tube until it stands.
#include <algorithm>

#include <gtest/gtest.h>

#include "benchmark/simulated_joints.h"
#include "random_inputs.h"
#include "stopping_tube.h"

namespace collision_pairs::test_stopping_tube {

constexpr double STEP = 0.0005;
constexpr double ROUNDING = 1e-9;

/// How far a displacement is from the tube: 0 within; else rad by which a joint is outside, at the
/// best place on the segment, roughly.
double outside(const StoppingTube& tube, const std::vector<double>& displacement) {
  constexpr int PLACES = 2000;
  double least = 1e300;
  for (int k = 0; k <= PLACES; ++k) {
    const double f = static_cast<double>(k) / PLACES;
    double most = 0.0;
    for (std::size_t j = 0; j < displacement.size(); ++j) {
      const double off = displacement[j] - (tube.from[j] + f * (tube.to[j] - tube.from[j]));
      const double grid = std::abs(tube.to[j] - tube.from[j]) / PLACES;  // half of it would do
      most = std::max(most, std::abs(off) - tube.deviation[j] - grid);
    }
    least = std::min(least, most);
  }
  return least;
}

std::vector<double> randomCommand(RandomInputs& random, int nb_joints) {
  std::vector<double> command;
  for (int j = 0; j < nb_joints; ++j) command.push_back(random.uniform(-1.0, 1.0));
  return command;
}

/// Commands like those before, or others: a scale that falls, jumps, reversals, noise; or noise
/// alone, so that slow joints come near their command.
std::vector<double> nextCommand(RandomInputs& random, std::vector<double> command, bool is_steady) {
  if (is_steady) {
    for (double& x : command) x += random.uniform(-0.001, 0.001);
    return command;
  }
  const int kind = random.integer(0, 19);
  if (kind == 0) return randomCommand(random, static_cast<int>(command.size()));
  for (double& x : command) {
    if (kind == 1) x = -x;
    if (kind == 2) x = 0.0;
    if (kind < 6) x *= 0.9;
    if (kind == 7) x += random.uniform(-0.05, 0.05);
  }
  return command;
}

TEST(StoppingTube, ContainsWhatARobotDoesWhateverItsDeadTimesAndAccelerations) {
  RandomInputs random;
  double most_seconds = 0.0;
  for (int round = 0; round < 400; ++round) {
    const int nb_joints = random.integer(1, 4);
    RobotResponse response;
    response.reaction_time = random.uniform(0.0, 0.2);
    response.hold = random.uniform(0.01, 0.3);
    std::vector<double> acceleration;
    const bool is_steady = round % 2 == 0;
    for (int j = 0; j < nb_joints; ++j) {
      response.deceleration.push_back(random.integer(0, 1) ? random.uniform(0.2, 1.0)
                                                           : random.uniform(0.5, 8.0));
      acceleration.push_back(response.deceleration.back() *
                             (random.integer(0, 1) ? 1.0 : random.uniform(1.0, 20.0)));
    }
    PassedCommands passed(response);
    const int kind = random.integer(0, 2);  // dead times: longest, shortest, any
    const auto deadTime = [&] {
      const double most = std::max(response.reaction_time - STEP, 0.0);
      return kind == 0 ? most : kind == 1 ? 0.0 : random.uniform(0.0, most);
    };
    SimulatedJoints robot(std::vector<double>(nb_joints, 0.0), acceleration);
    const double period = random.uniform(0.004, is_steady ? 2.0 : 0.05);
    std::vector<double> command = randomCommand(random, nb_joints);
    double next = 0.0, now = 0.0;
    std::vector<double> measured = robot.positions(), stamps(measured.size(), 0.0);
    const double decided = random.uniform(0.0, is_steady ? 5.0 : 1.0);
    std::vector<double> ages(measured.size(), random.uniform(0.0, 0.05));
    if (round % 4 > 1) {  // each joint is measured by its own drive
      for (double& age : ages) age = random.uniform(0.0, 0.3);
    }
    for (; now < decided; now += STEP) {
      if (now >= next) {
        next = now + period;
        passed.add(now, command);
        robot.command(now + deadTime(), command);
        command = nextCommand(random, command, is_steady);
      }
      robot.step(now, STEP);
      for (std::size_t j = 0; j < measured.size(); ++j) {
        if (now + STEP > decided - ages[j]) continue;
        stamps[j] = now + STEP;
        measured[j] = robot.positions()[j];
      }
    }
    const double stamp = *std::min_element(stamps.begin(), stamps.end());
    std::vector<double> later;
    for (const double of_joint : stamps) later.push_back(of_joint - stamp);
    bool is_zero = true;
    for (const double x : command) is_zero &= x == 0.0;
    if (is_zero) continue;
    std::vector<double> scaled = command;
    const double scale = std::min(1.0, std::max(0.0, random.uniform(-0.2, 2.0)));
    for (double& x : scaled) x *= scale;
    const StoppingTube tube = passed.tube(stamp, now, command, scaled, later);
    std::vector<double> displacement(measured.size());
    const auto expectInside = [&] {
      for (std::size_t j = 0; j < measured.size(); ++j) {
        displacement[j] = robot.positions()[j] - measured[j];
      }
      ASSERT_LE(outside(tube, displacement), ROUNDING) << "round " << round;
    };
    robot.command(now + deadTime(), scaled);
    robot.command(now + random.uniform(0.0, 1.0) * (response.hold - STEP) + deadTime(),
                  std::vector<double>(measured.size(), 0.0));
    const double end = stamp + tube.seconds + 2.0 * STEP;
    for (int i = 0; now < end; ++i, now += STEP) {
      robot.step(now, STEP);
      if (i % 20 == 0) expectInside();
      if (HasFatalFailure()) return;
    }
    expectInside();
    EXPECT_TRUE(robot.stand()) << "round " << round;
    most_seconds = std::max(most_seconds, tube.seconds);
  }
  EXPECT_GT(most_seconds, 0.5);
}

TEST(StoppingTube, OfASteadyCommandIsTheWayOfItsTimeAndOfBraking) {
  PassedCommands passed({0.1, 0.2, {2.0, 4.0}});
  const std::vector<double> command = {1.0, -0.5};
  passed.add(0.0, command);
  const StoppingTube tube = passed.tube(9.98, 10.0, command, command);
  const double time = 0.02 + 0.1 + 0.2, braking[] = {1.0 / 4.0, 0.25 / 8.0};
  EXPECT_NEAR(tube.to[0] - tube.from[0], time, 1e-9);
  EXPECT_NEAR(tube.to[1] - tube.from[1], -0.5 * time, 1e-9);
  for (int j = 0; j < 2; ++j) EXPECT_NEAR(tube.deviation[j], 0.5 * braking[j], 1e-6);
  EXPECT_NEAR(tube.seconds, time + 0.5, 1e-9);
}

TEST(StoppingTube, OfAnotherDirectionRemembersWhatIsInFlightAndForgetsItLater) {
  PassedCommands passed({0.1, 0.2, {2.0, 2.0}});
  passed.add(0.0, {1.0, 0.0});
  const std::vector<double> next = {0.0, 1.0};
  const StoppingTube at_once = passed.tube(1.0, 1.0, next, next);
  EXPECT_GE(at_once.from[0] + at_once.deviation[0], 0.1 + 0.25);
  passed.add(1.0, next);
  const StoppingTube later = passed.tube(3.0, 3.0, next, next);
  EXPECT_NEAR(later.from[0] + later.deviation[0], 0.0, 1e-6);
}

void expectTube(const StoppingTube& tube, const StoppingTube& expected) {
  for (std::size_t j = 0; j < expected.from.size(); ++j) {
    EXPECT_NEAR(tube.from[j], expected.from[j], 1e-8) << j;
    EXPECT_NEAR(tube.to[j], expected.to[j], 1e-8) << j;
    EXPECT_NEAR(tube.deviation[j], expected.deviation[j], 1e-8) << j;
  }
  EXPECT_NEAR(tube.seconds, expected.seconds, 1e-8);
}

// Numbers by another program that follows the comments: of little change, and of much.
TEST(StoppingTube, OfCommandsThatDifferIsNoLargerThanTheBoundsSay) {
  PassedCommands passed({0.1, 0.2, {2.0, 4.0}});
  passed.add(0.0, {1.0, 0.5});
  passed.add(0.95, {0.5, -0.5});
  expectTube(passed.tube(1.0, 1.02, {0.5, 1.0}, {0.25, 0.5}),
             {{0.0786875, -0.077}, {0.1781875, 0.122}, {0.2313125, 0.33425}, 0.82});
  PassedCommands hectic({0.1, 0.2, {0.5, 0.25}});
  hectic.add(0.0, {1.0, 0.5});
  hectic.add(0.94, {-0.75, 1.5});
  hectic.add(0.98, {1.25, -0.5});
  expectTube(hectic.tube(1.0, 1.02, {0.5, 1.0}, {0.25, 0.5}),
             {{0.524, 1.988}, {0.62, 2.18}, {1.8225, 3.2}, 6.32});
}

// Zeros came too late for it to have stopped before it is sent the same speed again.
TEST(StoppingTube, RemembersWhatAJointStillBrakesFromWhenItIsSentTheSameAgain) {
  PassedCommands passed({0.02, 0.2, {0.8}});
  passed.add(0.0, {1.5});
  passed.add(4.0, {0.0});
  passed.add(5.1, {1.5});
  const double speed = 1.5 - 0.8 * (5.08 - 4.02);
  const auto way = passed.way(0, 5.08, 5.09, 0.0, false);
  EXPECT_NEAR(way.high, 0.01 * speed, 1e-4);
  EXPECT_GE(way.high, 0.01 * (speed - 0.8 * 0.01));
  EXPECT_EQ(way.low, 0.0);
}

// What a slow joint did before it began to move counts until it has reached its command.
TEST(StoppingTube, RemembersACommandForAsLongAsAJointMayBeOnItsWayFromIt) {
  PassedCommands passed({0.1, 0.2, {10.0, 0.5}});
  const std::vector<double> next = {1.0, 1.0};
  passed.add(0.0, next);
  passed.add(1.2, {0.999, 1.0});
  const StoppingTube tube = passed.tube(1.3, 1.3, next, next);
  const double velocity = 0.5 * (1.3 - 0.1), seconds = 0.3;  // at the measurement, until zeros
  const double slow = velocity * seconds + 0.5 * 0.5 * seconds * seconds;
  EXPECT_LE(outside(tube, {0.999 * 0.1 + 0.2, slow}), ROUNDING);
}

// A fast robot brakes for longer than commands are kept.
TEST(StoppingTube, RemembersACommandForAsLongAsTheRobotMayBrakeFromIt) {
  const std::vector<double> next = {0.1};
  PassedCommands passed({0.1, 0.2, {2.0}});
  passed.add(0.0, {10.0});
  passed.add(1.0, {0.0});
  passed.add(3.4, next);
  const double speed = 10.0 - 2.0 * (3.5 - 1.1);  // at least, and that at the measurement
  const StoppingTube tube = passed.tube(3.5, 3.5, next, next);
  EXPECT_GE(tube.to[0] + tube.deviation[0], 0.5 * speed * speed / 2.0);
  EXPECT_GE(tube.seconds, speed / 2.0);
  passed.add(9.0, {0.2});
  EXPECT_LT(passed.tube(9.0, 9.0, next, next).to[0], 0.2) << "it has surely braked";
}

TEST(PassedCommands, AreAlongADirectionIfAllInEffectAreMultiplesOfIt) {
  const auto areAlong = [](const std::vector<double>& first, const std::vector<double>& second,
                           double stamp) {
    PassedCommands passed({0.1, 0.2, {2.0, 2.0}});
    passed.add(1.0, first);
    passed.add(2.0, second);
    return passed.areAlong({0.5, 2.0}, stamp);
  };
  const std::vector<double> along = {0.25, 1.0}, across = {2.0, -0.5}, back = {-0.25, -1.0};
  EXPECT_TRUE(areAlong(along, along, 2.05));
  EXPECT_TRUE(areAlong(along, {0.0, 0.0}, 2.05));
  EXPECT_FALSE(areAlong(across, along, 2.05));
  EXPECT_TRUE(areAlong(across, along, 2.15)) << "the first has no effect any more";
  EXPECT_FALSE(areAlong(along, across, 2.15));
  EXPECT_FALSE(areAlong(along, back, 2.15));
  EXPECT_FALSE(areAlong({0.25 + 1e-6, 1.0}, along, 2.05));
  EXPECT_FALSE(areAlong({0.25, 1.0 + 1e-6}, along, 2.05));
}

// Of a direction whose square is 0, or infinite, in doubles.
TEST(StoppingTube, OfADirectionOfAnyLengthHoldsWhatIsInFlight) {
  for (const double length : {1e-300, 1e-163, 1e-161, 1.0, 1e155, 1e300}) {
    PassedCommands passed({0.1, 0.0, {5.0, 5.0}});
    passed.add(1.0, {1.0, 0.0});
    EXPECT_FALSE(passed.areAlong({0.0, length}, 1.05)) << length;
    const StoppingTube tube = passed.tube(1.05, 1.05, {0.0, length}, {0.0, 0.0});
    // On for the dead time, and braking.
    EXPECT_LT(outside(tube, {0.1 + 0.5 / 5.0 - 1e-6, 0.0}), 1e-9) << length;
  }
}

}  // namespace collision_pairs::test_stopping_tube
