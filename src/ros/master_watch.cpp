#include "master_watch.h"

#include <chrono>
#include <string>

#include <ros/console.h>
#include <ros/init.h>
#include <ros/master.h>
#include <ros/names.h>
#include <ros/this_node.h>

namespace collision_pairs {
namespace {

constexpr std::chrono::seconds PERIOD{2};

enum class Answer { KNOWN, NOT_KNOWN, NONE };

// The service is registered early, so a restart of the master during the start of the node is
// noticed too. http://wiki.ros.org/ROS/Master_API: for an unknown service lookupService returns
// [-1, message, value].
Answer askMaster() {
  XmlRpc::XmlRpcValue question, answer, payload;
  question[0] = ros::this_node::getName();
  question[1] = ros::names::resolve("~update_scene");
  const bool wait_for_master = false;
  if (ros::master::execute("lookupService", question, answer, payload, wait_for_master)) {
    return Answer::KNOWN;
  }
  return answer.valid() && answer.getType() == XmlRpc::XmlRpcValue::TypeArray ? Answer::NOT_KNOWN
                                                                              : Answer::NONE;
}

}  // namespace

MasterWatch::MasterWatch() : thread_([this] { run(); }) {}

MasterWatch::~MasterWatch() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ends_ = true;
  }
  ending_.notify_all();
  thread_.join();
}

void MasterWatch::run() {
  std::unique_lock<std::mutex> lock(mutex_);
  bool answers = true;
  while (!ending_.wait_for(lock, PERIOD, [this] { return ends_; })) {
    lock.unlock();
    const Answer answer = askMaster();
    lock.lock();
    if (answers && answer == Answer::NONE) {
      ROS_WARN("the ROS master does not answer; existing connections continue");
    }
    answers = answer != Answer::NONE;
    if (answer == Answer::NOT_KNOWN && ros::ok()) {
      ROS_FATAL(
          "the ROS master was restarted and does not know this node. A ROS 1 node registers only "
          "once, "
          "so this one exits; restart it (respawn:=true of collision_pairs.launch does so)");
      is_forgotten_ = true;
      ros::requestShutdown();
      return;
    }
  }
}

}  // namespace collision_pairs
