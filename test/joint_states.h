// Joint states as a robot's driver publishes them, and what is said of those that are refused.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <sensor_msgs/JointState.h>

#include "collision_pairs/input_error.h"

namespace collision_pairs {

inline sensor_msgs::JointState jointState(double stamp, std::vector<std::string> names,
                                          std::vector<double> positions) {
  sensor_msgs::JointState message;
  message.header.stamp = ros::Time(stamp);
  message.name = std::move(names);
  message.position = std::move(positions);
  return message;
}

/// Empty if nothing is refused.
template <class Ask>
std::string refusalBy(const Ask& ask) {
  try {
    ask();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace collision_pairs
