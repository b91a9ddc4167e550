#include "scene_loader.h"

#include <algorithm>
#include <set>

#include <ros/console.h>

#include "collision_pairs/collision_scene.h"
#include "collision_pairs/input_error.h"
#include "mesh_loader.h"
#include "parameters.h"
#include "yaml_parameters.h"

namespace collision_pairs {
namespace {

/// Where the parameter was found goes to `key`; false if it is nowhere or not text. Empty counts as
/// none: a launch file cannot set a parameter only where a command finds something.
bool findText(const ros::NodeHandle& node, const std::string& name, std::string& key,
              std::string& text) {
  return node.searchParam(name, key) && node.getParam(key, text) && !text.empty();
}

/// Errors of `read` name the parameter.
template <class Read>
auto fromParameter(const std::string& key, const Read& read) {
  try {
    return read();
  } catch (const InputError& error) {
    throw InputError("parameter " + key + ": " + error.what());
  }
}

std::optional<Srdf> loadSrdf(const ros::NodeHandle& node, const std::string& name,
                             const RobotModel& robot) {
  std::string key, xml;
  if (name.empty() || !findText(node, name, key, xml)) return std::nullopt;
  std::vector<std::string> links;
  for (const Link& link : robot.links()) links.push_back(link.name);
  const Srdf srdf = fromParameter(key, [&] { return Srdf::fromXml(xml); });
  for (const std::string& link : srdf.unknownLinks(links)) {
    ROS_WARN_STREAM("parameter " << key << ": '" << link << "' is no link of the robot");
  }
  return srdf;
}

SceneSources::Robot loadRobot(const ros::NodeHandle& node, const RobotParameters& parameters,
                              const MeshLoader& load_mesh) {
  std::string key, xml;
  if (!findText(node, parameters.description, key, xml)) {
    throw InputError("there is no parameter " + parameters.description +
                     "; load the robot's URDF into it, for example with <param name=\"" +
                     parameters.description + "\" textfile=\"robot.urdf\"/>");
  }
  SceneSources::Robot robot;
  robot.source = fromParameter(key, [&] { return std::make_unique<RobotSource>(xml, load_mesh); });
  robot.srdf = loadSrdf(node, parameters.semantic, *robot.source->skeleton());
  robot.prefix = parameters.prefix;
  return robot;
}

std::unique_ptr<RobotSource> loadEnvironment(const ros::NodeHandle& node,
                                             const MeshLoader& load_mesh) {
  std::string key, xml;
  if (!findText(node, "environment_description", key, xml)) return nullptr;
  return fromParameter(key, [&] { return std::make_unique<RobotSource>(xml, load_mesh); });
}

/// Loads what is needed of one source, and notes what is broken.
std::shared_ptr<const RobotModel> loadGeometry(RobotSource& source, const std::string& prefix,
                                               const std::set<std::string>& needed,
                                               std::vector<std::string>& broken_links) {
  const std::string before = prefix.empty() ? "" : prefix + "/";
  const std::size_t nb_known = source.broken().size();
  const auto model = source.withGeometryOf(
      [&](const std::string& link) { return needed.count(before + link) > 0; });
  for (std::size_t i = 0; i < source.broken().size(); ++i) {
    const BrokenElement& element = source.broken()[i];
    broken_links.push_back(before + element.link);
    if (i < nb_known) continue;
    ROS_ERROR_STREAM("link '" << broken_links.back() << "' is left out: " << element.reason);
  }
  return model;
}

}  // namespace

SceneSources readSceneSources(const ros::NodeHandle& private_node, const SceneSettings& settings) {
  SceneSources sources;
  const MeshLoader load_mesh = makeMeshLoader();
  for (const RobotParameters& robot : readRobots(private_node)) {
    sources.robots.push_back(loadRobot(private_node, robot, load_mesh));
  }
  sources.environment = loadEnvironment(private_node, load_mesh);
  YAML::Node parameters = yamlParameters(private_node, sceneConfigKeys());
  for (const char* read_elsewhere : {"link_fidelity", "max_hull_vertices"}) {
    parameters.remove(read_elsewhere);
  }
  sources.config =
      fromParameter(private_node.getNamespace(), [&] { return readSceneConfig(parameters); });
  sources.config.settings.link_fidelity = settings.link_fidelity;
  sources.config.settings.max_hull_vertices = settings.max_hull_vertices;
  return sources;
}

SceneDescription describeScene(SceneSources& sources, std::vector<RigidObject> objects,
                               const Restriction& restriction,
                               std::vector<std::string>& broken_links) {
  SceneDescription description;
  for (const SceneSources::Robot& robot : sources.robots) {
    description.robots.push_back({robot.source->skeleton(), robot.srdf, robot.prefix});
  }
  if (sources.environment) description.world = sources.environment->skeleton();
  description.objects = std::move(objects);
  if (sources.config.floor) description.objects.push_back(*sources.config.floor);
  description.restriction = restriction.empty() ? sources.config.restriction : restriction;
  description.settings = sources.config.settings;

  const std::set<std::string> needed = CollisionScene::neededModels(description);
  for (std::size_t i = 0; i < sources.robots.size(); ++i) {
    SceneSources::Robot& robot = sources.robots[i];
    description.robots[i].model = loadGeometry(*robot.source, robot.prefix, needed, broken_links);
  }
  if (sources.environment) {
    description.world = loadGeometry(*sources.environment, "", needed, broken_links);
  }
  std::sort(broken_links.begin(), broken_links.end());
  broken_links.erase(std::unique(broken_links.begin(), broken_links.end()), broken_links.end());
  return description;
}

}  // namespace collision_pairs
