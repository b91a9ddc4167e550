// The part of the node's parameters that says what is in a scene; tools read the same from a file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "cloud_config.h"
#include "collision_pairs/scene_description.h"

namespace collision_pairs {

struct SceneConfig {
  SceneSettings settings;
  Restriction restriction;
  std::optional<RigidObject> floor;
  std::vector<CloudConfig> clouds;
};

/// The keys that readSceneConfig() knows.
const std::vector<std::string>& sceneConfigKeys();

/// These, and all other parameters of the node: what its file of parameters may hold.
const std::vector<std::string>& nodeParameterKeys();

/// From a map with any of sceneConfigKeys(); other keys are passed over. Throws InputError that
/// names the key, what it is and what it must be: a partially parsed filter would
/// silently drop pairs. Whether its links exist is for the scene to say.
SceneConfig readSceneConfig(const YAML::Node& map);

/// The same, but a key that is neither of these nor another parameter of the node is refused.
/// `origin`: what the map came from, for messages.
SceneConfig readSceneSettings(const YAML::Node& map, const std::string& origin);

/// The same from a YAML file, for example the one that the node's parameters are loaded from.
SceneConfig readSceneConfigFile(const std::string& path);

}  // namespace collision_pairs
