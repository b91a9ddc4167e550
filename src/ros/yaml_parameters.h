// The parameter server's values as YAML.
#pragma once

#include <ros/node_handle.h>
#include <yaml-cpp/yaml.h>

namespace collision_pairs {

/// A map with those of `keys` that are set below the node's namespace, so that one reader serves
/// parameters and files.
YAML::Node yamlParameters(const ros::NodeHandle& node, const std::vector<std::string>& keys);

}  // namespace collision_pairs
