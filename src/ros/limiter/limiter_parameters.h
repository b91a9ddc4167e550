// The parameter ~velocity_limiter.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "limiter_law.h"

namespace collision_pairs {

struct LimiterParameters {
  std::string command;         ///< topic
  bool is_trajectory = false;  ///< trajectory_msgs/JointTrajectory; else std_msgs/Float64MultiArray
  /// Of the command, in the order of the array; as joint states and the URDF name them, without
  /// leading slashes.
  std::vector<std::string> joints;
  std::string joint_states = "joint_states";  ///< topic
  LimiterSettings law;                        ///< deceleration: one per joint

  /// Nothing if `value` is not there, null or an empty map. Throws InputError that names the key,
  /// with the closest one if it is misspelt.
  static std::optional<LimiterParameters> read(const YAML::Node& value);
};

}  // namespace collision_pairs
