#include "scene_options.h"

#include "collision_pairs/input_error.h"
#include "mesh_loader.h"
#include "robot_files.h"
#include "scene_sources.h"
#include "text_files.h"
#include "tool_errors.h"

namespace collision_pairs {
namespace {

/// What else the node's parameter file holds; it fits here as it is.
const std::vector<std::string>& parametersOfTheNodeOnly() {
  static const std::vector<std::string> KEYS = {"alarm_distance",  "fidelity",
                                                "time_budget",     "rate",
                                                "robots",          "show_only_investigated_boxes",
                                                "verdict_only",    "min_distance",
                                                "max_pose_age",    "max_transform_age",
                                                "clock_tolerance", "fixed_frame"};
  return KEYS;
}

std::unique_ptr<RobotSource> sourceFrom(const TextFrom& urdf, const MeshLoader& load_mesh) {
  try {
    auto source = std::make_unique<RobotSource>(urdf.content, load_mesh);
    for (const std::string& warning : source->skeleton()->warnings()) {
      warn(urdf.origin + ": " + warning);
    }
    return source;
  } catch (const InputError& error) {
    throw InputError(urdf.origin + ": " + error.what());
  }
}

SceneSources readSources(const TextFrom& urdf, const TextFrom& srdf, const SceneOptions& options) {
  SceneSources sources;
  const MeshLoader load_mesh = makeMeshLoader();
  sources.robots.emplace_back();
  SceneSources::Robot& robot = sources.robots.back();
  robot.source = sourceFrom(urdf, load_mesh);
  if (!srdf.origin.empty()) {
    robot.srdf = srdfFromText(srdf.content, srdf.origin, *robot.source->skeleton());
  }
  if (!options.world.empty()) {
    sources.world = sourceFrom({options.world, readTextFile(options.world)}, load_mesh);
  }
  if (!options.settings.empty()) {
    sources.config = readSceneConfigFile(options.settings, parametersOfTheNodeOnly());
  }
  return sources;
}

// Who asks about a whole robot wants to know of a mesh that is missing, needed or not.
void readAllMeshes(SceneSources& sources) {
  const auto all = [](const std::string&) { return true; };
  sources.robots[0].source->withGeometryOf(all);
  if (sources.world) sources.world->withGeometryOf(all);
}

}  // namespace

void declareScene(CLI::App& app, SceneOptions& options) {
  app.add_option("--world", options.world, "a URDF that stands still, its root at the robot's root")
      ->type_name("WORLD.urdf");
  app.add_option("--settings", options.settings,
                 "rules, paddings and the like, as the node's parameter file has them")
      ->type_name("SETTINGS.yaml");
  app.add_option("--group", options.group, "only pairs with a link that this group moves");
  app.add_option("--links", options.links, "only pairs with one of these links; patterns are read")
      ->type_name("LINK...");
}

std::shared_ptr<const CollisionScene> buildScene(const TextFrom& urdf, const TextFrom& srdf,
                                                 const SceneOptions& options, Fidelity fidelity,
                                                 int max_hull_vertices) {
  SceneSources sources = readSources(urdf, srdf, options);
  SceneSettings& settings = sources.config.settings;
  settings.fidelity = fidelity;
  if (max_hull_vertices != 0) settings.max_hull_vertices = max_hull_vertices;
  const bool is_restricted = !options.group.empty() || !options.links.empty();
  if (!is_restricted) readAllMeshes(sources);
  std::vector<BrokenElement> broken;
  const SceneDescription description =
      describeScene(sources, {}, {options.group, options.links}, broken);
  if (!broken.empty()) {
    const auto& [link, reason] = broken.front();
    const bool of_robot = sources.robots[0].source->skeleton()->findLink(link) >= 0;
    const std::string& origin = of_robot ? urdf.origin : options.world;
    throw InputError(origin + ": URDF: link '" + link + "': " + reason);
  }
  const auto scene = CollisionScene::build(description);
  if (is_restricted && scene->models().empty()) {
    throw InputError("--group and --links leave no pair to check");
  }
  return scene;
}

}  // namespace collision_pairs
