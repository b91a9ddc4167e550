// The report as markers for rviz. Pure functions.
#pragma once

#include <optional>

#include <collision_pairs/CollisionPairs.h>
#include <collision_pairs/SpeedLimit.h>
#include <visualization_msgs/MarkerArray.h>

#include "collision_pairs/collision_detector.h"

namespace collision_pairs {

/// What the velocity limiter made of the last command.
struct ShownLimit {
  SpeedLimit limit;
  std::optional<Contact> nearest;  ///< of the pair that limits, if it was looked for and found
};

/// With the nearest points of the pair that limits, if it is in the detector's scene and no further
/// apart than a metre. Replaces the detector's report.
ShownLimit shownLimit(const SpeedLimit& limit, CollisionDetector& detector, const BodyPoses& poses,
                      Fidelity fidelity);

/// "verdict": a large coloured text above everything, "FREE" green, "COLLISION" red or "UNKNOWN"
/// violet, and below it in small letters the deepest pair or the first reason. These have no stamp,
/// so that rviz draws them even if the poses are old, in the message's frame.
///
/// One CUBE for each box of the report, in one of three namespaces: "boxes_in_contact" (red: an
/// element of a contact), "investigated_boxes" (amber: in a candidate pair, without contact) and
/// "other_boxes" (grey, left out where `only_investigated`). "contacts" holds a line between the
/// two witness points of each pair in reach with a sphere at either end, "normals" an arrow for
/// each contact. "speed_limit", with a limit: a text by the verdict, the scale in per cent with
/// the pair that limits, and a thick line between the two; green, amber or red as the whole command
/// passes, a part or nothing. Without a report (null) there are the texts only. The array begins
/// with DELETEALL, so that no older markers remain.
visualization_msgs::MarkerArray toMarkers(const CollisionPairs& message,
                                          const CollisionReport* report, bool only_investigated,
                                          const std::optional<ShownLimit>& limit = std::nullopt);

}  // namespace collision_pairs
