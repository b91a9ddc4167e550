// What measure_stopping finds in simulated recordings.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "collision_pairs/input_error.h"
#include "random_inputs.h"
#include "recorded_servo.h"
#include "refusal.h"
#include "stopping_analysis.h"

namespace collision_pairs::test_stopping_analysis {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

StoppingRecording recordingOf(const Truth& truth, std::vector<StoppingRecording::State> states) {
  StoppingRecording recording;
  recording.joints = {"elbow"};
  recording.commands.push_back({0.0, {0.0}});
  for (std::size_t i = 0; i < truth.changes.size(); ++i) {
    recording.commands.push_back({truth.changes[i], {truth.values[i]}});
  }
  recording.states = {std::move(states)};
  return recording;
}

struct Outside {
  double at_all = -1.0, of_a_part = 0.0;
};

/// Metres or rad by which the joint goes further than the limiter assumes after a command: at the
/// former velocity for the reaction time, then slower at the deceleration. From the command on, and
/// from any position on the way.
Outside outsideOf(const Truth& truth, double hold, const StoppingAnalysis& found, double late) {
  Outside outside;
  double before = 0.0;
  for (std::size_t i = 0; i < truth.changes.size(); ++i) {
    const double to = truth.values[i], sign = before > to ? 1.0 : -1.0;
    double velocity = sign * before, assumed = 0.0, lowest = 0.0;
    // Positions are those that a stamp names.
    const auto first = static_cast<std::size_t>((truth.changes[i] - late) / DT);
    const auto count = static_cast<std::size_t>(hold / DT);
    for (std::size_t k = 0; k < count && first + k < truth.positions.size(); ++k) {
      const double way = sign * (truth.positions[first + k] - truth.positions[first]);
      lowest = std::min(lowest, way - assumed);
      outside.at_all = std::max(outside.at_all, way - assumed);
      outside.of_a_part = std::max(outside.of_a_part, way - assumed - lowest);
      assumed += velocity * DT;
      if (static_cast<double>(k) * DT > found.reaction_time) {
        velocity = std::max(sign * to, velocity - found.joints[0].deceleration * DT);
      }
    }
    before = to;
  }
  return outside;
}

std::string printed(const Servo& servo, const Recorder& recorder) {
  return "dead time " + std::to_string(servo.dead_time) + " slope " + std::to_string(servo.slope) +
         " lag " + std::to_string(servo.lag) + " frequency " + std::to_string(servo.frequency) +
         " rate " + std::to_string(recorder.rate) + " late " +
         std::to_string(recorder.stamped_late) + " noise " + std::to_string(recorder.noise);
}

Recorder randomRecorder(RandomInputs& random) {
  Recorder recorder;
  recorder.rate = std::exp(random.uniform(std::log(50.0), std::log(500.0)));
  recorder.delay = random.uniform(0.005, 0.02);
  if (random.integer(0, 1) == 1) recorder.stamped_late = random.uniform(0.005, 0.02);
  return recorder;
}

/// The ramp has 12 joint states at least: of fewer, with this noise, nobody can tell the slope to
/// 15 %, and the analysis says so.
double velocityThatTells(RandomInputs& random, const Servo& servo, const Recorder& recorder) {
  const double ramp = std::max(12.0 / recorder.rate, random.uniform(0.1, 0.3));
  return std::max(0.3, servo.slope * ramp);
}

struct Case {
  Servo servo;
  Recorder recorder;
  double velocity = 1.0, hold = 1.0;
};

/// Drives, records and analyses; says how far the truth leaves what was found.
StoppingAnalysis analysisOf(RandomInputs& random, const Case& its, Truth& truth, Outside& outside) {
  const auto steps = stepsAt({its.velocity, 0.5 * its.velocity, its.velocity});
  const double begin = 1.0 + random.uniform(0.0, 0.1);
  const double end = begin + its.hold * static_cast<double>(steps.size());
  truth = drive(random, its.servo, steps, begin, its.hold, end);
  std::vector<StoppingRecording::State> states;
  record(random, truth, its.recorder, states);
  const auto found = analyseStopping(recordingOf(truth, std::move(states)));
  outside = outsideOf(truth, its.hold, found, its.recorder.stamped_late);
  truth.dead_time += its.recorder.stamped_late;
  return found;
}

TEST(StoppingAnalysis, DeadTimeAndSlopeOfRampsAreFoundOnTheSafeSide) {
  RandomInputs random;
  for (int i = 0; i < 30; ++i) {
    Case its;
    its.servo.dead_time = random.uniform(0.008, 0.15);
    its.servo.least_dead_time = its.servo.dead_time * random.uniform(0.7, 1.0);
    its.servo.slope = std::exp(random.uniform(std::log(1.0), std::log(10.0)));
    its.recorder = randomRecorder(random);
    its.velocity = velocityThatTells(random, its.servo, its.recorder);
    SCOPED_TRACE(printed(its.servo, its.recorder));
    Truth truth;
    Outside outside;
    const auto found = analysisOf(random, its, truth, outside);
    EXPECT_GE(found.reaction_time, truth.dead_time);
    EXPECT_LE(found.reaction_time, 1.15 * truth.dead_time + 1.0 / its.recorder.rate + 0.02);
    EXPECT_LE(found.joints[0].deceleration, its.servo.slope);
    EXPECT_GE(found.joints[0].deceleration, 0.85 * its.servo.slope);
    EXPECT_LE(outside.at_all, 1e-6);
    EXPECT_THAT(found.warnings, IsEmpty());
  }
}

Servo randomServo(RandomInputs& random) {
  Servo servo;
  servo.dead_time = random.uniform(0.008, 0.1);
  servo.least_dead_time = servo.dead_time * random.uniform(0.7, 1.0);
  servo.slope = std::exp(random.uniform(std::log(2.0), std::log(20.0)));
  if (random.integer(0, 1) == 1) {
    servo.lag = random.uniform(0.01, 0.06);
  } else {
    servo.frequency = random.uniform(15.0, 60.0);
    servo.damping = random.uniform(0.5, 1.0);
  }
  return servo;
}

TEST(StoppingAnalysis, EveryStopOfALaggingOrOvershootingJointIsCovered) {
  RandomInputs random;
  for (int i = 0; i < 30; ++i) {
    Case its;
    its.servo = randomServo(random);
    its.recorder = randomRecorder(random);
    its.velocity = std::min(random.uniform(0.3, 1.5), 0.3 * its.servo.slope);
    its.hold = 1.8;  // until it is at rest to 1e-6
    SCOPED_TRACE(printed(its.servo, its.recorder));
    Truth truth;
    Outside outside;
    const auto found = analysisOf(random, its, truth, outside);
    EXPECT_GE(found.reaction_time, truth.dead_time);
    EXPECT_LE(outside.at_all, 1e-6);
  }
}

TEST(StoppingAnalysis, NoPartOfAStopIsMoreThanAMillimetreOutsideWhereThereIsNoNoise) {
  RandomInputs random;
  for (int i = 0; i < 12; ++i) {
    Case its;
    its.servo = randomServo(random);
    its.recorder = randomRecorder(random);
    its.recorder.noise = 1e-6;
    its.recorder.rate = 500.0;
    its.velocity = std::min(random.uniform(0.3, 1.5), 0.3 * its.servo.slope);
    its.hold = 1.8;
    SCOPED_TRACE(printed(its.servo, its.recorder));
    Truth truth;
    Outside outside;
    analysisOf(random, its, truth, outside);
    EXPECT_LE(outside.of_a_part, 1.2e-3);  // means over 20 ms are compared with 1e-3
  }
}

TEST(StoppingAnalysis, ASlowTailIsCoveredAsAWholeAndInItsParts) {
  RandomInputs random;
  for (int i = 0; i < 10; ++i) {
    Case its;
    its.servo.creep = random.uniform(0.1, 0.4);
    its.servo.slope = random.uniform(5.0, 20.0);
    its.servo.dead_time = its.servo.least_dead_time = random.uniform(0.01, 0.05);
    its.recorder = {500.0, 1e-6};
    its.velocity = std::exp(random.uniform(std::log(0.03), std::log(1.0)));
    its.hold = 2.0;
    SCOPED_TRACE(its.servo.creep);
    Truth truth;
    Outside outside;
    analysisOf(random, its, truth, outside);
    EXPECT_LE(outside.at_all, 1e-6);
    EXPECT_LE(outside.of_a_part, 1.2e-3);  // means over 20 ms are compared with 1e-3
  }
}

TEST(StoppingAnalysis, WhatNoDecelerationCoversDoesNotLowerItAndIsSaid) {
  RandomInputs random;
  for (const double push :
       {0.0, 0.004}) {  // rad, 0.4 s after each command, when all ramps are over
    Truth truth = drive(random, {}, stepsAt({0.5, 0.25, 0.5}), 1.0, 1.0, 22.0);
    for (std::size_t k = 0; k < truth.positions.size(); ++k) {
      const double since = std::fmod(DT * static_cast<double>(k), 1.0) - 0.4;
      if (k >= 1.0 / DT)
        truth.positions[k] += push * std::exp(-since * since / (2 * 0.015 * 0.015));
    }
    std::vector<StoppingRecording::State> states;
    record(random, truth, {500.0, 1e-5}, states);
    const auto found = analyseStopping(recordingOf(truth, std::move(states)));
    EXPECT_GE(found.joints[0].deceleration, 0.85 * Servo().slope) << push;
    const auto said = Contains(HasSubstr("whatever the deceleration: add that to stop_distance"));
    if (push > 0.0) {
      EXPECT_THAT(found.warnings, said);
    } else {
      EXPECT_THAT(found.warnings, IsEmpty());
    }
  }
}

TEST(StoppingAnalysis, ADecelerationThatIsMuchLowerThanTheSlopeIsSaid) {
  RandomInputs random;
  Case its;
  its.servo.creep = 0.3;
  its.servo.slope = 20.0;
  its.recorder = {500.0, 1e-6};
  its.velocity = 1.0;
  its.hold = 2.0;
  Truth truth;
  Outside outside;
  const auto found = analysisOf(random, its, truth, outside);
  EXPECT_LT(found.joints[0].deceleration, 10.0);
  EXPECT_THAT(found.warnings,
              Contains(HasSubstr("but its steps are covered only by a deceleration of")));
}

/// Pushed on by another joint, so far, and back, whenever both change: always, or in the second
/// half.
StoppingRecording recordingWithPushes(RandomInputs& random, double push, bool is_ever_alone) {
  const auto steps = stepsAt({1.0, 0.5, 1.0, 1.0, 0.5, 1.0});
  const std::size_t first = is_ever_alone ? steps.size() / 2 : 0;
  Truth truth = drive(random, {}, steps, 1.0, 1.0, 1.0 + static_cast<double>(steps.size()));
  for (std::size_t k = 0; k < truth.positions.size(); ++k) {
    const double since = DT * static_cast<double>(k) - 1.0;
    if (since < static_cast<double>(first)) continue;
    const auto i = std::min(static_cast<std::size_t>(since), steps.size() - 1);
    const double way = (i > 0 ? steps[i - 1] : 0.0) > steps[i] ? push : -push;
    truth.positions[k] += way * std::exp(-std::pow((std::fmod(since, 1.0) - 0.35) / 0.04, 2.0));
  }
  std::vector<StoppingRecording::State> states;
  record(random, truth, {200.0, 5e-4}, states);
  StoppingRecording recording = recordingOf(truth, states);
  recording.joints.emplace_back("wrist");
  recording.states.push_back(states);
  for (std::size_t i = 0; i < recording.commands.size(); ++i)
    recording.commands[i].velocities.push_back(i > first ? steps[i - 1] : 0.0);
  return recording;
}

TEST(StoppingAnalysis, HowFarOtherJointsPushOneIsSaidAndDoesNotLowerItsDeceleration) {
  RandomInputs random;
  for (const double push : {0.002, 0.006}) {
    const auto found = analyseStopping(recordingWithPushes(random, push, true));
    EXPECT_GE(found.joints[0].deceleration, 0.85 * Servo().slope) << push;
    EXPECT_LE(found.joints[0].deceleration, Servo().slope) << push;
    EXPECT_GE(found.joints[0].pushed, 0.8 * push);
    EXPECT_THAT(found.warnings,
                Contains(HasSubstr("joint 'elbow': where other joints change too")));
  }
  const auto never_alone = analyseStopping(recordingWithPushes(random, 0.006, false));
  EXPECT_LE(never_alone.joints[0].deceleration, 0.7 * Servo().slope);
}

TEST(StoppingAnalysis, AJointThatIsReportedWithinATurnIsTheSame) {
  RandomInputs random;
  const Truth truth = drive(random, Servo(), stepsAt({1.0, 0.5, 1.0}), 1.0, 2.5, 53.0);
  std::vector<StoppingRecording::State> states;
  record(random, truth, Recorder(), states);
  const auto expected = analyseStopping(recordingOf(truth, states));
  for (const double shift : {3.0, M_PI, -1.0}) {
    std::vector<StoppingRecording::State> wrapped = states;
    for (auto& state : wrapped) state.position = std::remainder(state.position + shift, 2.0 * M_PI);
    const auto found = analyseStopping(recordingOf(truth, std::move(wrapped)));
    EXPECT_NEAR(found.reaction_time, expected.reaction_time, 1e-9) << shift;
    EXPECT_NEAR(found.joints[0].deceleration, expected.joints[0].deceleration, 1e-6) << shift;
    EXPECT_EQ(found.warnings.size(), expected.warnings.size()) << shift;
  }
}

TEST(StoppingAnalysis, OfTwoDirectionsTheSlowerCounts) {
  RandomInputs random;
  Case its;
  its.recorder.noise = 1e-5;
  its.servo.slope_up = 2.0;
  its.velocity = 0.6;
  Truth truth;
  Outside outside;
  const auto found = analysisOf(random, its, truth, outside);
  EXPECT_LE(found.joints[0].deceleration, 2.0);
  EXPECT_GE(found.joints[0].deceleration, 1.7);
  EXPECT_LE(outside.at_all, 1e-6);
}

TEST(StoppingAnalysis, AJointThatHasNotSettledWhenTheNextCommandComesIsNoStep) {
  RandomInputs random;
  Case its;
  its.servo.slope = 1.6;  // 0.63 s for a step by 1: more than half of what it is held
  Truth truth;
  Outside outside;
  const auto found = analysisOf(random, its, truth, outside);
  EXPECT_GE(found.joints[0].joint.nb_other, 3u);
  for (const StoppingStep& step : found.joints[0].joint.steps) EXPECT_LE(step.change(), 0.6);
}

/// Held for 1 s, it has not come to rest then: only the other direction can be measured.
TEST(StoppingAnalysis, ADirectionThatIsTooSlowToBeMeasuredIsRefused) {
  RandomInputs random;
  Case its;
  its.recorder.noise = 1e-5;
  its.velocity = 0.5;
  its.servo.slope_up = 0.3;
  Truth truth;
  Outside outside;
  EXPECT_THAT(refusal([&] { analysisOf(random, its, truth, outside); }),
              AllOf(HasSubstr("joint 'elbow': when its command changes from "),
                    HasSubstr("hold each velocity until the joint follows it")));
  its.hold = 4.0;
  EXPECT_LE(analysisOf(random, its, truth, outside).joints[0].deceleration, 0.3);
}

/// As where joints are named in another order than the commands have them.
TEST(StoppingAnalysis, AJointThatStandsStillIsSaidTo) {
  RandomInputs random;
  Case its;
  Truth truth;
  Outside outside;
  its.servo.slope = 0.0;
  EXPECT_THAT(refusal([&] { analysisOf(random, its, truth, outside); }),
              AllOf(HasSubstr("joint 'elbow' stood still"), HasSubstr("order of --joints")));
}

/// … and so where joint states are missing in each slow stop.
TEST(StoppingAnalysis, AChangeWithoutJointStatesIsNotLeftOut) {
  RandomInputs random;
  Case its;
  its.recorder.noise = 1e-5;
  its.servo.slope_up = 0.6;
  const std::vector<double> steps = stepsAt({0.4, 0.2, 0.4});
  const Truth truth = drive(random, its.servo, steps, 1.0, 2.0, 1.0 + 2.0 * double(steps.size()));
  std::vector<StoppingRecording::State> states, kept;
  record(random, truth, its.recorder, states);
  double before = 0.0;
  std::vector<double> gaps;
  for (std::size_t i = 0; i < truth.changes.size(); ++i) {
    if (truth.values[i] > before) gaps.push_back(truth.changes[i] + 0.3);
    before = truth.values[i];
  }
  for (const auto& state : states) {
    const bool is_in_gap = std::any_of(gaps.begin(), gaps.end(), [&](double begin) {
      return state.stamp > begin && state.stamp < begin + 0.05;
    });
    if (!is_in_gap) kept.push_back(state);
  }
  EXPECT_THAT(refusal([&] { analyseStopping(recordingOf(truth, kept)); }),
              HasSubstr("while joint states are recorded"));
  EXPECT_LE(analyseStopping(recordingOf(truth, states)).joints[0].deceleration, 0.6);
}

TEST(StoppingAnalysis, OvershootAndSlopesThatCannotBeToldAreSaid) {
  RandomInputs random;
  Case its;
  its.recorder.noise = 1e-5;
  Truth truth;
  Outside outside;
  EXPECT_THAT(analysisOf(random, its, truth, outside).warnings, IsEmpty());
  its.servo.frequency = 20.0;
  its.servo.damping = 0.4;
  its.hold = 1.8;
  EXPECT_THAT(analysisOf(random, its, truth, outside).warnings,
              Contains(HasSubstr("joint 'elbow': it overshoots by ")));
  its.servo.frequency = 0.0;
  its.servo.slope = 50.0;
  its.recorder.rate = 50.0;
  its.recorder.noise = 1e-3;
  its.velocity = 0.1;
  const auto found = analysisOf(random, its, truth, outside);
  EXPECT_THAT(found.warnings, Contains(HasSubstr("joint 'elbow': its slope is between")));
  EXPECT_LE(found.joints[0].deceleration, 50.0);
  EXPECT_LE(outside.at_all, 1e-6);
}

}  // namespace collision_pairs::test_stopping_analysis
