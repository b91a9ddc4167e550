#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <thread>

#include <ros/ros.h>

#include "collision_pairs/input_error.h"
#include "collision_pairs_node.h"
#include "ros_master.h"

namespace {

constexpr std::chrono::seconds PERIOD{2};

enum class Answer { KNOWN, NOT_KNOWN, NONE };

// The service is registered early, so a restart of the master during the start of the node is
// noticed too.
Answer askForThisNode() {
  XmlRpc::XmlRpcValue uri;
  try {
    const bool is_known = collision_pairs::askMaster("lookupService", ros::this_node::getName(),
                                                     ros::names::resolve("~update_scene"), uri);
    return is_known ? Answer::KNOWN : Answer::NOT_KNOWN;
  } catch (const collision_pairs::InputError&) {
    return Answer::NONE;
  }
}

/// roscpp registers a node once. A restarted master does not know it, so no new client can
/// subscribe to it or call it, although it runs. This asks the master every two seconds, on a
/// separate thread, and requests a shutdown if the master does not know the node. If the master
/// does not answer, the node and its connections continue.
class MasterWatch {
 public:
  /// Construct it after the node has advertised its services.
  MasterWatch() : thread_([this] { run(); }) {}
  ~MasterWatch() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      ends_ = true;
    }
    ending_.notify_all();
    thread_.join();
  }

  /// True if it has requested the shutdown.
  bool isForgotten() const { return is_forgotten_; }

 private:
  void run() {
    std::unique_lock<std::mutex> lock(mutex_);
    bool answers = true;
    while (!ending_.wait_for(lock, PERIOD, [this] { return ends_; })) {
      lock.unlock();
      const Answer answer = askForThisNode();
      lock.lock();
      if (answers && answer == Answer::NONE) {
        ROS_WARN("the ROS master does not answer; existing connections continue");
      }
      answers = answer != Answer::NONE;
      // A node that is asked to end takes its services back before ros::ok() says so.
      if (answer == Answer::NOT_KNOWN && ros::ok() && !ros::isShuttingDown()) {
        ROS_FATAL(
            "the ROS master was restarted and does not know this node. A ROS 1 node registers only "
            "once, so this one exits. Start its launch file again: the parameters are gone, too");
        is_forgotten_ = true;
        ros::requestShutdown();
        return;
      }
    }
  }

  std::atomic<bool> is_forgotten_{false};
  std::mutex mutex_;  // guards ends_
  std::condition_variable ending_;
  bool ends_ = false;
  std::thread thread_;  // last: it uses the other members
};

// Does not wait for a mesh being read or a long trajectory; neither leaves partial results.
void endSoon(int status) {
  const std::chrono::seconds PATIENCE{2};
  std::thread([PATIENCE, status] {
    std::this_thread::sleep_for(PATIENCE);
    std::_Exit(status);
  }).detach();
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "collision_pairs_node");
  if (collision_pairs::isSecondNode()) return 1;
  const ros::NodeHandle keeps_log;  // the last one to go ends the log, and what follows is not said
  try {
    collision_pairs::beginConfigured(ros::NodeHandle("~"), {argv, argv + argc});
    collision_pairs::CollisionPairsNode node{ros::NodeHandle(), ros::NodeHandle("~"),
                                             *ros::getGlobalCallbackQueue()};
    const MasterWatch master;
    node.run();
    const int status = master.isForgotten() ? 1 : 0;
    endSoon(status);
    return status;
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM("cannot start: " << error.what());
    return 1;
  }
}
