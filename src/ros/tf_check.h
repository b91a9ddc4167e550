// A check of the robot at its TF poses, as the cycle and check_collisions report it.
#pragma once

#include <string>
#include <vector>

#include <collision_pairs/CollisionPairs.h>

#include "active_scene.h"
#include "collision_pairs/collision_detector.h"
#include "transform_input.h"

namespace collision_pairs {

/// Reasons why a report of these poses cannot be FREE: bodies without a pose, and transforms that
/// are being refused. Empty if all poses are known.
std::vector<std::string> doubtsOf(const StampedPoses& stamped, const TransformInput& transforms,
                                  const ros::Time& now);

/// Checks the poses with `detector`, which is of the same scene. Stamped with the instant of the
/// poses, or with `now` where nothing that is known ever moves: what only static transforms
/// describe is as good now as ever. With a doubt the verdict is not FREE. `transform_time`: s that
/// the poses took.
CollisionPairs checkPoses(const ActiveScene& scene, const StampedPoses& stamped,
                          const std::vector<std::string>& doubts, const CheckSettings& settings,
                          const ros::Time& now, double transform_time, CollisionDetector& detector);

/// Seconds. Shorter is nearer to now, longer has less of the noise of encoders; TF interpolates
/// where it comes less often.
constexpr double VELOCITY_WINDOW = 0.1;

/// Adds how fast the pairs of `report`, from which the message was made, come nearer to each other:
/// from where TF had the bodies of those pairs VELOCITY_WINDOW before the poses.
void addClosingMotion(const ActiveScene& scene, const StampedPoses& stamped,
                      const CollisionReport& report, CollisionPairs& message);

}  // namespace collision_pairs
