// Warnings about joint positions outside their limits.
#pragma once

#include <string>
#include <vector>

#include "collision_pairs/robot_model.h"

namespace collision_pairs {

/// A sentence for each joint that exceeds its limits by more than 1e-6, the precision of output
/// with six decimals: how often, and where first. Such states are checked like any other, but often
/// they are in degrees, or of another robot. `states`: a position for each of RobotModel::joints();
/// `what`: the name of a state: "waypoint".
std::vector<std::string> outsideLimits(const std::vector<std::vector<double>>& states,
                                       const RobotModel& robot, const std::string& what);

}  // namespace collision_pairs
