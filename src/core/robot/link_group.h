// Which links a group of an SRDF moves.
#pragma once

#include <string>
#include <vector>

#include "collision_pairs/robot_model.h"
#include "collision_pairs/srdf.h"

namespace collision_pairs {

/// As MoveIt's updated links of a group: the links below the group's joints and below joints that
/// mimic these, and all below them. A link in the group means its parent joint. Indexed by link id.
/// Throws InputError if there is no such group, if there are two, if it moves nothing, or if it, or
/// a subgroup, names what the robot does not have.
std::vector<int> linksMovedBy(const Srdf& srdf, const RobotModel& robot, const std::string& group);

}  // namespace collision_pairs
