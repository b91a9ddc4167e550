// Velocities of commands of type trajectory_msgs/JointTrajectory.
#pragma once

#include <string>
#include <vector>

#include <trajectory_msgs/JointTrajectory.h>

#include "joint_positions.h"
#include "limiter_law.h"

namespace collision_pairs {

/// In the order of `joints`. Throws InputError unless the command has one point with a velocity for
/// each of them, in any order, and no other.
std::vector<double> velocitiesOf(const trajectory_msgs::JointTrajectory& command,
                                 const std::vector<std::string>& joints);

/// The command with the velocities that the decision passes, in the command's order. Positions, if
/// it has some, are on the way from the measured ones to the given ones, by the scale. Of a command
/// that velocitiesOf() refuses: zeros.
trajectory_msgs::JointTrajectory limitedTrajectory(const trajectory_msgs::JointTrajectory& command,
                                                   const std::vector<std::string>& joints,
                                                   const LimiterDecision& decision,
                                                   const JointPositions& measured);

}  // namespace collision_pairs
