// From a snapshot to the message: the same for the cycle and for requests.
#pragma once

#include <collision_pairs/CollisionPairs.h>

#include "collision_pairs/collision_detector.h"
#include "live_monitor.h"

namespace collision_pairs {

/// The report of a check of the snapshot.
CollisionPairs toMessage(const CollisionReport& report, const Snapshot& snapshot,
                         const CheckSettings& settings, const ClosingReport* closing = nullptr);

/// Checks the snapshot with `detector`, which is of its scene. With closing speeds, unless the
/// poses are of joints that were asked for. `transform_time`: s spent on the snapshot.
CollisionPairs checkedMessage(LiveMonitor& monitor, const Snapshot& snapshot,
                              const CheckSettings& settings, double transform_time,
                              CollisionDetector& detector);

}  // namespace collision_pairs
