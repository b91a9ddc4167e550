// Velocity commands of type trajectory_msgs/JointTrajectory.
#pragma once

#include <string>
#include <vector>

#include <trajectory_msgs/JointTrajectory.h>

namespace collision_pairs {

/// In the order of `joints`. Throws InputError unless the command has one point with a velocity for
/// each of them, in any order, and no other.
std::vector<double> velocitiesOf(const trajectory_msgs::JointTrajectory& command,
                                 const std::vector<std::string>& joints);

/// Whether velocitiesOf() accepts the command.
bool isAccepted(const trajectory_msgs::JointTrajectory& command,
                const std::vector<std::string>& joints);

}  // namespace collision_pairs
