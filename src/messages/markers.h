// The report as rviz shows it. Pure functions.
#pragma once

#include <string>

#include <visualization_msgs/MarkerArray.h>

#include "collision_pairs/collision_report.h"

namespace collision_pairs {

/// One CUBE for each box, in one of three namespaces: "boxes_in_contact" (red: an element of a
/// contact), "investigated_boxes" (amber: in a candidate pair, without contact) and "other_boxes"
/// (grey, left out where `only_investigated`). "contacts" holds a line between the two witness
/// points of each pair in reach with a ball at either end, "normals" an arrow for each contact.
/// The array begins with DELETEALL, so that nothing older stays.
visualization_msgs::MarkerArray toMarkers(const CollisionReport& report, bool only_investigated,
                                          const std::string& frame, const ros::Time& stamp);

}  // namespace collision_pairs
