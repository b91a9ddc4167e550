// The positions that a message of type sensor_msgs/JointState has.
#pragma once

#include <map>
#include <string>

#include <sensor_msgs/JointState.h>

namespace collision_pairs {

/// Nobody knows then which position is whose: the message cannot be used.
inline bool differInNumber(const sensor_msgs::JointState& state) {
  return state.name.size() != state.position.size();
}

/// By joint, without leading slashes, as robot_state_publisher takes them: none if names and
/// positions differ in number, and the first of a name that comes twice. They may be NaN.
std::map<std::string, double> positionsIn(const sensor_msgs::JointState& state);
/// Those of them that are finite.
std::map<std::string, double> finitePositionsIn(const sensor_msgs::JointState& state);

}  // namespace collision_pairs
