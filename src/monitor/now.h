// The time of an event.
#pragma once

#include <ros/time.h>

namespace collision_pairs {

/// On the two clocks that count.
struct Now {
  /// As if one clock were the other.
  Now(const ros::Time& time) : stamp(time), steady(time.toSec()) {}
  Now(const ros::Time& time, double seconds) : stamp(time), steady(seconds) {}

  /// ROS time, which is that of stamps: it may be simulated, stand still, or step.
  ros::Time stamp;
  double steady;  ///< seconds of a clock that does not
};

}  // namespace collision_pairs
