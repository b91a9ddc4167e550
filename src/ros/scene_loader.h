// From the parameter server to what a scene is made of.
#pragma once

#include <ros/node_handle.h>

#include "scene_sources.h"

namespace collision_pairs {

/// Reads ~robots, or else robot_description and robot_description_semantic (both searched for from
/// the node's private namespace upwards), environment_description (searched for, too) and what
/// sceneConfigKeys() lists. `settings` holds what is read elsewhere. Unknown links of an SRDF go to
/// the log by name. Throws InputError that names the parameter.
SceneSources readSceneSources(const ros::NodeHandle& private_node, const SceneSettings& settings);

}  // namespace collision_pairs
