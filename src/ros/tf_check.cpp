#include "tf_check.h"

#include "collision_pairs/closing_motion.h"
#include "conversions.h"

namespace collision_pairs {
namespace {

// Seconds. A shorter window is more recent, a longer one averages more encoder noise; TF
// interpolates if its rate is lower.
constexpr double VELOCITY_WINDOW = 0.1;

/// Earlier poses of the bodies in the pairs, VELOCITY_WINDOW before.
EarlierPoses posesBefore(const ActiveScene& active, const StampedPoses& stamped,
                         const CollisionReport& report) {
  EarlierPoses before;
  before.window = VELOCITY_WINDOW;
  if (stamped.stamp.isZero()) {  // of static transforms only
    before.poses = stamped.poses;
    return before;
  }
  std::vector<char> wanted(stamped.poses.known.size(), 0);
  for (const PairReport& pair : report.pairs) {
    for (const std::uint32_t model : {pair.first, pair.second}) {
      const int body = active.scene->models()[model].body;
      if (body >= 0) wanted[body] = 1;
    }
  }
  const double then = stamped.stamp.toSec() - VELOCITY_WINDOW;
  if (then > 0.0) {
    before.poses = active.tf_poses->at(stamped.stamp - ros::Duration(VELOCITY_WINDOW), wanted);
  } else {
    before.poses.known.assign(wanted.size(), 0);
  }
  return before;
}

}  // namespace

std::vector<std::string> doubtsOf(const StampedPoses& stamped, const TransformInput& transforms,
                                  const ros::Time& now) {
  constexpr std::size_t MAX_NAMED = 10;  // left_out names all links
  std::vector<std::string> doubts;
  const std::string clock = transforms.clockDoubt();
  if (!clock.empty()) doubts.push_back(clock);
  doubts.insert(doubts.end(), stamped.problems.begin(), stamped.problems.end());
  if (doubts.size() > MAX_NAMED) {
    const std::string rest = "and " + std::to_string(doubts.size() - MAX_NAMED) + " more links";
    doubts.resize(MAX_NAMED);
    doubts.push_back(rest);
  }
  if (now.isZero()) doubts.insert(doubts.begin(), NO_CLOCK);
  if (stamped.problems.empty()) return doubts;
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
  notFree(message, doubts);
  message.time_transforms = transform_time;
  message.time_total += transform_time;
  return message;
}

void addClosingMotion(const ActiveScene& scene, const StampedPoses& stamped,
                      const CollisionReport& report, CollisionPairs& message) {
  const ros::WallTime start = ros::WallTime::now();
  const bool looks_for_near_pairs = message.alarm_distance > 0.0;
  bool is_known = message.verdict != CollisionPairs::UNKNOWN;
  double time = looks_for_near_pairs ? ClosingMotion::HORIZON : 0.0;
  if (!report.pairs.empty()) {
    const EarlierPoses before = posesBefore(scene, stamped, report);
    for (std::size_t i = 0; i < report.pairs.size(); ++i) {
      const ClosingMotion closing =
          closingMotion(*scene.scene, report, report.pairs[i], stamped.poses, before);
      message.pairs[i].closing_speed = closing.closing_speed;
      message.pairs[i].closing_speed_is_known = closing.known;
      is_known &= closing.known;
      time = std::min(time, closing.time_to_contact);
    }
  }
  const bool is_contact = message.verdict == CollisionPairs::COLLISION;
  message.time_to_contact_is_known = is_contact || (is_known && looks_for_near_pairs);
  message.time_to_contact = is_contact || !message.time_to_contact_is_known ? 0.0 : time;
  message.time_total += (ros::WallTime::now() - start).toSec();
}

}  // namespace collision_pairs
