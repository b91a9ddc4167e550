#include "driven_steps.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <rosbag/bag.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/Float64MultiArray.h>

namespace collision_pairs {
namespace {

constexpr double STEP = 0.001, COMMAND_PERIOD = 0.01;  // s
constexpr double VELOCITY = 1.0, HOLD = 0.6;           // rad/s, s
constexpr double START = 1000.0;                       // s: a bag has no time 0
// As drive_steps has them: they end where they begin.
constexpr double SHARES[] = {0.0, 1.0, 0.0,  -1.0, 0.0, 0.5,  0.0, -0.5,
                             0.0, 1.0, -1.0, 0.0,  0.5, -0.5, 0.0};

class Drive {
 public:
  Drive(const SimulationOptions& options, const std::vector<std::string>& joints,
        const std::vector<double>& from, RandomInputs& random)
      : options_(options), random_(random), robot_(options.robot(from)) {
    recording_.joints = joints;
    recording_.states.resize(joints.size());
    state_period_ = 1.0 / options.state_rate.draw(random);
  }

  void hold(const std::vector<double>& velocities, double seconds) {
    for (const double end = now_ + seconds; now_ < end; now_ += STEP) {
      if (now_ >= next_command_) {
        next_command_ += COMMAND_PERIOD;
        recording_.commands.push_back({START + now_, velocities});
        robot_->command(now_ + options_.dead_time.value().draw(random_), velocities);
      }
      if (now_ >= next_state_) {
        next_state_ += state_period_;
        const double arrival = now_ + options_.state_late.draw(random_);
        for (std::size_t j = 0; j < velocities.size(); ++j) {
          const double noise = random_.uniform(-1.0, 1.0) * options_.state_noise;
          recording_.states[j].push_back(
              {START + now_, START + arrival, robot_->positions()[j] + noise});
        }
      }
      robot_->step(now_, STEP);
    }
  }
  const std::vector<double>& positions() const { return robot_->positions(); }
  StoppingRecording recording() { return std::move(recording_); }

 private:
  const SimulationOptions& options_;
  RandomInputs& random_;
  std::unique_ptr<SimulatedRobot> robot_;
  StoppingRecording recording_;
  double now_ = 0.0, next_command_ = 0.0, next_state_ = 0.0, state_period_ = 0.0;
};

}  // namespace

StoppingRecording driveSteps(const SimulationOptions& options,
                             const std::vector<std::string>& joints,
                             const std::vector<std::vector<double>>& postures,
                             RandomInputs& random) {
  const std::vector<double> zeros(joints.size(), 0.0);
  Drive drive(options, joints, postures.front(), random);
  for (const std::vector<double>& posture : postures) {
    for (std::size_t j = 0; j < joints.size(); ++j) {
      std::vector<double> velocities = zeros;
      const double way = posture[j] - drive.positions()[j];
      velocities[j] = std::copysign(VELOCITY, way);
      drive.hold(velocities, std::abs(way) / VELOCITY);
      drive.hold(zeros, HOLD);
    }
    std::vector<double> all = zeros;
    for (double& x : all) x = random.integer(0, 1) ? VELOCITY : -VELOCITY;
    for (std::size_t j = 0; j <= joints.size(); ++j) {
      for (const double share : SHARES) {
        std::vector<double> velocities = zeros;
        for (std::size_t k = 0; k < joints.size(); ++k) {
          if (k == j || j == joints.size()) velocities[k] = share * all[k];
        }
        drive.hold(velocities, HOLD);
      }
    }
  }
  return drive.recording();
}

void writeBag(const StoppingRecording& recording, const std::string& path) {
  rosbag::Bag bag(path, rosbag::bagmode::Write);
  for (const StoppingRecording::Command& command : recording.commands) {
    std_msgs::Float64MultiArray message;
    message.data = command.velocities;
    bag.write("/command", ros::Time(command.arrival), message);
  }
  for (std::size_t i = 0; i < recording.states.front().size(); ++i) {
    sensor_msgs::JointState message;
    message.header.stamp.fromSec(recording.states.front()[i].stamp);
    message.name = recording.joints;
    for (const auto& of_joint : recording.states) message.position.push_back(of_joint[i].position);
    bag.write("/joint_states", ros::Time(recording.states.front()[i].arrival), message);
  }
  bag.close();
}

}  // namespace collision_pairs
