#include <chrono>
#include <cstdlib>
#include <exception>
#include <thread>

#include <ros/ros.h>

#include "collision_pairs_node.h"
#include "master_watch.h"

namespace {

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
  try {
    collision_pairs::CollisionPairsNode node{ros::NodeHandle(), ros::NodeHandle("~"),
                                             *ros::getGlobalCallbackQueue()};
    const collision_pairs::MasterWatch master;
    node.run();
    const int status = master.isForgotten() ? 1 : 0;
    endSoon(status);
    return status;
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM("cannot start: " << error.what());
    return 1;
  }
}
