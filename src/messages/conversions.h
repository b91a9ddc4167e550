// The core's report as ROS messages. Pure functions.
#pragma once

#include <string>
#include <vector>

#include <collision_pairs/CollisionPairs.h>

#include "collision_pairs/collision_detector.h"

namespace collision_pairs {

/// Reasons why the verdict cannot be FREE; empty if it can. `broken_links`: links whose geometry
/// could not be read.
std::vector<std::string> whyUnknown(const CollisionReport& report, const CollisionScene& scene,
                                    const std::vector<std::string>& broken_links);

/// With a reason, FREE becomes UNKNOWN. COLLISION is certain and is kept.
void notFree(CollisionPairs& message, const std::vector<std::string>& reasons);

/// An empty report: UNKNOWN for this reason.
CollisionPairs unknown(const std::string& reason, const std::string& frame, const ros::Time& stamp);

/// `broken_links` are added to the links left out, and turn FREE into UNKNOWN. time_transforms is
/// left at 0 for the caller.
CollisionPairs toMessage(const CollisionReport& report, const CollisionScene& scene,
                         const CheckSettings& settings, const std::string& frame,
                         const ros::Time& stamp, const std::vector<std::string>& broken_links);

}  // namespace collision_pairs
