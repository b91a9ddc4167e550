// Joint states as a robot's driver publishes them.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <sensor_msgs/JointState.h>

namespace collision_pairs {

inline sensor_msgs::JointState jointState(double stamp, std::vector<std::string> names,
                                          std::vector<double> positions) {
  sensor_msgs::JointState message;
  message.header.stamp = ros::Time(stamp);
  message.name = std::move(names);
  message.position = std::move(positions);
  return message;
}

}  // namespace collision_pairs
