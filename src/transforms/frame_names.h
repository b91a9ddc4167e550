// Names of TF frames.
#pragma once

#include <string>

#include "collision_pairs/robot_model.h"
#include "user_text.h"

namespace collision_pairs {

/// Removes leading and trailing slashes.
inline std::string withoutSlashes(std::string name) {
  while (!name.empty() && name.front() == '/') name.erase(0, 1);
  while (!name.empty() && name.back() == '/') name.pop_back();
  return name;
}

/// Whether a robot whose frames have the prefix P calls the link so: P/link, or Plink.
inline bool isFrameOf(const std::string& link, const std::string& prefix,
                      const std::string& frame) {
  return frame == withPrefix(prefix, link) || frame == prefix + link;
}

}  // namespace collision_pairs
