// The core's report as ROS messages. Pure functions.
#pragma once

#include <string>
#include <vector>

#include <collision_pairs/CollisionPairs.h>

#include "collision_pairs/closing_motion.h"
#include "collision_pairs/collision_detector.h"

namespace collision_pairs {

/// An empty report: UNKNOWN for this reason.
CollisionPairs unknown(const std::string& reason, const std::string& frame, const ros::Time& stamp);

/// Left out are also the links whose geometry is CollisionScene::missing(). Without `closing` no
/// closing speed is known. time_transforms is left at 0 for the caller.
CollisionPairs toMessage(const CollisionReport& report, const CollisionScene& scene,
                         const CheckSettings& settings, const std::string& frame,
                         const ros::Time& stamp, const ClosingReport* closing = nullptr);

}  // namespace collision_pairs
