// Validated TF input: invalid transforms never reach the buffer.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>
#include <tf2/buffer_core.h>
#include <tf2_msgs/TFMessage.h>

namespace collision_pairs {

/// Message: no poses are known while ROS time is zero.
extern const char* const NO_CLOCK;

/// Fills a tf2 buffer, like tf2_ros::TransformListener, but refuses transforms that would corrupt
/// it. tf2 itself accepts a stamp from the future, and then drops current transforms as too old
/// until the clock has reached it; it accepts a stamp of zero, which then means "static"; a frame
/// that was static once stays static, even if it is published on /tf later; and it interpolates
/// over any gap.
///
/// Thread safe.
class TransformInput {
 public:
  /// clock_tolerance [s]: how far a stamp may lie ahead of now, because clocks of computers differ.
  /// max_gap [s]: between two stamps of a frame further apart than this the pose is unknown.
  explicit TransformInput(double clock_tolerance, double max_gap = 1.0)
      : clock_tolerance_(clock_tolerance), max_gap_(max_gap) {}

  /// Receives /tf and /tf_static from now on, on a separate thread.
  void subscribe(const ros::NodeHandle& node);

  double clockTolerance() const { return clock_tolerance_; }  ///< s
  const tf2::BufferCore& buffer() const { return buffer_; }

  /// Like lookupTransform() of tf2, but also throws tf2::TransformException if the path from source
  /// to target contains a frame that is published both as static and as moving, or that was silent
  /// for longer than max_gap at that stamp.
  geometry_msgs::TransformStamped lookUp(const std::string& target, const std::string& source,
                                         const ros::Time& stamp) const;

  /// Adds the valid transforms to the buffer. Stamps of static transforms are ignored.
  void take(const tf2_msgs::TFMessage& message, bool is_static, const ros::Time& now);
  /// Number of messages received. If it changes, a look-up that failed may succeed.
  std::uint64_t nbTaken() const { return nb_taken_; }

  /// Call it before every look-up at the latest time. If the clock went back (a bag that loops, a
  /// simulation that restarts), all transforms except static ones are discarded. Steps back of 0.1
  /// s or less are ignored, since threads that read the clock call this in any order.
  void followClock(const ros::Time& now);
  unsigned nbClockJumps() const;

  /// The frames whose transforms are being refused, with the reasons, sorted. A frame leaves the
  /// list with its next valid transform, or when none of it was refused for 2 s.
  std::vector<std::string> refused() const;

 private:
  struct Refusal {
    std::string why;
    ros::SteadyTime when;
  };

  struct Gap {
    ros::Time begin, end;  // two stamps that follow each other
  };

  /// What was received for one child frame.
  struct Frame {
    bool is_static = false, moves = false;
    ros::Time newest;       // where it moves
    std::vector<Gap> gaps;  // longer than max_gap_, as far back as tf2 remembers
  };

  void followClockLocked(const ros::Time& now);
  std::string whyRefused(const geometry_msgs::TransformStamped& transform, bool is_static,
                         const ros::Time& now);
  void noteStamp(Frame& frame, const ros::Time& stamp);
  std::string doubtOf(const std::string& frame, const ros::Time& stamp) const;
  std::vector<std::string> upFrom(std::string frame, const ros::Time& stamp) const;
  void requireSound(const std::string& target, const std::string& source,
                    const ros::Time& stamp) const;

  const double clock_tolerance_, max_gap_;
  tf2::BufferCore buffer_;
  std::atomic<bool> has_doubts_{false};  // lets look-ups skip the lock
  std::atomic<std::uint64_t> nb_taken_{0};

  mutable std::mutex mutex_;                 // guards what follows
  std::map<std::string, Refusal> refusals_;  // by child frame
  std::map<std::string, Frame> frames_;      // by child frame, without a leading slash
  ros::Time last_now_;
  unsigned nb_clock_jumps_ = 0;

  ros::CallbackQueue queue_;
  ros::Subscriber subscriber_, static_subscriber_;
  std::unique_ptr<ros::AsyncSpinner> spinner_;  // last: stops before the others
};

}  // namespace collision_pairs
