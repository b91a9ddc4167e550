#include "trajectory_command.h"

#include <algorithm>
#include <cstddef>

#include "collision_pairs/input_error.h"
#include "user_text.h"

namespace collision_pairs {

std::vector<double> velocitiesOf(const trajectory_msgs::JointTrajectory& command,
                                 const std::vector<std::string>& joints, double reaction_time) {
  if (command.points.size() != 1) {
    throw InputError("the command has " + std::to_string(command.points.size()) +
                     " points, but must have one");
  }
  const std::vector<double>& given = command.points.front().velocities;
  if (command.joint_names.size() != joints.size() || given.size() != joints.size()) {
    throw InputError("the command has " + std::to_string(given.size()) + " velocities for " +
                     std::to_string(command.joint_names.size()) + " joints, but " +
                     std::to_string(joints.size()) + " joints are limited");
  }
  std::vector<double> velocities;
  for (const std::string& joint : joints) {
    const auto& names = command.joint_names;
    const auto found = std::find(names.begin(), names.end(), joint);
    if (found == names.end()) {
      throw InputError("the command has no velocity for joint '" + joint + "'");
    }
    velocities.push_back(given[static_cast<std::size_t>(found - names.begin())]);
  }
  const double seconds = command.points.front().time_from_start.toSec();
  if (seconds > reaction_time) {
    throw InputError(
        formatted("the command has a time_from_start of %g s, but must be in effect within "
                  "reaction_time, %g s",
                  seconds, reaction_time));
  }
  return velocities;
}

bool isAccepted(const trajectory_msgs::JointTrajectory& command,
                const std::vector<std::string>& joints, double reaction_time) {
  try {
    velocitiesOf(command, joints, reaction_time);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace collision_pairs
