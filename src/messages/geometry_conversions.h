// Points, vectors and poses as ROS messages, and back. Pure functions.
#pragma once

#include <string>

#include <Eigen/Geometry>
#include <geometry_msgs/Point.h>
#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Transform.h>
#include <geometry_msgs/Vector3.h>

namespace collision_pairs {

geometry_msgs::Point toPoint(const Eigen::Vector3d& v);
geometry_msgs::Vector3 toVector3(const Eigen::Vector3d& v);
geometry_msgs::Pose toPose(const Eigen::Isometry3d& X);
Eigen::Vector3d toVector(const geometry_msgs::Point& point);

/// Why it is no pose, in words: it is not finite, or its quaternion is not of length 1 within 1e-3.
/// One that was not filled in (0 0 0 0) is not a pose, and never identity. Empty: it is one.
std::string whyNoIsometry(const geometry_msgs::Pose& pose);
std::string whyNoIsometry(const geometry_msgs::Transform& transform);

/// False if there is a reason why not.
bool toIsometry(const geometry_msgs::Pose& pose, Eigen::Isometry3d& X);
/// Throws InputError with the reason.
Eigen::Isometry3d requiredIsometry(const geometry_msgs::Pose& pose);

}  // namespace collision_pairs
