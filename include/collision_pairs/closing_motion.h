// Closing speed and time to contact of the pairs of a report, from earlier poses of their bodies.
#pragma once

#include <vector>

#include "collision_pairs/body_poses.h"
#include "collision_pairs/collision_report.h"
#include "collision_pairs/collision_scene.h"

namespace collision_pairs {

/// Poses of the bodies `window` seconds (> 0) before a check.
struct EarlierPoses {
  BodyPoses poses;
  double window = 0.0;
};

/// Of two models. Their relative velocity is the average over the window.
struct ClosingMotion {
  /// Upper limit of time_to_contact, seconds.
  static constexpr double HORIZON = 10.0;

  /// False: the pose of one of them is unknown at either instant, or the witness points are
  /// unknown. The other fields are then 0.
  bool known = false;
  /// m/s: the rate at which the distance decreases at the witness points (in penetration: at which
  /// the depth increases); the maximum if there are several contacts. Negative: they separate.
  double closing_speed = 0.0;
  /// Seconds, 0 to HORIZON: a lower bound, to 10 us, of the time until they touch if they keep
  /// their relative velocity: seen from the one, the origin of the other's body frame (BodyPoses)
  /// continues straight, and the body continues to turn about the same axis. The other is the
  /// second of the pair, or the first if the second is a half-space or a cloud. They touch where
  /// their finest geometry in the scene does; a coarser one of the request, of link_fidelity or of
  /// max_hull_vertices may be in contact earlier. 0 if they may be in contact now.
  double time_to_contact = 0.0;
};

/// For one pair of a report that was made with the poses `now`. Pairs that the report does not list
/// are further apart than the alarm distance, and may be fast.
///
/// Method: a plane between the hulls of two elements, along the normal at the witness points. The
/// furthest reach of one hull along a tilting normal is followed to first order in time; the rest
/// is bounded (see PlaneBound). Where no such plane lies between them, the distance is divided by
/// the speed of the fastest point. Elements of the two models that are out of reach are no nearer
/// than the nearest, but may be faster: planes between their hulls. Cost: about twenty support
/// points of each hull for each pair of elements, 1 to 10 us.
ClosingMotion closingMotion(const CollisionScene& scene, const CollisionReport& report,
                            const PairReport& pair, const BodyPoses& now,
                            const EarlierPoses& before);

/// Of all pairs of a report.
struct ClosingReport {
  std::vector<ClosingMotion> pairs;  ///< as CollisionReport::pairs
  /// Seconds, 0 to ClosingMotion::HORIZON: the smallest of the pairs; 0 in contact, and where it is
  /// not known: the verdict is UNKNOWN, pairs that are near were not looked for, or the closing
  /// motion of one is not known.
  double time_to_contact = 0.0;
  bool time_to_contact_is_known = false;
};

/// For a report that was made with the poses `now`. `looks_for_near_pairs`: its alarm distance was
/// not 0.
ClosingReport closingReport(const CollisionScene& scene, const CollisionReport& report,
                            bool looks_for_near_pairs, const BodyPoses& now,
                            const EarlierPoses& before);

}  // namespace collision_pairs
