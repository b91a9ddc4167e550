// Many joint states of one request, on all cores.
#pragma once

#include <string>
#include <vector>

#include <collision_pairs/CheckTrajectory.h>
#include <ros/time.h>

#include "collision_pairs/batch_check.h"
#include "joint_query.h"

namespace collision_pairs {

/// Fills in what the response says of each point. Throws InputError that names the point and the
/// joint; the response is then not to be used.
void checkTrajectory(const CheckTrajectory::Request& request, const JointQuery& query,
                     const CheckSettings& settings, const std::vector<std::string>& broken_links,
                     const std::string& frame, const ros::Time& stamp, BatchCheck& batch,
                     CheckTrajectory::Response& response);

}  // namespace collision_pairs
