#include "robot_files.h"

#include <vector>

#include "collision_pairs/input_error.h"
#include "text_files.h"
#include "tool_errors.h"

namespace collision_pairs {

Srdf srdfFromText(const std::string& text, const std::string& origin, const RobotModel& robot) {
  std::vector<std::string> links;
  for (const Link& link : robot.links()) links.push_back(link.name);
  try {
    const Srdf srdf = Srdf::fromXml(text);
    const auto unknown = srdf.unknownLinks(links);
    if (!unknown.empty())
      warn(origin + ": not links of the robot, passed over: " + joined(unknown));
    return srdf;
  } catch (const InputError& error) {
    throw InputError(origin + ": " + error.what());
  }
}

std::shared_ptr<const RobotModel> readRobot(const std::string& path, const MeshLoader& load_mesh) {
  const std::string urdf = readTextFile(path);
  try {
    const auto robot = RobotModel::fromUrdf(urdf, load_mesh);
    for (const std::string& warning : robot->warnings()) warn(path + ": " + warning);
    return robot;
  } catch (const InputError& error) {
    throw InputError(path + ": " + error.what());
  }
}

std::optional<Srdf> readSrdf(const std::string& path, const RobotModel& robot) {
  if (path.empty()) return std::nullopt;
  return srdfFromText(readTextFile(path), path, robot);
}

}  // namespace collision_pairs
