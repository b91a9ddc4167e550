// A robot with mass that follows velocity commands, in MuJoCo.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <mujoco/mujoco.h>

#include "collision_pairs/scene_description.h"
#include "random_inputs.h"
#include "simulated_joints.h"

namespace collision_pairs {

/// Names of servos, in tables.
enum class Servo {
  RAMP,  ///< the set-point's velocity approaches the command at a rate; tracked stiffly
  PI,    ///< on the velocity's error; its torque saturates, and it overshoots a little
};
const char* servoName(Servo servo);

/// What is wrong with a robot.
struct RobotFault {
  bool exchanges_joints = false;  ///< the second and the third: each moves as the other is told
  double sags = 0.0;              ///< share of gravity that is not held at zero command
  /// Torque on each joint from push_from, s, on: in shares of what the motors have.
  std::vector<double> push;
  double push_from = 0.0;
};

/// Made from the collision geometry: links are the boxes around their elements, of one density, and
/// none is lighter than a floor. Motors have half as much torque again as gravity and ramps need.
/// Joints that are not named are rigid at zero. MuJoCo's own contacts are off. Immutable.
class RobotWithMass {
 public:
  RobotWithMass(const RobotModel& robot, const std::vector<std::string>& joints,
                const std::vector<RigidObject>& attached);

  /// Of the joints named, by index. Inertias are those of random postures.
  struct Motor {
    int address;         ///< in MuJoCo's vectors
    double ramp;         ///< rad/s^2, of Servo::RAMP
    double inertia;      ///< kg m^2: the mean
    double most_torque;  ///< Nm
  };
  const std::vector<Motor>& motors() const { return motors_; }
  /// For each joint, of many random postures within 2 rad the one in which it moves most.
  const std::vector<std::vector<double>>& heaviest() const { return heaviest_; }
  const mjModel* model() const { return model_.get(); }

 private:
  void findMotors(const std::vector<std::string>& joints);
  std::unique_ptr<mjModel, void (*)(mjModel*)> model_;
  std::vector<Motor> motors_;
  std::vector<std::vector<double>> heaviest_;
};

class MujocoRobot : public SimulatedRobot {
 public:
  /// At rest.
  MujocoRobot(std::shared_ptr<const RobotWithMass> robot, Servo servo,
              std::vector<double> positions, const RobotFault& fault = {});

 private:
  void move(const std::vector<double>& wanted, double seconds) override;
  double ramped(std::size_t joint, double wanted, double seconds);
  double proportional(std::size_t joint, double wanted, double seconds);

  std::shared_ptr<const RobotWithMass> robot_;
  Servo servo_;
  RobotFault fault_;
  double time_ = 0.0;
  std::unique_ptr<mjData, void (*)(mjData*)> data_;
  std::vector<double> set_velocities_, set_positions_, integrals_;
};

}  // namespace collision_pairs
