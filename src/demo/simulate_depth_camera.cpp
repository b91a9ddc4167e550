// A depth camera that looks at the robot of robot_description where TF has it, at a ball that
// passes back and forth, and at a parcel on the table: what a real one would publish, the robot
// itself included. For the demo, tests and measurements.
//
// Publishes sensor_msgs/PointCloud2 on points (organised, NaN where nothing is seen), and the
// camera's static transform. Parameters (private), metres, seconds and pixels: below.
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>
#include <sensor_msgs/point_cloud2_iterator.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include "collision_pairs/input_error.h"
#include "collision_pairs/mesh_loader.h"
#include "depth_image.h"
#include "geometry_conversions.h"
#include "live_monitor.h"
#include "tf_poses.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr int WIDTH = 320, HEIGHT = 240;
constexpr double RATE = 15.0;    // Hz
constexpr double NOISE = 0.003;  // standard deviation of the depth
constexpr double VIEW = 1.0;     // rad, of the width of the image
constexpr double BALL_RADIUS = 0.09;
constexpr char FRAME[] = "depth_camera";
const Vector3d CAMERA(1.5, -1.1, 1.75), LOOKS_AT(0.3, 0.0, 1.1), BALL_TO(0.42, 0.9, 1.45);

struct Settings {
  std::vector<double> ball_from = {0.42, -0.9, 1.45};
  double ball_period = 10.0;  // there and back; 0: it stays where it begins

  explicit Settings(const ros::NodeHandle& node) {
    node.getParam("ball_from", ball_from);
    node.getParam("ball_period", ball_period);
    if (ball_from.size() != 3) throw InputError("ball_from has three coordinates");
  }
};

/// Pose in W of an optical frame that looks from one place to another, its y down.
Isometry3d lookingAt(const Vector3d& from, const Vector3d& to) {
  Isometry3d X_WC = Isometry3d::Identity();
  const Vector3d forward = (to - from).normalized();
  const Vector3d right = forward.cross(Vector3d::UnitZ()).normalized();
  X_WC.linear().col(0) = right;
  X_WC.linear().col(1) = forward.cross(right);
  X_WC.linear().col(2) = forward;
  X_WC.translation() = from;
  return X_WC;
}

std::shared_ptr<const RobotModel> loadRobot(const ros::NodeHandle& node) {
  std::string key, urdf;
  if (!node.searchParam("robot_description", key) || !node.getParam(key, urdf)) {
    throw InputError("there is no parameter robot_description");
  }
  return RobotModel::fromUrdf(urdf, makeMeshLoader());
}

std::vector<SceneBody> allBodies(const RobotModel& robot) {
  std::vector<SceneBody> bodies;
  for (std::size_t i = 0; i < robot.bodies().size(); ++i) {
    bodies.push_back({static_cast<int>(i), robot.links()[robot.bodies()[i].link].name});
  }
  return bodies;
}

class DepthCamera {
 public:
  DepthCamera(ros::NodeHandle node, const ros::NodeHandle& private_node)
      : settings_(private_node),
        robot_(loadRobot(private_node)),
        root_(robot_->links().front().name),
        poses_(monitor_.with([this](const Monitor& monitor) {
          return TfPoses(monitor.transforms(), *robot_, allBodies(*robot_), root_);
        })),
        X_WC_(lookingAt(CAMERA, LOOKS_AT)),
        image_(WIDTH, HEIGHT, 0.5 * WIDTH / std::tan(0.5 * VIEW)),
        publisher_(node.advertise<sensor_msgs::PointCloud2>("points", 1)) {
    monitor_.subscribe(node);
    geometry_msgs::TransformStamped transform;
    transform.header.stamp = ros::Time::now();
    transform.header.frame_id = root_;
    transform.child_frame_id = FRAME;
    const geometry_msgs::Pose pose = toPose(X_WC_);
    transform.transform.translation = toVector3(X_WC_.translation());
    transform.transform.rotation = pose.orientation;
    broadcaster_.sendTransform(transform);
    // Drawing random numbers would take longer than casting the rays.
    std::mt19937 random(1);
    std::normal_distribution<float> normal(0.0f, static_cast<float>(NOISE));
    for (float& value : noise_) value = normal(random);
  }

