#include "transform_input.h"

#include "geometry_conversions.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

constexpr double REFUSAL_SHOWN = 2.0;       // s
constexpr std::size_t MAX_REFUSALS = 1000;  // frames: a limit, since names are external input
constexpr double SET_BACK = 0.1;            // s
constexpr double NEW_RUN = 5.0;             // s

}  // namespace

const char* const NO_CLOCK = "use_sim_time is set, but nothing was received on /clock";

StampNs toNs(const ros::Time& stamp) { return static_cast<StampNs>(stamp.toNSec()); }

ros::Time toTime(StampNs stamp) {
  ros::Time time;
  if (stamp != NEVER) time.fromNSec(static_cast<std::uint64_t>(stamp));
  return time;
}

void TransformInput::followClock(const Now& now) {
  now_.steady = now.steady;
  const double back = secondsBetween(now.stamp, now_.stamp);
  if (now.stamp == now_.stamp || (back > 0.0 && back <= SET_BACK)) return;
  now_.stamp = now.stamp;
  last_step_ = now.steady;
  if (back <= 0.0) return;
  buffer_.restart(toNs(now.stamp));
  refusals_.clear();
  ++nb_clock_jumps_;
  is_new_run_ = settings_.is_simulated && back > NEW_RUN;
}

std::string TransformInput::clockProblem() const {
  if (settings_.allow_paused || limits().max_pose_age == 0.0 || !settings_.is_simulated) return "";
  if (now_.stamp.isZero()) return "";  // then there is no pose at all
  const double still = now_.steady - last_step_;
  if (still <= limits().max_pose_age) return "";
  return "use_sim_time is set, and /clock stands still since " + inWords(still) +
         " of wall time: transforms cannot be seen to age; if it may pause, set allow_paused";
}

void TransformInput::take(const tf2_msgs::TFMessage& message, bool is_static, const Now& now,
                          const std::string& publisher) {
  followClock(now);
  for (const auto& transform : message.transforms) {
    const std::string why = takeOne(transform, is_static, publisher);
    if (!why.empty() && nb_refused_++ == 0) {
      first_refused_ = "transform of '" + transform.child_frame_id + "': " + why;
    }
    if (why.empty()) {
      refusals_.erase(transform.child_frame_id);
    } else if (refusals_.size() < MAX_REFUSALS || refusals_.count(transform.child_frame_id) > 0) {
      refusals_[transform.child_frame_id] = {why, now_.steady};
    }
  }
  ++nb_taken_;
}

std::string TransformInput::takeOne(const geometry_msgs::TransformStamped& transform,
                                    bool is_static, const std::string& publisher) {
  const auto& p = transform.transform.translation;
  const auto& q = transform.transform.rotation;
  const std::string why = whyNoIsometry(transform.transform);
  if (!why.empty()) return why;
  if (!is_static && now_.stamp.isZero() && !transform.header.stamp.isZero()) return NO_CLOCK;
  return buffer_.take(
      {transform.header.frame_id, transform.child_frame_id, toNs(transform.header.stamp),
       Eigen::Vector3d(p.x, p.y, p.z), Eigen::Quaterniond(q.w, q.x, q.y, q.z)},
      is_static, publisher, toNs(now_.stamp));
}

std::vector<std::string> TransformInput::refused() const {
  std::vector<std::string> lines;
  for (const auto& [frame, refusal] : refusals_) {
    if (now_.steady - refusal.when > REFUSAL_SHOWN) continue;
    lines.push_back("transform of '" + frame + "': " + refusal.why);
  }
  return lines;
}

TransformInput::Found TransformInput::lookUp(const std::string& target, const std::string& source,
                                             const ros::Time& stamp,
                                             const RobotPoses* robot) const {
  const Instant newest{Instant::NEWEST, toNs(now_.stamp)};
  const Instant instant = stamp.isZero() ? newest : Instant{Instant::AT, toNs(stamp)};
  const auto found = robot != nullptr ? robot->between(target, source, instant)
                                      : poseBetween(buffer_, target, source, instant);
  return {found.X_TS, toTime(found.oldest)};
}

}  // namespace collision_pairs
