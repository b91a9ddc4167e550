// TF as the node takes it: what cannot be right never reaches the buffer.
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

/// Why nothing is known while ROS time is zero.
extern const char* const NO_CLOCK;

/// Fills a tf2 buffer, as tf2_ros::TransformListener does, but refuses transforms that would spoil
/// it. tf2 itself takes a stamp from the future, then drops every present transform as too old
/// until the clock has come there; it takes a stamp of zero, which afterwards reads as "static"; it
/// takes for static for ever what was so once, whoever moves it since; and it interpolates over any
/// gap.
///
/// May be used from several threads.
class TransformInput {
 public:
  /// clock_tolerance [s]: how far a stamp may lie ahead of now, because clocks of computers differ.
  /// max_gap [s]: between two stamps of a frame further apart than this nothing is known.
  explicit TransformInput(double clock_tolerance, double max_gap = 1.0)
      : clock_tolerance_(clock_tolerance), max_gap_(max_gap) {}

  /// Takes what arrives on /tf and /tf_static from now on, on a thread of its own.
  void subscribe(const ros::NodeHandle& node);

  double clockTolerance() const { return clock_tolerance_; }  ///< s
  const tf2::BufferCore& buffer() const { return buffer_; }

  /// As lookupTransform() of tf2, but throws tf2::TransformException also where the way from source
  /// to target leads over a frame that comes both as static and as moving (which of the two holds
  /// cannot be told), or that was silent for longer than max_gap at that instant.
  geometry_msgs::TransformStamped lookUp(const std::string& target, const std::string& source,
                                         const ros::Time& stamp) const;

  /// Puts into the buffer what is sound. Of static transforms the stamp does not matter.
  void take(const tf2_msgs::TFMessage& message, bool is_static, const ros::Time& now);
  /// How many messages were taken: what was not known may be so when it changes.
  std::uint64_t nbTaken() const { return nb_taken_; }

  /// To be called before every look-up at the latest time. When the clock went back (a bag that
  /// loops, a simulation that begins again) all that is not static is forgotten: it is of another
  /// pass. Going back by 0.1 s or less is none: threads that read the clock come here in any order.
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

  struct Gap {
    ros::Time begin, end;  // two stamps that follow each other
  };

  /// What came of one child frame.
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
  std::atomic<bool> has_doubts_{false};  // spares those who look up the lock
  std::atomic<std::uint64_t> nb_taken_{0};

  mutable std::mutex mutex_;                 // guards what follows
  std::map<std::string, Refusal> refusals_;  // by child frame
  std::map<std::string, Frame> frames_;      // by child frame, without a leading slash
  ros::Time last_now_;
  unsigned nb_clock_jumps_ = 0;

  ros::CallbackQueue queue_;
  ros::Subscriber subscriber_, static_subscriber_;
  std::unique_ptr<ros::AsyncSpinner> spinner_;  // last: stops before what it calls into goes
};

}  // namespace collision_pairs
