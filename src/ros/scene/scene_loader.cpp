#include "scene_loader.h"

#include <algorithm>
#include <cctype>
#include <functional>

#include <ros/master.h>
#include <ros/names.h>

#include "collision_pairs/input_error.h"
#include "collision_pairs/mesh_loader.h"
#include "parameters.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

const std::string ENVIRONMENT = "environment_description";

using Descriptions = std::map<std::string, std::size_t>;

/// Writes the resolved name of the parameter to `key`, and notes the hash of what it finds; false
/// if it does not exist. An empty value counts as missing: a launch file cannot set a parameter
/// only if a command prints something.
bool findText(const ros::NodeHandle& node, const std::string& name, std::string& key,
              std::string& text, Descriptions& found) {
  XmlRpc::XmlRpcValue value;
  key = findParameter(node, name);
  if (!key.empty() && readParameter(node, key, value)) {
    if (value.getType() != XmlRpc::XmlRpcValue::TypeString) {
      throw InputError("parameter " + key +
                       " is not text; load an XML file into it with textfile=");
    }
    text = static_cast<std::string&>(value);
  }
  found[name] = std::hash<std::string>()(text);
  return !text.empty();
}

TextFrom textOf(const std::string& key, const std::string& text) {
  return {"parameter " + key, text};
}

/// `urdf`: the resolved name of the parameter that has it.
void loadSrdf(const ros::NodeHandle& node, const RobotParameters& parameters,
              const std::string& urdf, Descriptions& found, const Warn& warn, const Warn& log,
              SceneSources::Robot& robot) {
  const std::string& name = parameters.semantic;
  std::string key, xml;
  if (name.empty()) return;
  if (!findText(node, name, key, xml, found)) {
    if (!parameters.needs_semantic) return;
    throw InputError("there is no parameter " + name + ", or it is empty; " +
                     node.resolveName("robots") + " names it as the SRDF (semantic) of " +
                     parameters.description);
  }
  if (!parameters.needs_semantic && isOutsideNamespaceOf(urdf, key)) {
    return warn("parameter " + key + " is not used: it may be of another robot than " + urdf +
                "; put it beside that, or name both in " + node.resolveName("robots"));
  }
  robot.readSrdf(textOf(key, xml), warn);
  for (const std::string& link :
       robot.srdf->unknownLinks(namesOf(robot.source->skeleton()->links()))) {
    log("parameter " + key + ": '" + link + "' is not a link of the robot");
  }
}

SceneSources::Robot loadRobot(const ros::NodeHandle& node, const RobotParameters& parameters,
                              const MeshLoader& load_mesh, Descriptions& found, const Warn& warn,
                              const Warn& log) {
  std::string key, xml;
  if (!findText(node, parameters.description, key, xml, found)) {
    throw InputError("there is no parameter " + parameters.description +
                     "; load the robot's URDF into it, for example with <param name=\"" +
                     parameters.description + "\" textfile=\"robot.urdf\"/>");
  }
  SceneSources::Robot robot;
  robot.source = robotSource(textOf(key, xml), load_mesh, warn);
  loadSrdf(node, parameters, key, found, warn, log, robot);
  robot.prefix = parameters.prefix;
  return robot;
}

/// A parameter of the scene below `value`, at any depth; empty: none.
std::string settingWithin(XmlRpc::XmlRpcValue& value) {
  if (value.getType() != XmlRpc::XmlRpcValue::TypeStruct) return "";
  const auto& of_scene = sceneConfigKeys();
  for (auto& [name, below] : value) {
    if (name == "robots" || std::count(of_scene.begin(), of_scene.end(), name) > 0) return name;
    const std::string found = settingWithin(below);
    if (!found.empty()) return name + "/" + found;
  }
  return "";
}

/// Refuses a misspelt rule about pairs, which would otherwise silently not apply, and settings of a
/// file that has the node's name on top. Warns of each other parameter that is none.
void refuseMisspelt(const ros::NodeHandle& node, const std::vector<RobotParameters>& robots,
                    const Warn& warn) {
  XmlRpc::XmlRpcValue given;
  const bool is_any = readParameter(node, node.getNamespace(), given);
  if (!is_any || given.getType() != XmlRpc::XmlRpcValue::TypeStruct) return;
  std::vector<std::string> known = nodeParameterKeys();
  known.push_back(ENVIRONMENT);
  for (const RobotParameters& robot : robots) {
    known.push_back(robot.description);
    known.push_back(robot.semantic);
  }
  const auto& of_scene = sceneConfigKeys();
  for (auto& [name, value] : given) {
    if (std::count(known.begin(), known.end(), name) > 0) continue;
    const std::string within = settingWithin(value);
    if (!within.empty()) {
      throw InputError("parameter " + node.resolveName(name) + "/" + within +
                       " is not read: load a file of parameters without '" + name +
                       "' on top, or in the namespace above");
    }
    std::string lower = name;
    std::transform(lower.begin(), lower.end(), lower.begin(), ::tolower);
    const std::string nearest = nearestName(lower, known, 1 + name.size() / 6);
    const std::string what =
        "parameter " + node.resolveName(name) + " is not a parameter of this node" +
        (nearest.empty() ? std::string() : "; did you mean '" + nearest + "'?");
    const bool may_leave_out = nearest == "robots" || nearest == ENVIRONMENT ||
                               std::count(of_scene.begin(), of_scene.end(), nearest) > 0;
    if (may_leave_out) throw InputError(what);
    warn(what);
  }
}

}  // namespace

SceneParameters readSceneParameters(const ros::NodeHandle& node,
                                    const ros::NodeHandle& private_node, const PoseLimits& limits,
                                    const Warn& log) {
  SceneParameters all;
  const Warn warn = [&](const std::string& what) {  // also in the diagnostics
    all.warnings.push_back(what);
    log(what);
  };
  all.fixed_frame = readFixedFrame(private_node);
  SceneSources& sources = all.sources;
  const MeshLoader load_mesh = makeMeshLoader(log);
  const std::vector<RobotParameters> robots = readRobots(private_node);
  for (const RobotParameters& robot : robots) {
    sources.robots.push_back(
        loadRobot(private_node, robot, load_mesh, all.descriptions, warn, log));
  }
  refuseMisspelt(private_node, robots, warn);
  std::string key, xml;
  if (findText(private_node, ENVIRONMENT, key, xml, all.descriptions)) {
    sources.world = robotSource(textOf(key, xml), load_mesh, warn);
  }
  // As others will read it, so that they and this node have the same settings.
  sources.readSettings(
      textOf(private_node.getNamespace(),
             settingsText(yamlParameters(private_node, sceneConfigKeys()), limits)));
  for (const CloudConfig& cloud : sources.config.clouds) {
    std::string why;
    if (!ros::names::validate(cloud.topic, why)) {
      throw InputError("clouds: '" + cloud.topic + "' is not a valid topic name: " + why);
    }
    all.cloud_topics.push_back(node.resolveName(cloud.topic));
  }
  requireConfigured(private_node);  // at the end: meanwhile, too, none has gone
  return all;
}

std::vector<std::string> changedDescriptions(const ros::NodeHandle& private_node,
                                             const Descriptions& read) {
  if (!ros::master::check()) return {};  // that is no reason to believe that they were deleted
  std::vector<std::string> changed;
  Descriptions found;
  for (const auto& [name, hash] : read) {
    std::string key, text;
    findText(private_node, name, key, text, found);
    if (found[name] != hash) changed.push_back(key.empty() ? name : key);
  }
  return changed;
}

}  // namespace collision_pairs
