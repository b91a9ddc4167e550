// A check of the robot at its TF poses, as the cycle and check_collisions report it.
#pragma once

#include <string>
#include <vector>

#include <collision_pairs/CollisionPairs.h>

#include "collision_pairs/collision_detector.h"
#include "scene_store.h"
#include "transform_input.h"

namespace collision_pairs {

/// Reasons why a report of these poses cannot be FREE: bodies without a pose, and transforms that
/// are being refused. Empty if all poses are known.
std::vector<std::string> doubtsOf(const StampedPoses& stamped, const TransformInput& transforms,
                                  const ros::Time& now);

/// Checks the poses with `detector`, which is of the same scene. Stamped with the instant of the
/// poses, or with `now` if all known poses are static. With a doubt the verdict is not FREE.
/// `transform_time`: s spent on the poses.
CollisionPairs checkPoses(const ActiveScene& scene, const StampedPoses& stamped,
                          const std::vector<std::string>& doubts, const CheckSettings& settings,
                          const ros::Time& now, double transform_time, CollisionDetector& detector);

/// Adds the closing speeds of the pairs of `report`, from which the message was made, using the TF
/// poses 0.1 s before.
void addClosingMotion(const ActiveScene& scene, const StampedPoses& stamped,
                      const CollisionReport& report, CollisionPairs& message);

}  // namespace collision_pairs
