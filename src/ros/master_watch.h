// Detects that the ROS master was restarted and has lost this node.
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace collision_pairs {

/// roscpp registers a node once. A restarted master does not know it, so no new client can
/// subscribe to it or call it, although it runs. This asks the master every two seconds, on a
/// separate thread, and requests a shutdown if the master does not know the node. If the master
/// does not answer, the node and its connections continue.
class MasterWatch {
 public:
  /// Construct it after the node has advertised its services.
  MasterWatch();
  ~MasterWatch();

  /// True if it has requested the shutdown.
  bool isForgotten() const { return is_forgotten_; }

 private:
  void run();

  std::atomic<bool> is_forgotten_{false};
  std::mutex mutex_;  // guards ends_
  std::condition_variable ending_;
  bool ends_ = false;
  std::thread thread_;  // last: it uses the other members
};

}  // namespace collision_pairs
