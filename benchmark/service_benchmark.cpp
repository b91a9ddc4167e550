// The node's services over persistent connections, beside an empty service in a process of its own.
//   service_benchmark serve       the empty service
//   service_benchmark measure N   N round trips of each, and trajectories of 1000 points between
//                                 the limits of the robot's joints; prints medians
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <collision_pairs/CheckCollisions.h>
#include <collision_pairs/CheckTrajectory.h>
#include <ros/ros.h>
#include <std_srvs/Empty.h>

#include "collision_pairs/collision_detector.h"
#include "collision_pairs/mesh_loader.h"

namespace collision_pairs {
namespace {

constexpr std::size_t POINTS = 1000;

double microsecondsOf(const std::function<void()>& call) {
  const auto start = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start)
      .count();
}

/// The calls take turns, so that what else the machine does meets all of them alike.
std::vector<double> medianMicroseconds(int repetitions,
                                       const std::vector<std::function<void()>>& calls) {
  std::vector<std::vector<double>> times(calls.size());
  for (int i = 0; i < repetitions; ++i) {
    for (std::size_t k = 0; k < calls.size(); ++k) times[k].push_back(microsecondsOf(calls[k]));
  }
  std::vector<double> medians;
  for (auto& of_call : times) {
    const auto middle = of_call.begin() + static_cast<std::ptrdiff_t>(of_call.size() / 2);
    std::nth_element(of_call.begin(), middle, of_call.end());
    medians.push_back(*middle);
  }
  return medians;
}

trajectory_msgs::JointTrajectory sweepOfAllJoints(const RobotModel& robot) {
  trajectory_msgs::JointTrajectory trajectory;
  std::vector<std::pair<double, double>> limits;
  for (const Joint& joint : robot.joints()) {
    if (!joint.hasPosition() || joint.mimic) continue;
    trajectory.joint_names.push_back(joint.name);
    limits.emplace_back(joint.hasLimits() ? joint.lower : -3.0,
                        joint.hasLimits() ? joint.upper : 3.0);
  }
  for (std::size_t i = 0; i < POINTS; ++i) {
    trajectory.points.emplace_back();
    for (std::size_t j = 0; j < limits.size(); ++j) {
      const double share = 0.5 + 0.5 * std::sin(0.01 * static_cast<double>(i * (j + 1)));
      trajectory.points.back().positions.push_back(limits[j].first +
                                                   share * (limits[j].second - limits[j].first));
    }
  }
  return trajectory;
}

double inProcess(const RobotModel& robot, const CollisionScene& scene, CollisionDetector& detector,
                 const trajectory_msgs::JointTrajectory& trajectory) {
  std::vector<double> q = robot.zeroPositions();
  std::vector<Eigen::Isometry3d> X_RB;
  BodyPoses poses;
  const auto check_all = [&] {
    for (const auto& point : trajectory.points) {
      for (std::size_t j = 0; j < point.positions.size(); ++j) {
        q[robot.findJoint(trajectory.joint_names[j])] = point.positions[j];
      }
      robot.applyMimics(q);
      robot.forwardKinematics(q, X_RB);
      scene.gatherPoses(X_RB, poses);
      detector.detect(poses, CheckSettings());
    }
  };
  return medianMicroseconds(5, {check_all}).front();
}

int measure(int repetitions) {
  ros::NodeHandle node;
  std::string urdf, srdf;
  node.getParam("robot_description", urdf);
  const auto robot = RobotModel::fromUrdf(urdf, makeMeshLoader());
  std::optional<Srdf> rules;
  if (node.getParam("robot_description_semantic", srdf)) rules = Srdf::fromXml(srdf);
  const auto scene = CollisionScene::build(robot, rules, nullptr);
  CollisionDetector detector(scene);

  ros::service::waitForService("/empty");
  ros::service::waitForService("/collision_pairs_node/check_collisions");
  auto empty = node.serviceClient<std_srvs::Empty>("/empty", true);
  auto check = node.serviceClient<CheckCollisions>("/collision_pairs_node/check_collisions", true);
  auto batch = node.serviceClient<CheckTrajectory>("/collision_pairs_node/check_trajectory", true);
  std_srvs::Empty nothing;
  CheckCollisions now, state;
  CheckTrajectory many;
  many.request.trajectory = sweepOfAllJoints(*robot);
  state.request.joint_state.name = many.request.trajectory.joint_names;
  state.request.joint_state.position = many.request.trajectory.points[0].positions;

  const std::vector<double> medians = medianMicroseconds(
      repetitions,
      {[&] { empty.call(nothing); }, [&] { check.call(now); }, [&] { check.call(state); }});
  const double round_trip = medians[0], from_tf = medians[1], hypothetical = medians[2];
  const double trajectory = medianMicroseconds(5, {[&] { batch.call(many); }}).front() / POINTS;
  const double direct = inProcess(*robot, *scene, detector, many.request.trajectory) / POINTS;
  std::printf("empty service                 %8.1f us\n", round_trip);
  std::printf("check_collisions, from TF     %8.1f us  (%.2f of the empty service)\n", from_tf,
              from_tf / round_trip);
  std::printf("check_collisions, joint_state %8.1f us  (%.2f of the empty service)\n", hypothetical,
              hypothetical / round_trip);
  std::printf("check_trajectory, each state  %8.2f us\n", trajectory);
  std::printf("in process, one thread        %8.2f us  (%.2f times as much by trajectory)\n",
              direct, trajectory / direct);
  return many.response.success && now.response.success && state.response.success ? 0 : 1;
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  const std::string mode = argc > 1 ? argv[1] : "";
  if (mode == "serve") {
    ros::init(argc, argv, "empty_service");
    ros::NodeHandle node;
    const boost::function<bool(std_srvs::Empty::Request&, std_srvs::Empty::Response&)> answer =
        [](std_srvs::Empty::Request&, std_srvs::Empty::Response&) { return true; };
    const auto server = node.advertiseService("/empty", answer);
    ros::spin();
    return 0;
  }
  if (mode != "measure") {
    std::fprintf(stderr, "usage: service_benchmark serve | measure REPETITIONS\n");
    return 2;
  }
  ros::init(argc, argv, "service_benchmark");
  return collision_pairs::measure(argc > 2 ? std::atoi(argv[2]) : 2000);
}
