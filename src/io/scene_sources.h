// What scenes are made of, as users give it: texts of robots, a world, and settings.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robot_source.h"
#include "scene_config.h"

namespace collision_pairs {

/// Meshes stay with it once they are loaded.
struct SceneSources {
  struct Robot {
    std::unique_ptr<RobotSource> source;
    std::optional<Srdf> srdf;
    std::string prefix;
  };
  std::vector<Robot> robots;
  std::unique_ptr<RobotSource> world;  ///< null: none
  SceneConfig config;
};

/// With the geometry of the links that are in some pair, and of no others: their meshes are not
/// even read. `objects` are those beside the configured floor; `restriction` stands for the
/// configured one unless it is empty. Elements with a mesh that cannot be used are left out, and
/// added to `broken` with their robot's prefix. Throws InputError.
SceneDescription describeScene(SceneSources& sources, std::vector<RigidObject> objects,
                               const Restriction& restriction, std::vector<BrokenElement>& broken);

}  // namespace collision_pairs
