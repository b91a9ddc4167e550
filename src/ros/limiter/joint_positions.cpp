#include "joint_positions.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision_pairs/input_error.h"

namespace collision_pairs {

void JointPositions::take(const sensor_msgs::JointState& message, double now, double tolerance) {
  const double stamp = message.header.stamp.toSec();
  if (stamp > now + tolerance) return;
  const std::size_t nb_joints = std::min(message.name.size(), message.position.size());
  for (std::size_t i = 0; i < nb_joints; ++i) {
    Position& position = newest_[message.name[i]];
    if (stamp >= position.stamp) position = {stamp, message.position[i]};
  }
}

double JointPositions::oldestOf(const std::vector<std::string>& joints) const {
  double oldest = std::numeric_limits<double>::infinity();
  for (const std::string& name : joints) {
    const auto found = newest_.find(name);
    if (found == newest_.end()) throw InputError("nobody reports joint '" + name + "'");
    if (!std::isfinite(found->second.value)) {
      throw InputError("the position of joint '" + name + "' is not finite");
    }
    oldest = std::min(oldest, found->second.stamp);
  }
  return oldest;
}

}  // namespace collision_pairs
