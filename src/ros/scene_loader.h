// From the parameter server to what a scene is made of.
#pragma once

#include <ros/node_handle.h>

#include "scene_sources.h"

namespace collision_pairs {

/// Reads ~robots, or else robot_description and robot_description_semantic (both searched for from
/// the node's private namespace upwards), environment_description (searched for, too) and what
/// sceneConfigKeys() lists. Unknown links of an SRDF, and what a URDF says that means nothing, go to
/// the log. Throws InputError that names the parameter.
SceneSources readSceneSources(const ros::NodeHandle& private_node);

}  // namespace collision_pairs
