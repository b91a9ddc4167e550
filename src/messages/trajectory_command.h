// Velocity commands of type trajectory_msgs/JointTrajectory.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include <trajectory_msgs/JointTrajectory.h>

namespace collision_pairs {

/// s: a trajectory controller drops a point of now or before, and goes on with the last.
constexpr double SHORTEST_TIME_FROM_START = 0.01;

/// In the order of `joints`. Throws InputError unless the command has one point with a velocity for
/// each of them, in any order, and no other, to be reached within `reaction_time`, s.
std::vector<double> velocitiesOf(const trajectory_msgs::JointTrajectory& command,
                                 const std::vector<std::string>& joints,
                                 double reaction_time = std::numeric_limits<double>::infinity());

/// Whether velocitiesOf() accepts the command.
bool isAccepted(const trajectory_msgs::JointTrajectory& command,
                const std::vector<std::string>& joints, double reaction_time);

}  // namespace collision_pairs
