// Receives /tf and /tf_static, and reads the clock that their stamps are compared with.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>
#include <tf2_msgs/TFMessage.h>

#include "robot_poses.h"
#include "transform_buffer.h"

namespace collision_pairs {

/// Message: no poses are known while ROS time is zero.
extern const char* const NO_CLOCK;

StampNs toNs(const ros::Time& stamp);
/// NEVER (static) becomes 0.
ros::Time toTime(StampNs stamp);

/// Seconds. ros::Duration throws beyond 68 years, and stamps may be anything.
inline double secondsBetween(const ros::Time& begin, const ros::Time& end) {
  return end.toSec() - begin.toSec();
}

/// A TransformBuffer fed from topics, with the names of the publishers, and a watch on the clock.
/// Thread safe: every call that reads the clock reads it under the lock.
class TransformInput {
 public:
  /// allow_paused: a simulated clock may stand still for longer than max_pose_age of wall time.
  explicit TransformInput(const PoseLimits& limits = {}, bool allow_paused = false)
      : limits_(limits), allow_paused_(allow_paused), buffer_(limits) {}

  /// Receives /tf and /tf_static from now on, on a separate thread, which then calls `taken`, if
  /// given, after each message.
  void subscribe(const ros::NodeHandle& node, const std::function<void()>& taken = {});

  const PoseLimits& limits() const { return limits_; }

  /// Calls `read` with the buffer, under the lock.
  template <class Read>
  auto with(const Read& read) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return read(buffer_);
  }

  struct Found {
    Eigen::Isometry3d X_TS;
    ros::Time stamp;  ///< 0: of static transforms only
  };
  /// Pose of `source` in `target` at that stamp; at 0 the newest, as of the clock at the last call
  /// that followed it. With a robot, of this buffer, also by its fixed joints. Throws InputError.
  Found lookUp(const std::string& target, const std::string& source, const ros::Time& stamp,
               const RobotPoses* robot = nullptr) const;

  /// Adds the valid transforms to the buffer. Stamps of static transforms are ignored.
  void take(const tf2_msgs::TFMessage& message, bool is_static, const ros::Time& now,
            const std::string& publisher = "");
  /// Number of messages received. If it changes, a look-up that failed may succeed.
  std::uint64_t nbTaken() const { return nb_taken_; }

  /// Returns the time. Call it before every look-up at the latest time. If the clock went back (a
  /// bag that loops, a simulation that restarts), all transforms except static ones are discarded.
  /// Steps back of 0.1 s or less are ignored: the clock of a computer that is being set.
  ros::Time followClock();
  void followClock(const ros::Time& now);
  unsigned nbClockJumps() const;
  /// Why the current poses may be of another time than it seems: a simulated clock stands still.
  /// Empty if it runs, or may pause.
  std::string clockDoubt() const;

  /// The frames whose transforms are being refused or are in doubt, with the reasons, sorted. A
  /// frame leaves the list with its next valid transform, or when nothing was wrong for 2 s.
  std::vector<std::string> refused() const;

 private:
  struct Refusal {
    std::string why;
    ros::SteadyTime when;
  };

  void takeLocked(const tf2_msgs::TFMessage& message, bool is_static, const ros::Time& now,
                  const std::string& publisher);
  void followClockLocked(const ros::Time& now);
  std::string takeOne(const geometry_msgs::TransformStamped& transform, bool is_static,
                      const ros::Time& now, const std::string& publisher);

  const PoseLimits limits_;
  const bool allow_paused_;
  std::atomic<std::uint64_t> nb_taken_{0};

  mutable std::mutex mutex_;  // guards what follows
  TransformBuffer buffer_;
  std::map<std::string, Refusal> refusals_;  // by child frame
  ros::Time last_now_;                       // the latest, but for a jump back
  ros::Time last_seen_;                      // of the clock, which may be set back a little
  ros::SteadyTime last_step_;                // when it was seen to move
  unsigned nb_clock_jumps_ = 0;

  ros::CallbackQueue queue_;
  ros::Subscriber subscriber_, static_subscriber_;
  std::unique_ptr<ros::AsyncSpinner> spinner_;  // last: stops before the others
};

}  // namespace collision_pairs
