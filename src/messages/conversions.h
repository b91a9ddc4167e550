// The core's report as ROS messages. Pure functions.
#pragma once

#include <string>
#include <vector>

#include <collision_pairs/CollisionPairs.h>

#include "collision_pairs/collision_detector.h"

namespace collision_pairs {

/// `broken_links` are added to the links left out. time_transforms is left at 0 for the caller.
CollisionPairs toMessage(const CollisionReport& report, const CollisionScene& scene,
                         const CheckSettings& settings, const std::string& frame,
                         const ros::Time& stamp, const std::vector<std::string>& broken_links);

}  // namespace collision_pairs
