#include "simulated_joints.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace collision_pairs {

SimulatedRobot::SimulatedRobot(std::vector<double> positions)
    : positions_(std::move(positions)), wanted_(positions_.size(), 0.0) {}

void SimulatedRobot::command(double time, std::vector<double> velocities) {
  if (!coming_.empty()) time = std::max(time, coming_.back().time);
  coming_.push_back({time, std::move(velocities)});
}

void SimulatedRobot::step(double now, double seconds) {
  while (!coming_.empty() && coming_.front().time <= now) {
    wanted_ = coming_.front().velocities;
    coming_.pop_front();
  }
  move(wanted_, seconds);
}

SimulatedJoints::SimulatedJoints(std::vector<double> positions, std::vector<double> acceleration)
    : SimulatedRobot(std::move(positions)),
      velocities_(positions_.size(), 0.0),
      acceleration_(std::move(acceleration)) {}

bool SimulatedJoints::stand() const {
  return std::all_of(velocities_.begin(), velocities_.end(), [](double v) { return v == 0.0; });
}

void SimulatedJoints::move(const std::vector<double>& wanted, double seconds) {
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    const double change = wanted[i] - velocities_[i];
    const double changing = std::min(seconds, std::abs(change) / acceleration_[i]);
    const double after = changing < seconds
                             ? wanted[i]
                             : velocities_[i] + std::copysign(acceleration_[i] * seconds, change);
    positions_[i] += 0.5 * (velocities_[i] + after) * changing + wanted[i] * (seconds - changing);
    velocities_[i] = after;
  }
}

}  // namespace collision_pairs
