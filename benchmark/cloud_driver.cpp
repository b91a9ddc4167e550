// Stands for a camera's driver: passes each cloud of camera/seen on as camera/points, in the
// process that also holds the node if the argument is "nodelet".
#include <string>

#include <nodelet/loader.h>
#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>

int main(int argc, char** argv) {
  ros::init(argc, argv, "cloud_driver");
  ros::NodeHandle node;
  const auto publisher = node.advertise<sensor_msgs::PointCloud2>("camera/points", 1);
  const boost::function<void(const sensor_msgs::PointCloud2ConstPtr&)> pass =
      [&](const sensor_msgs::PointCloud2ConstPtr& cloud) { publisher.publish(cloud); };
  const auto subscriber = node.subscribe<sensor_msgs::PointCloud2>(
      "camera/seen", 1, pass, nullptr, ros::TransportHints().tcpNoDelay());
  nodelet::Loader loader(false);
  if (argc > 1 && std::string(argv[1]) == "nodelet" &&
      !loader.load("/collision_pairs_node", "collision_pairs/CollisionPairsNodelet", {}, {})) {
    return 1;
  }
  ros::spin();
  return 0;
}
