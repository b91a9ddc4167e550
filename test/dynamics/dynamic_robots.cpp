#include "dynamic_robots.h"

#include <utility>

#include "demo_motion.h"

namespace collision_pairs {

DynamicRobot::DynamicRobot(BenchmarkRobot of, Servo with)
    : robot(std::move(of)), joints(limitedJoints(robot)), servo(with) {
  bare = std::make_shared<RobotWithMass>(*robot.robot, joints, std::vector<RigidObject>());
  with_box = std::make_shared<RobotWithMass>(
      *robot.robot, joints, std::vector<RigidObject>{heldBox(*robot.robot, joints.back())});
}

SimulationOptions DynamicRobot::options(bool holds_box, const RobotFault& fault) const {
  SimulationOptions options;
  options.robot = [mass = holds_box ? with_box : bare, servo = servo,
                   fault](std::vector<double> positions) {
    return std::make_unique<MujocoRobot>(mass, servo, std::move(positions), fault);
  };
  options.holds_box = holds_box;
  options.dead_time = {0.008, 0.02};
  options.state_rate = {100.0, 250.0};
  options.state_late = {0.005, 0.02};
  options.state_noise = 1e-3;
  options.check_every = 0.001;
  options.press_share = 0.35;
  return options;
}

StoppingRecording DynamicRobot::steps(RandomInputs& random) const {
  return driveSteps(options(true), joints, with_box->heaviest(), random);
}

void tell(const StoppingAnalysis& found, SimulationOptions& options) {
  options.reaction_time = found.reaction_time;
  options.decelerations.clear();
  for (const JointStopping& joint : found.joints) {
    options.decelerations.push_back(joint.deceleration);
  }
}

std::vector<BenchmarkRobot> dynamicRobots() {
  std::vector<BenchmarkRobot> robots = {demoRobot()};
  for (const BenchmarkRobot& robot : benchmarkRobots()) {
    if (robot.name != "pr2") robots.push_back(robot);
  }
  return robots;
}

}  // namespace collision_pairs
