#include "tf_poses.h"

#include <algorithm>
#include <cmath>

#include <geometry_msgs/TransformStamped.h>
#include <tf2/exceptions.h>

namespace collision_pairs {

using Eigen::Isometry3d;

bool toIsometry(const geometry_msgs::Transform& transform, Isometry3d& X) {
  const auto& q = transform.rotation;
  const auto& t = transform.translation;
  const Eigen::Quaterniond rotation(q.w, q.x, q.y, q.z);
  if (!(std::abs(rotation.norm() - 1.0) < 1e-3)) return false;  // NaN is caught here too
  X = Isometry3d::Identity();
  X.linear() = rotation.normalized().toRotationMatrix();
  X.translation() = Eigen::Vector3d(t.x, t.y, t.z);
  return X.translation().allFinite();
}

TfPoses::TfPoses(const tf2::BufferCore& buffer, const CollisionScene& scene, std::string frame)
    : buffer_(buffer), frame_(std::move(frame)) {
  const auto& links = scene.robot().links();
  for (const SceneBody& body : scene.bodies()) {
    std::vector<Source> sources;
    for (const Link& link : links) {
      if (link.body != body.body) continue;
      if (link.name != body.link && !link.has_geometry) continue;
      sources.push_back({link.name, link.X_BL.inverse()});
    }
    sources_.push_back(std::move(sources));
  }
}

bool TfPoses::isFrame(const std::vector<Source>& sources) const {
  return std::any_of(sources.begin(), sources.end(),
                     [&](const Source& source) { return source.link == frame_; });
}

bool TfPoses::newestStamp(const std::vector<Source>& sources, ros::Time& stamp) const {
  for (const Source& source : sources) {
    if (source.link == frame_) return true;  // where it is by definition, at any instant
    if (!buffer_.canTransform(frame_, source.link, ros::Time(0))) continue;
    try {
      stamp = buffer_.lookupTransform(frame_, source.link, ros::Time(0)).header.stamp;
      return true;
    } catch (const tf2::TransformException&) {
      // It went between the two calls: as good as never known.
    }
  }
  return false;
}

bool TfPoses::lookUp(const std::vector<Source>& sources, const ros::Time& stamp, Isometry3d& X_WB,
                     std::string* problem) const {
  std::string why;
  for (const Source& source : sources) {
    if (source.link == frame_) {
      X_WB = source.X_LB;
      return true;
    }
    std::string error;
    if (!buffer_.canTransform(frame_, source.link, stamp, &error)) {
      if (why.empty()) why = "link '" + source.link + "': " + error;
      continue;
    }
    try {
      Isometry3d X_WL;
      if (toIsometry(buffer_.lookupTransform(frame_, source.link, stamp).transform, X_WL)) {
        X_WB = X_WL * source.X_LB;
        return true;
      }
      why = "link '" + source.link + "': its transform is not finite";
    } catch (const tf2::TransformException& exception) {
      if (why.empty()) why = "link '" + source.link + "': " + exception.what();
    }
  }
  if (problem->empty()) *problem = why;
  return false;
}

StampedPoses TfPoses::latest(double max_age) const {
  std::vector<ros::Time> stamps(sources_.size());
  std::vector<char> known(sources_.size());
  ros::Time newest;
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    known[i] = newestStamp(sources_[i], stamps[i]);
    if (known[i]) newest = std::max(newest, stamps[i]);
  }
  // Static transforms have the stamp 0 and are good at any instant.
  ros::Time common = newest;
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const bool is_static = stamps[i].isZero();
    if (known[i] && !is_static && (newest - stamps[i]).toSec() <= max_age) {
      common = std::min(common, stamps[i]);
    }
  }
  return at(common);
}

StampedPoses TfPoses::at(const ros::Time& stamp) const {
  StampedPoses result;
  result.stamp = stamp;
  result.poses.resize(sources_.size());
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const bool known = lookUp(sources_[i], stamp, result.poses.X_WB[i], &result.problem);
    result.poses.known[i] = known;
    if (isFrame(sources_[i])) continue;
    ++result.nb_asked;
    if (known) ++result.nb_found;
  }
  return result;
}

}  // namespace collision_pairs
