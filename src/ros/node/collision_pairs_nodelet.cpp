// The node in a nodelet manager: point clouds of a camera driver in the same process arrive without
// a copy.
#include <exception>
#include <memory>
#include <thread>

#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.hpp>

#include "collision_pairs_node.h"

namespace collision_pairs {

/// The node on threads of its own: neither it nor the manager's other nodelets wait for each other.
/// Its MasterWatch is missing: whether the process ends with its master is the manager's to decide.
class CollisionPairsNodelet : public nodelet::Nodelet {
 public:
  ~CollisionPairsNodelet() override {
    if (node_) node_->stop();
    if (thread_.joinable()) thread_.join();
  }

 private:
  /// Of what it throws the manager says that it failed, and not why.
  void onInit() override {
    try {
      begin();
    } catch (const std::exception& error) {
      ROS_FATAL_STREAM("cannot start " << getName() << ": " << error.what());
      throw;
    }
  }

  void begin() {
    ros::NodeHandle node = getNodeHandle(), private_node = getPrivateNodeHandle();
    node.setCallbackQueue(&queue_);
    private_node.setCallbackQueue(&queue_);
    beginConfigured(private_node, getMyArgv());
    node_ = std::make_unique<CollisionPairsNode>(node, private_node, queue_);
    thread_ = std::thread([this] { run(); });
  }

  /// An exception that left the thread would end the manager, and all nodelets in it.
  void run() {
    for (bool goes_on = true; goes_on;) {
      try {
        node_->run();
        goes_on = false;
      } catch (const std::exception& error) {
        ROS_ERROR_STREAM("collision_pairs failed, and begins anew: " << error.what());
        ros::WallDuration(1.0).sleep();
      }
    }
  }

  ros::CallbackQueue queue_;
  std::unique_ptr<CollisionPairsNode> node_;
  std::thread thread_;
};

}  // namespace collision_pairs

PLUGINLIB_EXPORT_CLASS(collision_pairs::CollisionPairsNodelet, nodelet::Nodelet)