  void run() {
    ros::Rate rate(RATE);
    for (; ros::ok(); rate.sleep()) {
      const auto [stamped, now] = monitor_.with([this](const Monitor& monitor) {
        const ros::Time time = monitor.transforms().now().stamp;
        return std::pair(poses_.latest(time), time);
      });
      if (!stamped.problems.empty()) continue;  // a camera of a world that is not there yet
      const ros::Time stamp = stamped.stamp.isZero() ? now : stamped.stamp;
      if (stamp <= last_stamp_) continue;  // the robot was seen there already
      last_stamp_ = stamp;
      see(stamped.poses, stamp);
    }
  }

 private:
  Vector3d ballAt(const ros::Time& stamp) const {
    const double turns = settings_.ball_period > 0.0 ? stamp.toSec() / settings_.ball_period : 0.0;
    const double share = 0.5 - 0.5 * std::cos(2.0 * M_PI * turns);
    return (1.0 - share) * Vector3d(settings_.ball_from.data()) + share * BALL_TO;
  }

  void see(const BodyPoses& poses, const ros::Time& stamp) {
    const Isometry3d X_CW = X_WC_.inverse();
    image_.clear();
    for (const Link& link : robot_->links()) {
      const Isometry3d X_CL = X_CW * poses.X_WB[link.body] * link.X_BL;
      for (const Element& element : link.elements) image_.draw(element.shape, X_CL * element.X_LE);
    }
    image_.draw(Sphere{BALL_RADIUS}, X_CW * Isometry3d(Eigen::Translation3d(ballAt(stamp))));
    image_.draw(Box{{0.20, 0.16, 0.12}},
                X_CW * Isometry3d(Eigen::Translation3d(0.72, -0.38, 0.76)));
    publish(stamp);
  }

  void publish(const ros::Time& stamp) {
    sensor_msgs::PointCloud2 cloud;
    cloud.header.stamp = stamp;
    cloud.header.frame_id = FRAME;
    sensor_msgs::PointCloud2Modifier(cloud).setPointCloud2FieldsByString(1, "xyz");
    cloud.width = image_.width();  // the modifier makes it one row
    cloud.height = image_.height();
    cloud.row_step = cloud.width * cloud.point_step;
    cloud.data.resize(std::size_t{cloud.row_step} * cloud.height);
    sensor_msgs::PointCloud2Iterator<float> out(cloud, "x");
    for (int v = 0; v < image_.height(); ++v) {
      for (int u = 0; u < image_.width(); ++u, ++out) {
        const float depth = image_.depth(u, v) + noise_[next_noise_++ % noise_.size()];
        const Vector3d p = std::isfinite(depth)
                               ? Vector3d(depth * image_.ray(u, v))
                               : Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
        for (int axis = 0; axis < 3; ++axis) out[axis] = static_cast<float>(p[axis]);
      }
    }
    publisher_.publish(cloud);
  }

  const Settings settings_;
  std::shared_ptr<const RobotModel> robot_;
  std::string root_;
  LiveMonitor monitor_;
  TfPoses poses_;
  Isometry3d X_WC_;
  DepthImage image_;
  std::array<float, 65521> noise_;  // a prime: rows do not repeat
  std::size_t next_noise_ = 0;
  ros::Time last_stamp_;
  ros::Publisher publisher_;
  tf2_ros::StaticTransformBroadcaster broadcaster_;
};

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  ros::init(argc, argv, "simulate_depth_camera");
  const ros::NodeHandle keeps_log;  // the last one to go ends the log, and what follows is not said
  try {
    collision_pairs::DepthCamera(ros::NodeHandle(), ros::NodeHandle("~")).run();
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM("cannot start: " << error.what());
    return 1;
  }
  return 0;
}
