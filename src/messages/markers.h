// The report as markers for rviz. Pure functions.
#pragma once

#include <collision_pairs/CollisionPairs.h>
#include <visualization_msgs/MarkerArray.h>

#include "collision_pairs/collision_report.h"

namespace collision_pairs {

/// "verdict": a large coloured text above everything, "FREE" green, "COLLISION" red or "UNKNOWN"
/// violet, and below it in small letters the deepest pair or the first reason. These have no stamp,
/// so that rviz draws them even if the poses are old, in the message's frame.
///
/// One CUBE for each box of the report, in one of three namespaces: "boxes_in_contact" (red: an
/// element of a contact), "investigated_boxes" (amber: in a candidate pair, without contact) and
/// "other_boxes" (grey, left out where `only_investigated`). "contacts" holds a line between the
/// two witness points of each pair in reach with a sphere at either end, "normals" an arrow for
/// each contact. Without a report (null) there is the verdict only. The array begins with
/// DELETEALL, so that no older markers remain.
visualization_msgs::MarkerArray toMarkers(const CollisionPairs& message,
                                          const CollisionReport* report, bool only_investigated);

}  // namespace collision_pairs
