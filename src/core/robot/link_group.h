// Which links a group of an SRDF moves.
#pragma once

#include <string>
#include <vector>

#include "collision_pairs/robot_model.h"
#include "collision_pairs/srdf.h"

namespace collision_pairs {

/// As MoveIt's updated links of a group: the links below the group's joints, and all below
/// them. A link of the group stands for the joint above it. Joints and links that the robot
/// lacks are passed over. By link id. Throws InputError, which names the nearest one, if there is
/// no such group, or if it moves nothing.
std::vector<int> linksMovedBy(const Srdf& srdf, const RobotModel& robot, const std::string& group);

}  // namespace collision_pairs
