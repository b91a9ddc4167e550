// Which link or joint of a RobotModel's parts is wrong, for readers that know its line.
#pragma once

#include <string>
#include <utility>

#include "collision_pairs/input_error.h"

namespace collision_pairs {

/// Thrown by RobotModel::fromParts(). `tag`: "link", "joint", or "robot" where it is none of them.
struct PartError : InputError {
  PartError(std::string its_tag, std::string its_name, const std::string& robot, std::string why)
      : InputError("robot '" + robot + "': " + why),
        tag(std::move(its_tag)),
        name(std::move(its_name)),
        reason(std::move(why)) {}

  std::string tag, name, reason;
};

}  // namespace collision_pairs
