// Whether the ROS master still knows this node.
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace collision_pairs {

/// roscpp registers a node once. A restarted master does not know it, so no new client can
/// subscribe to it or call it, although it runs. This asks the master every two seconds, on a
/// thread of its own, and asks ROS to shut down where it answers that it has no such node. While
/// the master does not answer, connections go on, and so does the node.
class MasterWatch {
 public:
  /// After the node has advertised its services.
  MasterWatch();
  ~MasterWatch();

  /// It has asked for the shutdown.
  bool isForgotten() const { return is_forgotten_; }

 private:
  void run();

  std::atomic<bool> is_forgotten_{false};
  std::mutex mutex_;  // guards ends_
  std::condition_variable ending_;
  bool ends_ = false;
  std::thread thread_;  // last: it uses the others
};

}  // namespace collision_pairs
