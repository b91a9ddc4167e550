// Difference of stamps.
#pragma once

#include <ros/time.h>

namespace collision_pairs {

/// In seconds. ros::Duration throws beyond 68 years, and stamps may be anything.
inline double secondsBetween(const ros::Time& begin, const ros::Time& end) {
  return end.toSec() - begin.toSec();
}

}  // namespace collision_pairs
