// Which pairs one of MoveIt's requests asks about.
#pragma once

#include <set>
#include <string>
#include <vector>

#include <moveit/collision_detection/collision_matrix.h>
#include <moveit/robot_model/robot_model.h>

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

/// MoveIt's rule for a pair; null: an object of the world. ALWAYS also for a pair beyond the
/// limits.
AllowedContact allowedBy(const MoveitLimits& limits, const MoveitBody* a, const std::string& name_a,
                         const MoveitBody* b, const std::string& name_b);

}  // namespace collision_pairs
