// Reads the description of a scene from the parameter server.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include <ros/node_handle.h>

#include "scene_store.h"

namespace collision_pairs {

/// Reads ~fixed_frame, ~robots, or else robot_description (searched for from the node's private
/// namespace upwards) and robot_description_semantic (the same, in no namespace further up than
/// the first, or it may be of another robot), environment_description (searched for, too) and what
/// sceneConfigKeys() lists. `log` is told of unknown links of an SRDF, ineffective content of a
/// URDF and misspelt parameters. Topics of clouds are names relative to `node`; `limits` are those
/// in use. Throws InputError that names the parameter; also without ~configured.
SceneParameters readSceneParameters(const ros::NodeHandle& node,
                                    const ros::NodeHandle& private_node, const PoseLimits& limits,
                                    const Warn& log);

/// The descriptions of SceneParameters that are not what they were when they were read: their
/// names, resolved. Asks the parameter server for all of them. One that was deleted or emptied is
/// among them. None while the master does not answer.
std::vector<std::string> changedDescriptions(const ros::NodeHandle& private_node,
                                             const std::map<std::string, std::size_t>& read);

}  // namespace collision_pairs
