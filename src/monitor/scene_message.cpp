#include "scene_message.h"

#include "collision_pairs/input_error.h"

namespace collision_pairs {
namespace {

std::string originOf(const Scene& message) {
  return "scene of revision " + std::to_string(message.revision);
}

const std::string& requiredFrame(const Scene& message) {
  if (!message.header.frame_id.empty()) return message.header.frame_id;
  throw InputError(originOf(message) + ": header.frame_id is empty");
}

}  // namespace

Scene toMessage(const StoredScene& scene) {
  const SceneParameters& parameters = *scene.parameters;
  Scene message;
  message.header.stamp = scene.since;
  message.header.frame_id = scene.frame;
  message.revision = scene.revision;
  for (const SceneSources::Robot& robot : parameters.sources.robots) {
    message.robots.emplace_back();
    message.robots.back().prefix = robot.prefix;
    message.robots.back().urdf = robot.source->urdf();
    message.robots.back().srdf = robot.srdf_text;
  }
  if (parameters.sources.world) message.world = parameters.sources.world->urdf();
  message.settings = parameters.sources.settings_text;
  message.cloud_topics = parameters.cloud_topics;
  message.objects = listed(*scene.objects, scene.frame);
  message.objects_are_lost = scene.are_objects_lost;
  return message;
}

SceneParameters parametersOf(const Scene& message, const MeshLoader& load_mesh, const Warn& warn) {
  const std::string origin = originOf(message) + ": ";
  SceneParameters parameters;
  parameters.fixed_frame = requiredFrame(message);
  SceneSources& sources = parameters.sources;
  if (message.robots.empty()) throw InputError(origin + "it has no robot");
  for (std::size_t i = 0; i < message.robots.size(); ++i) {
    const RobotDescription& described = message.robots[i];
    const std::string of_robot = origin + "robots[" + std::to_string(i) + "]";
    SceneSources::Robot robot;
    robot.prefix = described.prefix;
    robot.source = robotSource({of_robot + "/urdf", described.urdf}, load_mesh, warn);
    if (!described.srdf.empty()) robot.readSrdf({of_robot + "/srdf", described.srdf}, warn);
    sources.robots.push_back(std::move(robot));
  }
  if (!message.world.empty()) {
    sources.world = robotSource({origin + "world", message.world}, load_mesh, warn);
  }
  sources.readSettings({origin + "settings", message.settings});
  parameters.cloud_topics = message.cloud_topics;
  if (parameters.cloud_topics.size() != sources.config.clouds.size()) {
    throw InputError(origin + "cloud_topics has " + std::to_string(message.cloud_topics.size()) +
                     " entries, but settings have " + std::to_string(sources.config.clouds.size()) +
                     " clouds");
  }
  return parameters;
}

SceneObjects objectsOf(const Scene& message, const MeshLoader& load_mesh) {
  const std::string& frame = requiredFrame(message);
  return naming(originOf(message), [&] { return readListed(message.objects, frame, load_mesh); });
}

}  // namespace collision_pairs
