// Robots with mass in the limiter's simulation, and what their servos are measured to do.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "driven_steps.h"
#include "limiter_simulation.h"
#include "mujoco_robot.h"
#include "stopping_analysis.h"

namespace collision_pairs {

struct DynamicRobot {
  DynamicRobot(BenchmarkRobot of, Servo servo);

  BenchmarkRobot robot;
  std::vector<std::string> joints;
  Servo servo;
  std::shared_ptr<const RobotWithMass> bare, with_box;

  /// Among objects: dead times of 8 to 20 ms, joint states at 100 to 250 Hz, 5 to 20 ms late, with
  /// noise of up to 1 mrad; judged at 1 kHz.
  SimulationOptions options(bool holds_box, const RobotFault& fault = {}) const;
  /// Steps with the box, in the postures in which joints move most.
  StoppingRecording steps(RandomInputs& random) const;
};

/// reaction_time and deceleration, as they are found.
void tell(const StoppingAnalysis& found, SimulationOptions& options);

/// demo, panda and ur5, the latter where their data are.
std::vector<BenchmarkRobot> dynamicRobots();

}  // namespace collision_pairs
