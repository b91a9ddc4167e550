#include "scene_loader.h"

#include <algorithm>
#include <optional>

#include <ros/console.h>

#include "collision_pairs/input_error.h"
#include "mesh_loader.h"

namespace collision_pairs {
namespace {

/// Where the parameter was found goes to `key`; false if it is nowhere or not text.
bool findText(const ros::NodeHandle& node, const std::string& name, std::string& key,
              std::string& text) {
  return node.searchParam(name, key) && node.getParam(key, text);
}

std::optional<Srdf> loadSrdf(const ros::NodeHandle& node, const RobotModel& robot) {
  std::string key, xml;
  // Empty counts as none: a launch file cannot set a parameter only where a command finds
  // something.
  if (!findText(node, "robot_description_semantic", key, xml) || xml.empty()) return std::nullopt;
  std::vector<std::string> links;
  for (const Link& link : robot.links()) links.push_back(link.name);
  try {
    const Srdf srdf = Srdf::fromXml(xml);
    for (const std::string& link : srdf.unknownLinks(links)) {
      ROS_WARN_STREAM("parameter " << key << ": '" << link << "' is no link of the robot");
    }
    return srdf;
  } catch (const InputError& error) {
    throw InputError("parameter " + key + ": " + error.what());
  }
}

}  // namespace

LoadedScene loadScene(const ros::NodeHandle& private_node, SceneSettings settings) {
  const ros::WallTime start = ros::WallTime::now();
  std::string key, xml;
  if (!findText(private_node, "robot_description", key, xml)) {
    throw InputError(
        "there is no parameter robot_description; load the robot's URDF into it, for example with "
        "<param name=\"robot_description\" textfile=\"robot.urdf\"/>");
  }
  LoadedScene loaded;
  std::vector<BrokenElement> broken;
  std::shared_ptr<const RobotModel> robot;
  try {
    robot = RobotModel::fromUrdf(xml, makeMeshLoader(), &broken);
  } catch (const InputError& error) {
    throw InputError("parameter " + key + ": " + error.what());
  }
  for (const BrokenElement& element : broken) {
    ROS_ERROR_STREAM("link '" << element.link << "' is left out: " << element.reason);
    loaded.broken_links.push_back(element.link);
  }
  std::sort(loaded.broken_links.begin(), loaded.broken_links.end());
  loaded.broken_links.erase(std::unique(loaded.broken_links.begin(), loaded.broken_links.end()),
                            loaded.broken_links.end());
  // Nothing is said of what is ready within a second.
  settings.progress = [start](std::size_t done, std::size_t total) {
    if ((ros::WallTime::now() - start).toSec() < 1.0) return;
    ROS_INFO_STREAM_THROTTLE(1.0, "prepared " << done << " of " << total << " meshes");
  };
  loaded.scene = CollisionScene::build(robot, loadSrdf(private_node, *robot), nullptr, settings);
  ROS_INFO_STREAM("robot '" << robot->name() << "': " << loaded.scene->models().size()
                            << " links with geometry to check, " << loaded.scene->elements().size()
                            << " elements, " << loaded.scene->bodies().size()
                            << " moving bodies, ready after "
                            << (ros::WallTime::now() - start).toSec() << " s");
  return loaded;
}

}  // namespace collision_pairs
