// Answers MoveIt's requests about one scene: poses and allowed collision matrix in, results out.
#pragma once

#include <string>

#include <moveit/collision_detection/collision_common.h>
#include <moveit/robot_state/robot_state.h>

#include "moveit_limits.h"
#include "moveit_scene.h"

namespace collision_pairs {

/// Adds to `result` what collides, with a world's octrees as they are now. What is not certain counts as a collision, without contacts, and
/// is logged. Contacts: position between the two witness points, both in the world frame; one for
/// each pair of elements, or of an element and a leaf, the deepest first. Costs are not computed.
void addCollisions(const MoveitScene& scene, const moveit::core::RobotState& state,
                    const MoveitLimits& limits,
                    const collision_detection::CollisionRequest& request,
                    collision_detection::CollisionResult& result);

/// Adds to `result` the distances; signed ones, whatever was requested. What is uncertain has
/// distance 0 or its lower bound, and is logged.
void addDistances(const MoveitScene& scene, const moveit::core::RobotState& state,
                     const MoveitLimits& limits,
                     const collision_detection::DistanceRequest& request,
                     collision_detection::DistanceResult& result);

/// Writes a warning to ROS's log, at most one a second.
void warnRarely(const std::string& text);

}  // namespace collision_pairs
