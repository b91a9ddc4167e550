// Which links a group of an SRDF moves.
#pragma once

#include <string>
#include <vector>

#include "collision_pairs/robot_model.h"
#include "collision_pairs/srdf.h"

namespace collision_pairs {

/// As MoveIt's updated links of a group: the links below the group's joints and below joints that
/// mimic these, and all below them. A link in the group means its parent joint. Joints and links
/// that the robot does not have are ignored. Indexed by link id. Throws InputError if there is no
/// such group (suggesting the closest name), if there are two, or if it moves nothing.
std::vector<int> linksMovedBy(const Srdf& srdf, const RobotModel& robot, const std::string& group);

}  // namespace collision_pairs
