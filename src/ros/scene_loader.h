// From the parameter server to what a scene is made of.
#pragma once

#include <ros/node_handle.h>

#include "scene_sources.h"

namespace collision_pairs {

/// What the parameters say of a scene.
struct SceneParameters {
  SceneSources sources;
  std::string fixed_frame;  ///< empty: the robot's root link
};

/// Reads ~fixed_frame, ~robots, or else robot_description and robot_description_semantic (both
/// searched for from the node's private namespace upwards), environment_description (searched for,
/// too) and what sceneConfigKeys() lists. Unknown links of an SRDF, and what a URDF says that means
/// nothing, go to the log. Throws InputError that names the parameter.
SceneParameters readSceneParameters(const ros::NodeHandle& private_node);

}  // namespace collision_pairs
