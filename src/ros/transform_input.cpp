#include "transform_input.h"

#include <ros/console.h>

#include "geometry_conversions.h"
#include "robot_poses.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

const ros::WallDuration REFUSAL_SHOWN(2.0);
constexpr std::size_t MAX_REFUSALS = 1000;  // frames: a limit, since names are external input
constexpr std::uint32_t QUEUE_SIZE = 100;   // messages, as in tf2_ros
constexpr double SET_BACK = 0.1;            // s

}  // namespace

const char* const NO_CLOCK = "use_sim_time is set, but nothing was received on /clock";

StampNs toNs(const ros::Time& stamp) { return static_cast<StampNs>(stamp.toNSec()); }

ros::Time toTime(StampNs stamp) {
  ros::Time time;
  if (stamp != NEVER) time.fromNSec(static_cast<std::uint64_t>(stamp));
  return time;
}

void TransformInput::subscribe(const ros::NodeHandle& node, const std::function<void()>& taken) {
  using Event = ros::MessageEvent<const tf2_msgs::TFMessage>;
  ros::NodeHandle own_queue(node);
  own_queue.setCallbackQueue(&queue_);
  const auto subscribe_to = [&](const char* topic, bool is_static) {
    const boost::function<void(const Event&)> callback = [=](const Event& event) {
      {
        const std::lock_guard<std::mutex> lock(mutex_);
        takeLocked(*event.getConstMessage(), is_static, ros::Time::now(), event.getPublisherName());
      }
      if (taken) taken();
    };
    ros::SubscribeOptions options;
    options.initByFullCallbackType<const Event&>(topic, QUEUE_SIZE, callback);
    options.transport_hints = ros::TransportHints().tcpNoDelay();
    return own_queue.subscribe(options);
  };
  subscriber_ = subscribe_to("/tf", false);
  static_subscriber_ = subscribe_to("/tf_static", true);
  spinner_ = std::make_unique<ros::AsyncSpinner>(1, &queue_);
  spinner_->start();
}

void TransformInput::take(const tf2_msgs::TFMessage& message, bool is_static, const ros::Time& now,
                          const std::string& publisher) {
  const std::lock_guard<std::mutex> lock(mutex_);
  takeLocked(message, is_static, now, publisher);
}

void TransformInput::takeLocked(const tf2_msgs::TFMessage& message, bool is_static,
                                const ros::Time& now, const std::string& publisher) {
  followClockLocked(now);
  for (const auto& transform : message.transforms) {
    const std::string why = takeOne(transform, is_static, now, publisher);
    if (why.empty()) {
      refusals_.erase(transform.child_frame_id);
    } else if (refusals_.size() < MAX_REFUSALS || refusals_.count(transform.child_frame_id) > 0) {
      refusals_[transform.child_frame_id] = {why, ros::SteadyTime::now()};
    }
  }
  ++nb_taken_;
}

std::string TransformInput::takeOne(const geometry_msgs::TransformStamped& transform,
                                    bool is_static, const ros::Time& now,
                                    const std::string& publisher) {
  const auto& p = transform.transform.translation;
  const auto& q = transform.transform.rotation;
  const std::string why = whyNoIsometry(transform.transform);
  if (!why.empty()) return why;
  if (!is_static && now.isZero() && !transform.header.stamp.isZero()) return NO_CLOCK;
  return buffer_.take(
      {transform.header.frame_id, transform.child_frame_id, toNs(transform.header.stamp),
       Eigen::Vector3d(p.x, p.y, p.z), Eigen::Quaterniond(q.w, q.x, q.y, q.z)},
      is_static, publisher, toNs(now));
}

TransformInput::Found TransformInput::lookUp(const std::string& target, const std::string& source,
                                             const ros::Time& stamp,
                                             const RobotPoses* robot) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const Instant newest{Instant::NEWEST, toNs(last_now_)};
  const Instant instant = stamp.isZero() ? newest : Instant{Instant::AT, toNs(stamp)};
  const auto found = robot != nullptr ? robot->between(target, source, instant)
                                      : poseBetween(buffer_, target, source, instant);
  return {found.X_TS, toTime(found.oldest)};
}

ros::Time TransformInput::followClock() {
  const std::lock_guard<std::mutex> lock(mutex_);
  const ros::Time now = ros::Time::now();
  followClockLocked(now);
  return now;
}

void TransformInput::followClock(const ros::Time& now) {
  const std::lock_guard<std::mutex> lock(mutex_);
  followClockLocked(now);
}

void TransformInput::followClockLocked(const ros::Time& now) {
  if (now != last_seen_) last_step_ = ros::SteadyTime::now();
  last_seen_ = now;
  if (now < last_now_) {
    if (secondsBetween(now, last_now_) <= SET_BACK) return;
    ROS_INFO_STREAM("the clock went back to " << now << " s: earlier transforms are discarded");
    buffer_.restart(toNs(now));
    refusals_.clear();
    ++nb_clock_jumps_;
  }
  last_now_ = now;
}

unsigned TransformInput::nbClockJumps() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return nb_clock_jumps_;
}

std::string TransformInput::clockDoubt() const {
  if (allow_paused_ || limits_.max_pose_age == 0.0 || !ros::Time::isSimTime()) return "";
  const std::lock_guard<std::mutex> lock(mutex_);
  if (last_now_.isZero()) return "";  // then there is no pose at all
  const double still = (ros::SteadyTime::now() - last_step_).toSec();
  if (still <= limits_.max_pose_age) return "";
  return "use_sim_time is set, and /clock stands still since " + inWords(still) +
         " of wall time: transforms cannot be seen to age; if it may pause, set allow_paused";
}

std::vector<std::string> TransformInput::refused() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<std::string> lines;
  const ros::SteadyTime now = ros::SteadyTime::now();
  for (const auto& [frame, refusal] : refusals_) {
    if (now - refusal.when > REFUSAL_SHOWN) continue;
    lines.push_back("transform of '" + frame + "': " + refusal.why);
  }
  return lines;
}

}  // namespace collision_pairs
