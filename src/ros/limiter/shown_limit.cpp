#include "shown_limit.h"

namespace collision_pairs {

ShownLimit shownLimit(const SpeedLimit& limit, CollisionDetector& detector, const BodyPoses& poses,
                      Fidelity fidelity) {
  ShownLimit shown{limit, {}};
  const int first = detector.scene().findModel(limit.first_link);
  const int second = detector.scene().findModel(limit.second_link);
  if (first < 0 || second < 0) return shown;
  CheckSettings settings;
  settings.alarm_distance = 1.0;
  settings.fidelity = fidelity;
  detector.beginNarrowPhase(poses, settings);
  detector.addCollisionPair(static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(second));
  const CollisionReport& report = detector.endNarrowPhase();
  if (report.pairs.empty()) return shown;
  const Contact* nearest = report.nearestContact(report.pairs.front());
  if (nearest) shown.nearest = *nearest;
  return shown;
}

}  // namespace collision_pairs
