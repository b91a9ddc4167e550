// A robot and its SRDF for the tools; errors name where the text came from.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "collision_pairs/robot_model.h"
#include "collision_pairs/srdf.h"

namespace collision_pairs {

/// `origin` is what the text came from: a file, or a topic of a bag. Warns of links that the robot
/// does not have. Throws InputError.
Srdf srdfFromText(const std::string& srdf, const std::string& origin, const RobotModel& robot);

/// Throws InputError.
std::shared_ptr<const RobotModel> readRobot(const std::string& path, const MeshLoader& load_mesh);
/// Nothing for an empty path.
std::optional<Srdf> readSrdf(const std::string& path, const RobotModel& robot);

}  // namespace collision_pairs
