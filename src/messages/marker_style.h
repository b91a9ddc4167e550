// Properties shared by all markers.
#pragma once

#include <std_msgs/ColorRGBA.h>
#include <visualization_msgs/Marker.h>

namespace collision_pairs {

inline std_msgs::ColorRGBA color(float r, float g, float b, float a) {
  std_msgs::ColorRGBA rgba;
  rgba.r = r;
  rgba.g = g;
  rgba.b = b;
  rgba.a = a;
  return rgba;
}

/// First in an array: deletes all older markers.
inline visualization_msgs::Marker clearAll(const std::string& frame, const ros::Time& stamp) {
  visualization_msgs::Marker clear;
  clear.header.frame_id = frame;
  clear.header.stamp = stamp;
  clear.action = visualization_msgs::Marker::DELETEALL;
  return clear;
}

}  // namespace collision_pairs
