#include "geometry_conversions.h"

#include <cmath>
#include <sstream>

namespace collision_pairs {

geometry_msgs::Point toPoint(const Eigen::Vector3d& v) {
  geometry_msgs::Point point;
  point.x = v.x();
  point.y = v.y();
  point.z = v.z();
  return point;
}

geometry_msgs::Vector3 toVector3(const Eigen::Vector3d& v) {
  geometry_msgs::Vector3 vector;
  vector.x = v.x();
  vector.y = v.y();
  vector.z = v.z();
  return vector;
}

geometry_msgs::Pose toPose(const Eigen::Isometry3d& X) {
  const Eigen::Quaterniond rotation(X.linear());
  geometry_msgs::Pose pose;
  pose.position = toPoint(X.translation());
  pose.orientation.x = rotation.x();
  pose.orientation.y = rotation.y();
  pose.orientation.z = rotation.z();
  pose.orientation.w = rotation.w();
  return pose;
}

Eigen::Vector3d toVector(const geometry_msgs::Point& point) { return {point.x, point.y, point.z}; }

bool toIsometry(const Eigen::Vector3d& position, const geometry_msgs::Quaternion& orientation,
                Eigen::Isometry3d& X) {
  const Eigen::Quaterniond rotation(orientation.w, orientation.x, orientation.y, orientation.z);
  if (!(std::abs(rotation.norm() - 1.0) < 1e-3)) return false;  // NaN is caught here too
  X = Eigen::Isometry3d::Identity();
  X.linear() = rotation.normalized().toRotationMatrix();
  X.translation() = position;
  return position.allFinite();
}

std::string whyNoIsometry(const geometry_msgs::Pose& pose) {
  const auto& q = pose.orientation;
  if (!toVector(pose.position).allFinite()) return "its position is not finite";
  const double length = Eigen::Vector4d(q.x, q.y, q.z, q.w).norm();
  if (!std::isfinite(length)) return "its quaternion is not finite";
  std::ostringstream text;
  text << "its quaternion is of length " << length << ", not 1";
  return text.str();
}

std::string whyNoIsometry(const geometry_msgs::Transform& transform) {
  geometry_msgs::Pose pose;
  pose.position =
      toPoint({transform.translation.x, transform.translation.y, transform.translation.z});
  pose.orientation = transform.rotation;
  return whyNoIsometry(pose);
}

bool toIsometry(const geometry_msgs::Pose& pose, Eigen::Isometry3d& X) {
  return toIsometry(toVector(pose.position), pose.orientation, X);
}

bool toIsometry(const geometry_msgs::Transform& transform, Eigen::Isometry3d& X) {
  const auto& t = transform.translation;
  return toIsometry(Eigen::Vector3d(t.x, t.y, t.z), transform.rotation, X);
}

}  // namespace collision_pairs
