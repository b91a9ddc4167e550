// Reads the description of a scene from the parameter server.
#pragma once

#include <ros/node_handle.h>

#include "scene_sources.h"

namespace collision_pairs {

/// The parameters of a scene.
struct SceneParameters {
  SceneSources sources;
  std::string fixed_frame;  ///< empty: the robot's root link
};

/// Reads ~fixed_frame, ~robots, or else robot_description and robot_description_semantic (both
/// searched for from the node's private namespace upwards), environment_description (searched for,
/// too) and what sceneConfigKeys() lists. Unknown links of an SRDF and ineffective content of a
/// URDF are logged. Throws InputError that names the parameter.
SceneParameters readSceneParameters(const ros::NodeHandle& private_node);

}  // namespace collision_pairs
