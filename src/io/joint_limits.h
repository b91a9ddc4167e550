// Warnings about joint positions outside their limits.
#pragma once

#include <string>
#include <vector>

#include "collision_pairs/robot_model.h"

namespace collision_pairs {

/// A sentence for each joint that leaves its limits by more than 1e-6, what a print with six
/// decimals leaves: how often, and where first. Such states are checked like any other, but they
/// are often in degrees, or of another robot. `states`: a position for each of
/// RobotModel::joints(); `what`: the name of a state: "waypoint".
std::vector<std::string> outsideLimits(const std::vector<std::vector<double>>& states,
                                       const RobotModel& robot, const std::string& what);

}  // namespace collision_pairs
