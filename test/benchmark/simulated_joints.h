// Joints that follow velocity commands.
#pragma once

#include <deque>
#include <vector>

namespace collision_pairs {

/// Joints that follow commands after a dead time, with a limited acceleration; exact within a step.
class SimulatedJoints {
 public:
  SimulatedJoints(std::vector<double> positions, std::vector<double> acceleration);

  /// In effect from `time` on, and not before those of earlier calls.
  void command(double time, std::vector<double> velocities);
  void step(double now, double seconds);

  const std::vector<double>& positions() const { return positions_; }
  bool stand() const;

 private:
  struct Coming {
    double time;
    std::vector<double> velocities;
  };
  std::vector<double> positions_, velocities_, wanted_, acceleration_;
  std::deque<Coming> coming_;
};

}  // namespace collision_pairs
