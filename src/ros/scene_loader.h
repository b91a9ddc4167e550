// From the parameter server to a scene.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <ros/node_handle.h>

#include "collision_pairs/collision_scene.h"

namespace collision_pairs {

struct LoadedScene {
  std::shared_ptr<const CollisionScene> scene;
  /// Links with geometry that could not be read: listed as left out in every report.
  std::vector<std::string> broken_links;
};

/// Reads robot_description and robot_description_semantic (both searched for from the node's
/// private namespace upwards) and builds the scene. Broken meshes and unknown links of the SRDF go
/// to the log by name. Throws InputError where there is no scene to build.
LoadedScene loadScene(const ros::NodeHandle& private_node, SceneSettings settings);

}  // namespace collision_pairs
