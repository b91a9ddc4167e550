// From the parameter server to what a scene is made of.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <ros/node_handle.h>

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
  std::unique_ptr<RobotSource> environment;  ///< null: none
  SceneConfig config;
};

/// Reads ~robots, or else robot_description and robot_description_semantic (both searched for from
/// the node's private namespace upwards), environment_description (searched for, too) and what
/// sceneConfigKeys() lists. `settings` holds what is read elsewhere. Unknown links of an SRDF go to
/// the log by name. Throws InputError that names the parameter.
SceneSources readSceneSources(const ros::NodeHandle& private_node, const SceneSettings& settings);

/// With the geometry of the links that are in some pair, and of no others. `objects` are those
/// beside the configured ones; `restriction` stands for the configured one unless it is empty.
/// Links with a broken mesh go to the log, and to `broken_links`.
SceneDescription describeScene(SceneSources& sources, std::vector<RigidObject> objects,
                               const Restriction& restriction,
                               std::vector<std::string>& broken_links);

}  // namespace collision_pairs
