#include "transform_input.h"

#include <algorithm>

#include <ros/console.h>
#include <tf2/exceptions.h>

#include "frame_names.h"
#include "geometry_conversions.h"
#include "stamps.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

const ros::WallDuration REFUSAL_SHOWN(2.0);
constexpr std::size_t MAX_REFUSALS = 1000;  // frames: a limit, since names are external input
constexpr std::uint32_t QUEUE_SIZE = 100;   // messages, as in tf2_ros
constexpr double OUT_OF_ORDER = 0.1;        // s between threads that read the clock
constexpr int DEEPEST_TREE = 1000;          // frames: tf2's limit, for cycles
const char* const BOTH_KINDS =
    "it is published both on /tf and on /tf_static, so its pose is ambiguous; stop one of the two "
    "publishers and restart this node";

}  // namespace

const char* const NO_CLOCK = "use_sim_time is set, but nothing was received on /clock";

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
  const std::lock_guard<std::mutex> lock(mutex_);
  followClockLocked(now);
  for (const auto& transform : message.transforms) {
    const std::string why = whyRefused(transform, is_static, now);
    if (why.empty()) {
      refusals_.erase(transform.child_frame_id);
    } else if (refusals_.size() < MAX_REFUSALS || refusals_.count(transform.child_frame_id) > 0) {
      refusals_[transform.child_frame_id] = {why, ros::SteadyTime::now()};
    }
  }
  ++nb_taken_;
}

std::string TransformInput::whyRefused(const geometry_msgs::TransformStamped& transform,
                                       bool is_static, const ros::Time& now) {
  Eigen::Isometry3d X;
  if (!toIsometry(transform.transform, X)) return whyNoIsometry(transform.transform);
  const ros::Time& stamp = transform.header.stamp;
  if (!is_static && stamp.isZero()) return "its stamp is zero";
  if (!is_static && now.isZero()) return NO_CLOCK;
  if (!is_static && secondsBetween(now, stamp) > clock_tolerance_) {
    return "its stamp is " + inWords(secondsBetween(now, stamp)) + " ahead of the clock";
  }
  Frame& frame = frames_[withoutLeadingSlash(transform.child_frame_id)];
  (is_static ? frame.is_static : frame.moves) = true;
  if (frame.is_static && frame.moves) {
    has_doubts_ = true;
    return BOTH_KINDS;
  }
  try {
    if (!buffer_.setTransform(transform, "collision_pairs", is_static)) {
      return "tf2 refuses it: its stamp is older than what is kept, or its frame names are "
             "unusable";
    }
  } catch (const std::exception& error) {  // thrown for sums beyond the largest stamp
    return std::string("tf2 refuses it: ") + error.what();
  }
  if (!is_static) noteStamp(frame, stamp);
  return "";
}

void TransformInput::noteStamp(Frame& frame, const ros::Time& stamp) {
  if (stamp <= frame.newest) return;
  if (!frame.newest.isZero() && secondsBetween(frame.newest, stamp) > max_gap_) {
    const double kept = buffer_.getCacheLength().toSec();
    const auto is_forgotten = [&](const Gap& gap) { return secondsBetween(gap.end, stamp) > kept; };
    frame.gaps.erase(std::remove_if(frame.gaps.begin(), frame.gaps.end(), is_forgotten),
                     frame.gaps.end());
    frame.gaps.push_back({frame.newest, stamp});
    has_doubts_ = true;
  }
  frame.newest = stamp;
}

std::string TransformInput::doubtOf(const std::string& frame, const ros::Time& stamp) const {
  const auto found = frames_.find(frame);
  if (found == frames_.end()) return "";
  if (found->second.is_static && found->second.moves) return BOTH_KINDS;
  for (const Gap& gap : found->second.gaps) {
    if (stamp <= gap.begin || stamp >= gap.end) continue;
    return "it was not received for " + inWords(secondsBetween(gap.begin, gap.end)) +
           " around that stamp";
  }
  return "";
}

std::vector<std::string> TransformInput::upFrom(std::string frame, const ros::Time& stamp) const {
  std::vector<std::string> frames = {frame};
  for (int i = 0; i < DEEPEST_TREE && buffer_._getParent(frame, stamp, frame); ++i) {
    frames.push_back(frame);
  }
  return frames;
}

void TransformInput::requireSound(const std::string& target, const std::string& source,
                                  const ros::Time& stamp) const {
  std::vector<std::string> from_source = upFrom(source, stamp), from_target = upFrom(target, stamp);
  while (!from_source.empty() && !from_target.empty() && from_source.back() == from_target.back()) {
    from_source.pop_back();
    from_target.pop_back();
  }
  from_source.insert(from_source.end(), from_target.begin(), from_target.end());
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const std::string& frame : from_source) {
    const std::string doubt = doubtOf(frame, stamp);
    if (!doubt.empty()) throw tf2::LookupException("transform of '" + frame + "': " + doubt);
  }
}

geometry_msgs::TransformStamped TransformInput::lookUp(const std::string& target,
                                                       const std::string& source,
                                                       const ros::Time& stamp) const {
  const auto found = buffer_.lookupTransform(target, source, stamp);
  if (has_doubts_) requireSound(target, source, found.header.stamp);
  return found;
}

void TransformInput::followClock(const ros::Time& now) {
  const std::lock_guard<std::mutex> lock(mutex_);
  followClockLocked(now);
}

void TransformInput::followClockLocked(const ros::Time& now) {
  if (now < last_now_) {
    if (secondsBetween(now, last_now_) <= OUT_OF_ORDER) return;
    ROS_INFO_STREAM("the clock went back to " << now << " s: earlier transforms are discarded");
    buffer_.clear();  // static transforms are kept
    refusals_.clear();
    for (auto& [name, frame] : frames_) {
      frame.newest = ros::Time();
      frame.gaps.clear();
    }
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
