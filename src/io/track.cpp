#include "track.h"

#include <cmath>

#include "user_text.h"

namespace collision_pairs {
namespace {

constexpr double KEPT = 10.0;  // s of history, as in tf2

StampNs nanoseconds(double seconds) {
  return seconds < 9e9 ? static_cast<StampNs>(std::llround(1e9 * seconds)) : NEVER;
}

}  // namespace

TrackLimits::TrackLimits(const PoseLimits& limits, bool keeps_all)
    : max_age(limits.max_pose_age == 0.0 ? NEVER : nanoseconds(limits.max_pose_age)),
      max_gap(nanoseconds(limits.max_transform_age)),
      tolerance(nanoseconds(limits.clock_tolerance)),
      kept(keeps_all ? NEVER : nanoseconds(KEPT)) {}

std::string whyRefused(StampNs stamp, StampNs now, const TrackLimits& limits) {
  if (stamp == 0) return "its stamp is zero";
  if (stamp - now > limits.tolerance) {
    return "its stamp is " + inWords(inSeconds(stamp - now)) + " ahead of the clock";
  }
  if (now - stamp > limits.max_age) {
    return "it was " + inWords(inSeconds(now - stamp)) +
           " old when it arrived, and max_pose_age is " + inWords(inSeconds(limits.max_age));
  }
  return "";
}

}  // namespace collision_pairs
