#include "snapshot_check.h"

#include <optional>

#include "conversions.h"

namespace collision_pairs {

CollisionPairs toMessage(const CollisionReport& report, const Snapshot& snapshot,
                         const CheckSettings& settings, const ClosingReport* closing) {
  const ActiveScene& active = *snapshot.scene;
  return toMessage(report, *active.scene, settings, active.frame, snapshot.stamp, closing);
}

CollisionPairs checkedMessage(LiveMonitor& monitor, const Snapshot& snapshot,
                              const CheckSettings& settings, double transform_time,
                              CollisionDetector& detector) {
  const CollisionReport& report = detector.detect(snapshot.poses, settings);
  const ros::WallTime start = ros::WallTime::now();
  std::optional<ClosingReport> closing;
  if (!snapshot.joints) {
    EarlierPoses before;
    if (!report.pairs.empty()) {
      before = monitor.with([&](const Monitor& m) { return m.before(snapshot, report); });
    }
    const bool looks_for_near_pairs = !settings.verdict_only && settings.alarm_distance > 0.0;
    closing =
        closingReport(*snapshot.scene->scene, report, looks_for_near_pairs, snapshot.poses, before);
  }
  CollisionPairs message = toMessage(report, snapshot, settings, closing ? &*closing : nullptr);
  message.time_transforms = transform_time;
  message.time_total += transform_time + (ros::WallTime::now() - start).toSec();
  return message;
}

}  // namespace collision_pairs
