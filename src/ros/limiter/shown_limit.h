// The limiter's last decision with the points that rviz shows.
#pragma once

#include "collision_pairs/collision_detector.h"
#include "markers.h"

namespace collision_pairs {

/// With the nearest points of the pair that limits, if it is in the detector's scene and no further
/// apart than a metre. Replaces the detector's report.
ShownLimit shownLimit(const SpeedLimit& limit, CollisionDetector& detector, const BodyPoses& poses,
                      Fidelity fidelity);

}  // namespace collision_pairs
