#include "tf_check.h"

#include "conversions.h"

namespace collision_pairs {

std::vector<std::string> doubtsOf(const StampedPoses& stamped, const TransformInput& transforms) {
  constexpr std::size_t MAX_NAMED = 10;  // left_out names all links
  if (stamped.problems.empty()) return {};
  std::vector<std::string> doubts = stamped.problems;
  if (doubts.size() > MAX_NAMED) {
    const std::string rest = "and " + std::to_string(doubts.size() - MAX_NAMED) + " more links";
    doubts.resize(MAX_NAMED);
    doubts.push_back(rest);
  }
  const std::vector<std::string> refused = transforms.refused();
  for (std::size_t i = 0; i < std::min(refused.size(), MAX_NAMED); ++i) {
    doubts.push_back("refused " + refused[i]);
  }
  return doubts;
}

CollisionPairs checkPoses(const ActiveScene& scene, const StampedPoses& stamped,
                          const std::vector<std::string>& doubts, const CheckSettings& settings,
                          const ros::Time& now, double transform_time,
                          CollisionDetector& detector) {
  const CollisionReport& report = detector.detect(stamped.poses, settings);
  const ros::Time stamp = stamped.stamp.isZero() ? now : stamped.stamp;
  CollisionPairs message =
      toMessage(report, *scene.scene, settings, scene.frame, stamp, scene.broken_links);
  notFree(message, scene.doubts);
  notFree(message, doubts);
  message.time_transforms = transform_time;
  message.time_total += transform_time;
  return message;
}

}  // namespace collision_pairs
