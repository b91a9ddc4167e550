// Ways of LimiterScene that are driven without random commands.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "limiter_simulation.h"

namespace collision_pairs {
namespace {

constexpr double STEP = 0.001;  // s of the robot

}  // namespace

double LimiterScene::secondsTo(const std::vector<double>& from, const std::vector<double>& to,
                               const Limiter& limiter) {
  constexpr double PERIOD = 0.008, DEAD_TIME = 0.05, LONGEST = 60.0, THERE = 0.02, GAIN = 4.0;
  SimulatedJoints robot(from, std::vector<double>(from.size(), options_.deceleration));
  LimiterView view{0.0, 0.0, 0.0, {}, {}};
  for (long i = 0; static_cast<double>(i) * STEP < LONGEST; ++i) {
    const double now = static_cast<double>(i) * STEP;
    double left = 0.0;
    for (std::size_t j = 0; j < to.size(); ++j) {
      left = std::max(left, std::abs(to[j] - robot.positions()[j]));
    }
    if (left < THERE) return now;
    if (i % std::lround(PERIOD / STEP) == 0) {
      view.command.clear();
      const double speed = std::min(options_.max_speed, GAIN * left);
      for (std::size_t j = 0; j < to.size(); ++j) {
        view.command.push_back(speed * (to[j] - robot.positions()[j]) / left);
      }
      view.now = view.stamp = now;
      view.state.positions = allPositions(robot.positions());
      robot.command(now + DEAD_TIME, limiter(view)->command);
    }
    robot.step(now, STEP);
  }
  return std::numeric_limits<double>::infinity();
}

bool LimiterScene::driveToAStop(RandomInputs& random, const Limiter& limiter,
                                std::vector<double>& stop) {
  constexpr double PERIOD = 0.01, LONGEST = 10.0, STANDS_FOR = 0.5;
  const std::vector<double> from = freeState(random, 0.0135);
  if (from.empty()) return false;
  SimulatedJoints robot(from, std::vector<double>(joints_.size(), options_.deceleration));
  LimiterView view{0.0, 0.0, 0.0, {}, {}};
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    view.command.push_back(random.uniform(-1.0, 1.0) * options_.max_speed);
  }
  double passed_at = 0.0;
  for (double now = 0.0; now < LONGEST; now += PERIOD) {
    view.now = view.stamp = now;
    view.state.positions = allPositions(robot.positions());
    std::vector<double> passed = limiter(view)->command;
    const auto moves = [](double x) { return x != 0.0; };
    if (std::any_of(passed.begin(), passed.end(), moves)) passed_at = now;
    robot.command(now + options_.reaction_time - PERIOD, std::move(passed));
    for (double t = 0.0; t < PERIOD; t += STEP) robot.step(now + t, STEP);
    stop = robot.positions();
    if (now - passed_at > STANDS_FOR) return true;
  }
  return false;
}

}  // namespace collision_pairs
