#include "simulated_joints.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace collision_pairs {

SimulatedJoints::SimulatedJoints(std::vector<double> positions, std::vector<double> acceleration)
    : positions_(std::move(positions)),
      velocities_(positions_.size(), 0.0),
      wanted_(positions_.size(), 0.0),
      acceleration_(std::move(acceleration)) {}

void SimulatedJoints::command(double time, std::vector<double> velocities) {
  if (!coming_.empty()) time = std::max(time, coming_.back().time);
  coming_.push_back({time, std::move(velocities)});
}

bool SimulatedJoints::stand() const {
  return std::all_of(velocities_.begin(), velocities_.end(), [](double v) { return v == 0.0; });
}

void SimulatedJoints::step(double now, double seconds) {
  while (!coming_.empty() && coming_.front().time <= now) {
    wanted_ = coming_.front().velocities;
    coming_.pop_front();
  }
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    const double change = wanted_[i] - velocities_[i];
    const double changing = std::min(seconds, std::abs(change) / acceleration_[i]);
    const double after = changing < seconds
                             ? wanted_[i]
                             : velocities_[i] + std::copysign(acceleration_[i] * seconds, change);
    positions_[i] += 0.5 * (velocities_[i] + after) * changing + wanted_[i] * (seconds - changing);
    velocities_[i] = after;
  }
}

}  // namespace collision_pairs
