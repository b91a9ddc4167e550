#include "transform_input.h"

#include <cstdio>

#include <ros/console.h>

#include "geometry_conversions.h"

namespace collision_pairs {
namespace {

const ros::WallDuration REFUSAL_SHOWN(2.0);
constexpr std::size_t MAX_REFUSALS = 1000;  // frames: names come from outside
constexpr std::uint32_t QUEUE_SIZE = 100;   // messages, as tf2_ros has it

std::string seconds(const ros::Duration& duration) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f s", duration.toSec());
  return text;
}

}  // namespace

void TransformInput::subscribe(const ros::NodeHandle& node) {
  ros::NodeHandle own_queue(node);
  own_queue.setCallbackQueue(&queue_);
  const auto subscribe_to = [&](const char* topic, bool is_static) {
    const boost::function<void(const tf2_msgs::TFMessageConstPtr&)> callback =
        [this, is_static](const tf2_msgs::TFMessageConstPtr& message) {
          take(*message, is_static, ros::Time::now());
        };
    return own_queue.subscribe<tf2_msgs::TFMessage>(
        topic, QUEUE_SIZE, callback, ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  };
  subscriber_ = subscribe_to("/tf", false);
  static_subscriber_ = subscribe_to("/tf_static", true);
  spinner_ = std::make_unique<ros::AsyncSpinner>(1, &queue_);
  spinner_->start();
}

void TransformInput::take(const tf2_msgs::TFMessage& message, bool is_static,
                          const ros::Time& now) {
  followClock(now);
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const auto& transform : message.transforms) {
    const std::string why = whyRefused(transform, is_static, now);
    if (why.empty()) {
      refusals_.erase(transform.child_frame_id);
    } else if (refusals_.size() < MAX_REFUSALS || refusals_.count(transform.child_frame_id) > 0) {
      refusals_[transform.child_frame_id] = {why, ros::SteadyTime::now()};
    }
  }
}

std::string TransformInput::whyRefused(const geometry_msgs::TransformStamped& transform,
                                       bool is_static, const ros::Time& now) {
  Eigen::Isometry3d X;
  if (!toIsometry(transform.transform, X)) {
    return "it is not finite, or its quaternion is not of length 1";
  }
  const ros::Time& stamp = transform.header.stamp;
  if (!is_static && stamp.isZero()) return "its stamp is zero";
  if (!is_static && now.isZero()) return "the clock does not run yet";
  if (!is_static && stamp > now && (stamp - now).toSec() > clock_tolerance_) {
    return "its stamp is " + seconds(stamp - now) + " ahead of the clock";
  }
  if (buffer_.setTransform(transform, "collision_pairs", is_static)) return "";
  return "tf2 refuses it: its stamp is older than what is kept, or its frame names are unusable";
}

void TransformInput::followClock(const ros::Time& now) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (now < last_now_) {
    ROS_INFO_STREAM("the clock went back to " << now << " s: starting afresh");
    buffer_.clear();  // static transforms stay
    refusals_.clear();
    ++nb_clock_jumps_;
  }
  last_now_ = now;
}

unsigned TransformInput::nbClockJumps() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return nb_clock_jumps_;
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
