#include "geometry_conversions.h"

#include <cmath>
#include <sstream>

#include "collision_pairs/input_error.h"

namespace collision_pairs {

namespace {

template <class Xyz>
Xyz toXyz(const Eigen::Vector3d& v) {
  Xyz message;
  message.x = v.x();
  message.y = v.y();
  message.z = v.z();
  return message;
}

}  // namespace

geometry_msgs::Point toPoint(const Eigen::Vector3d& v) { return toXyz<geometry_msgs::Point>(v); }
geometry_msgs::Vector3 toVector3(const Eigen::Vector3d& v) {
  return toXyz<geometry_msgs::Vector3>(v);
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

std::string whyNoIsometry(const geometry_msgs::Pose& pose) {
  if (!toVector(pose.position).allFinite()) return "its position is not finite";
  const auto& q = pose.orientation;
  const double length = Eigen::Vector4d(q.x, q.y, q.z, q.w).norm();
  if (std::abs(length - 1.0) < 1e-3) return "";
  if (!std::isfinite(length)) return "its quaternion is not finite";
  std::ostringstream text;
  text << "its quaternion is of length " << length << ", not 1";
  return text.str();
}

std::string whyNoIsometry(const geometry_msgs::Transform& transform) {
  const auto& t = transform.translation;
  geometry_msgs::Pose pose;
  pose.position = toPoint({t.x, t.y, t.z});
  pose.orientation = transform.rotation;
  return whyNoIsometry(pose);
}

bool toIsometry(const geometry_msgs::Pose& pose, Eigen::Isometry3d& X) {
  if (!whyNoIsometry(pose).empty()) return false;
  const auto& q = pose.orientation;
  const Eigen::Quaterniond rotation(q.w, q.x, q.y, q.z);
  X.linear() = rotation.normalized().toRotationMatrix();
  X.translation() = toVector(pose.position);
  return true;
}

Eigen::Isometry3d requiredIsometry(const geometry_msgs::Pose& pose) {
  Eigen::Isometry3d X;
  if (toIsometry(pose, X)) return X;
  throw InputError(
      "its pose is invalid: a finite position and a quaternion of length 1 are needed, but " +
      whyNoIsometry(pose));
}

}  // namespace collision_pairs
