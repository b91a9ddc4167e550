// TF as the node takes it: what cannot be right never reaches the buffer.
#pragma once

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

/// Fills a tf2 buffer, as tf2_ros::TransformListener does, but refuses transforms that would spoil
/// it. tf2 itself takes a stamp from the future, then drops every present transform as too old
/// until the clock has come there; and it takes a stamp of zero, which afterwards reads as
/// "static".
///
/// May be used from several threads.
class TransformInput {
 public:
  /// clock_tolerance [s]: how far a stamp may lie ahead of now, because clocks of computers differ.
  explicit TransformInput(double clock_tolerance) : clock_tolerance_(clock_tolerance) {}

  /// Takes what arrives on /tf and /tf_static from now on, on a thread of its own.
  void subscribe(const ros::NodeHandle& node);

  const tf2::BufferCore& buffer() const { return buffer_; }

  /// Puts into the buffer what is sound. Of static transforms the stamp does not matter.
  void take(const tf2_msgs::TFMessage& message, bool is_static, const ros::Time& now);

  /// To be called once a cycle. When the clock went back (a bag that loops, a simulation that
  /// begins again) all that is not static is forgotten: it is of another pass.
  void followClock(const ros::Time& now);
  unsigned nbClockJumps() const;

  /// The frames whose transforms are refused at present, each with the reason, sorted. A frame
  /// leaves the list with its next sound transform, or when nothing of it was refused for 2 s.
  std::vector<std::string> refused() const;

 private:
  struct Refusal {
    std::string why;
    ros::SteadyTime when;
  };

  std::string whyRefused(const geometry_msgs::TransformStamped& transform, bool is_static,
                         const ros::Time& now);

  const double clock_tolerance_;
  tf2::BufferCore buffer_;

  mutable std::mutex mutex_;                 // guards what follows
  std::map<std::string, Refusal> refusals_;  // by child frame
  ros::Time last_now_;
  unsigned nb_clock_jumps_ = 0;

  ros::CallbackQueue queue_;
  ros::Subscriber subscriber_, static_subscriber_;
  std::unique_ptr<ros::AsyncSpinner> spinner_;  // last: stops before what it calls into goes
};

}  // namespace collision_pairs
