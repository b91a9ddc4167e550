// How fast the pairs of a report come nearer to each other, from where their bodies were before.
#pragma once

#include "collision_pairs/body_poses.h"
#include "collision_pairs/collision_report.h"
#include "collision_pairs/collision_scene.h"

namespace collision_pairs {

/// Where the bodies were `window` seconds (> 0) before a check.
struct EarlierPoses {
  BodyPoses poses;
  double window = 0.0;
};

/// Of two models. Their velocity is the mean over the window, as one sees it from the other.
struct ClosingMotion {
  /// The longest time that is looked ahead, seconds.
  static constexpr double HORIZON = 10.0;

  /// False: one of them was not seen at both instants, or where they are nearest is not known. Then
  /// the others are 0.
  bool known = false;
  /// m/s: by how much their distance shrinks where they are nearest, or where they penetrate by how
  /// much the depth grows; of several places the fastest. Negative: they part.
  double closing_speed = 0.0;
  /// Seconds, 0 to HORIZON: they do not touch before, if they keep their velocity as one sees it
  /// from the other (the origin of the one's link frame goes straight on, and it turns on about the
  /// same axis). A lower bound, to 10 us. 0 where they may be in contact.
  double time_to_contact = 0.0;
};

/// Of one pair of a report, which was made with the poses `now`. No more than that pair is looked
/// at: what the report does not list is further apart than the alarm distance, and may be fast.
///
/// How. A plane between the hulls of two elements, along the normal where they are nearest: to
/// first order in time the one reaches furthest along a normal that tilts, the rest is bounded (see
/// PlaneBound). Where no such plane is between them the distance is divided by the speed of the
/// fastest point. Cost: some twenty support points of each hull for each pair of elements in reach,
/// 1 to 10 us.
ClosingMotion closingMotion(const CollisionScene& scene, const CollisionReport& report,
                            const PairReport& pair, const BodyPoses& now,
                            const EarlierPoses& before);

}  // namespace collision_pairs
