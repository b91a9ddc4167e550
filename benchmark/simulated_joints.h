// Robots that follow velocity commands after a dead time.
#pragma once

#include <deque>
#include <vector>

namespace collision_pairs {

/// Commands wait here for their dead time; how the joints then move is the derived class's.
class SimulatedRobot {
 public:
  explicit SimulatedRobot(std::vector<double> positions);
  virtual ~SimulatedRobot() = default;

  /// In effect from `time` on, and not before those of earlier calls.
  void command(double time, std::vector<double> velocities);
  void step(double now, double seconds);

  const std::vector<double>& positions() const { return positions_; }

 protected:
  /// Moves positions_ on, towards the velocities that are commanded.
  virtual void move(const std::vector<double>& wanted, double seconds) = 0;
  std::vector<double> positions_;

 private:
  struct Coming {
    double time;
    std::vector<double> velocities;
  };
  std::vector<double> wanted_;
  std::deque<Coming> coming_;
};

/// Joints without mass: a limited acceleration, exact within a step.
class SimulatedJoints : public SimulatedRobot {
 public:
  SimulatedJoints(std::vector<double> positions, std::vector<double> acceleration);
  bool stand() const;

 private:
  void move(const std::vector<double>& wanted, double seconds) override;
  std::vector<double> velocities_, acceleration_;
};

}  // namespace collision_pairs
