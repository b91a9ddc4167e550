// The monitor, fed from topics.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>

#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>

#include "monitor.h"

namespace collision_pairs {

/// A Monitor that several threads use: at any time one of them, which reads the clock first, so
/// that its time never goes back because a thread was late.
class LiveMonitor {
 public:
  explicit LiveMonitor(const PoseLimits& limits = {}, bool allow_paused = false)
      : monitor_({limits, ros::Time::isSimTime(), allow_paused}) {}

  /// Receives /tf and /tf_static from now on, on a separate thread, which then calls `taken`, if
  /// given, after each message.
  void subscribe(const ros::NodeHandle& node, const std::function<void()>& taken = {});

  /// Calls use(monitor) at the present time, and returns what that returns. Nothing that takes long
  /// belongs there.
  template <class Use>
  auto with(const Use& use) {
    Jump jump;  // before the lock, and destroyed after it
    const std::lock_guard<std::mutex> lock(mutex_);
    jump.to = advance();
    return use(monitor_);
  }
  /// Null while there is none.
  ActiveScenePtr activeScene() {
    return with([](Monitor& monitor) { return monitor.scenes().active(); });
  }

  /// Number of messages of transforms received.
  std::uint64_t nbTaken() const { return nb_taken_; }

 private:
  /// Says in the log that the clock went back; the log may block.
  struct Jump {
    ~Jump();
    ros::Time to;  ///< 0: it did not
  };
  ros::Time advance();

  std::atomic<std::uint64_t> nb_taken_{0};
  std::mutex mutex_;  // guards monitor_
  Monitor monitor_;

  ros::CallbackQueue queue_;
  ros::Subscriber subscriber_, static_subscriber_;
  std::unique_ptr<ros::AsyncSpinner> spinner_;  // last: stops before the others
};

}  // namespace collision_pairs
