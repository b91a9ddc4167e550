#include <exception>

#include <ros/ros.h>

#include "collision_pairs_node.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "collision_pairs_node");
  try {
    collision_pairs::CollisionPairsNode node{ros::NodeHandle(), ros::NodeHandle("~")};
    node.run();
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM("cannot start: " << error.what());
    return 1;
  }
  return 0;
}
