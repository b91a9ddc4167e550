// The scene parameters of the node; tools read the same from a file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "cloud_config.h"
#include "collision_pairs/scene_description.h"
#include "stamps.h"
#include "text_files.h"

namespace collision_pairs {

struct SceneConfig {
  SceneSettings settings;
  Restriction restriction;
  std::optional<RigidObject> floor;
  std::vector<CloudConfig> clouds;
  /// Joints that are not fixed, but that /tf_static may place. Not checked here to exist.
  std::vector<std::string> static_joints;
  /// Read from files only; the node has them as parameters of its own.
  PoseLimits pose_limits;
  /// Parameters in the map that say what is in the scene, but only to the node: robots, and
  /// fixed_frame.
  std::vector<std::string> of_the_node_only;
};

/// For a warning: what of the settings is not checked outside the node: the parameters above (but
/// fixed_frame only where a floor or a world is in it), and the clouds that are not among those in
/// use. Empty if all is checked.
std::string warningOfIgnored(const SceneConfig& config, const std::vector<CloudConfig>& used,
                             bool has_world);

/// The keys that readSceneConfig() reads.
const std::vector<std::string>& sceneConfigKeys();

/// These and all other parameters of the node: the keys allowed in its parameter file.
const std::vector<std::string>& nodeParameterKeys();

/// From a map with any of sceneConfigKeys(); other keys are ignored. Throws InputError that names
/// the key, its value and the rule: a partially parsed filter would silently drop pairs. Whether
/// its links exist is checked by the scene.
SceneConfig readSceneConfig(const YAML::Node& map);

/// The same, but a key that is neither of these nor another parameter of the node is refused.
/// `origin`: source of the map, for messages.
SceneConfig readSceneSettings(const YAML::Node& map, const std::string& origin);

/// The same from a text, whose origin errors name.
SceneConfig readSceneSettings(const TextFrom& yaml);

/// The same from a YAML file, for example the one that the node's parameters are loaded from.
SceneConfig readSceneConfigFile(const std::string& path);

/// The text of a settings file with the map's sceneConfigKeys() and these limits:
/// readSceneSettings() gives the same configuration.
std::string settingsText(const YAML::Node& map, const PoseLimits& limits);

}  // namespace collision_pairs
