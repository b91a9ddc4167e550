#include "scene_sources.h"

#include <set>

#include "collision_pairs/collision_scene.h"

namespace collision_pairs {
namespace {

std::shared_ptr<const RobotModel> loadGeometry(RobotSource& source, const std::string& prefix,
                                               const std::set<std::string>& needed,
                                               std::vector<BrokenElement>& broken) {
  const auto model = source.withGeometryOf(
      [&](const std::string& link) { return needed.count(withPrefix(prefix, link)) > 0; });
  for (const BrokenElement& element : source.broken()) {
    broken.push_back({withPrefix(prefix, element.link), element.reason});
  }
  return model;
}

}  // namespace

SceneDescription describeScene(SceneSources& sources, std::vector<RigidObject> objects,
                               const Restriction& restriction, std::vector<BrokenElement>& broken) {
  SceneDescription description;
  for (const SceneSources::Robot& robot : sources.robots) {
    description.robots.push_back({robot.source->skeleton(), robot.srdf, robot.prefix});
  }
  if (sources.world) description.world = sources.world->skeleton();
  description.objects = std::move(objects);
  if (sources.config.floor) description.objects.push_back(*sources.config.floor);
  description.restriction = restriction.empty() ? sources.config.restriction : restriction;
  description.settings = sources.config.settings;

  const std::set<std::string> needed = CollisionScene::neededModels(description);
  for (std::size_t i = 0; i < sources.robots.size(); ++i) {
    const SceneSources::Robot& robot = sources.robots[i];
    description.robots[i].model = loadGeometry(*robot.source, robot.prefix, needed, broken);
  }
  if (sources.world) description.world = loadGeometry(*sources.world, "", needed, broken);
  return description;
}

}  // namespace collision_pairs
