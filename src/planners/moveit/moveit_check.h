// Answers MoveIt's requests about one scene: poses and allowed collision matrix in, results out.
#pragma once

#include <set>
#include <string>
#include <vector>

#include <moveit/collision_detection/collision_common.h>
#include <moveit/collision_detection/collision_matrix.h>
#include <moveit/robot_state/robot_state.h>

#include "moveit_scene.h"

namespace collision_pairs {

/// What limits a question. Null: nothing.
struct MoveitLimits {
  const collision_detection::AllowedCollisionMatrix* matrix = nullptr;
  /// By index of the link: pairs with a body of one of these links. May be empty: all.
  std::vector<char> active_links;
};

/// The links that `links` names; all if it is null.
std::vector<char> activeLinks(const moveit::core::RobotModel& robot,
                              const std::set<const moveit::core::LinkModel*>* links);

/// MoveIt's rule for a pair; null: an object of the world. ALWAYS also for a pair beyond the limits.
AllowedContact allowedBy(const MoveitLimits& limits, const MoveitBody* a, const std::string& name_a,
                         const MoveitBody* b, const std::string& name_b);

/// Adds to `result` what collides. What is not certain counts as a collision, without contacts, and
/// is logged. Contacts: position between the two witness points, both in the world frame; one for
/// each pair of elements, the deepest first. Costs are not computed.
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
