// Names of TF frames.
#pragma once

#include <string>

namespace collision_pairs {

/// tf of old wrote "/base"; tf2 has no such frame.
inline std::string withoutLeadingSlash(const std::string& frame) {
  return !frame.empty() && frame.front() == '/' ? frame.substr(1) : frame;
}

}  // namespace collision_pairs
