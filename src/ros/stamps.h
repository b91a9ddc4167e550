// How far stamps are apart, in numbers and in words.
#pragma once

#include <cstdio>
#include <string>

#include <ros/time.h>

namespace collision_pairs {

/// In seconds. ros::Duration throws beyond 68 years, and stamps may be anything.
inline double secondsBetween(const ros::Time& begin, const ros::Time& end) {
  return end.toSec() - begin.toSec();
}

/// "0.25 s"
inline std::string inWords(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f s", seconds);
  return text;
}

}  // namespace collision_pairs
