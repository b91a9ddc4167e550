#include "tf_poses.h"

#include <algorithm>
#include <cmath>

#include <geometry_msgs/TransformStamped.h>
#include <tf2/exceptions.h>

#include "geometry_conversions.h"

namespace collision_pairs {

using Eigen::Isometry3d;

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
  expected_ = std::vector<std::atomic<bool>>(sources_.size());
}

bool TfPoses::isFrame(const std::vector<Source>& sources) const {
  return std::any_of(sources.begin(), sources.end(),
                     [&](const Source& source) { return source.link == frame_; });
}

TfPoses::Found TfPoses::lookUpLink(const Source& source, const ros::Time& stamp, bool expected,
                                   std::string* problem) const {
  Found found;
  if (source.link == frame_) {  // where it is by definition, at any instant
    found.known = true;
    found.X_WB = source.X_LB;
    return found;
  }
  std::string error;
  try {
    if (expected || buffer_.canTransform(frame_, source.link, stamp, &error)) {
      const auto transform = buffer_.lookupTransform(frame_, source.link, stamp);
      Isometry3d X_WL;
      found.known = toIsometry(transform.transform, X_WL);
      found.stamp = transform.header.stamp;
      if (found.known) {
        found.X_WB = X_WL * source.X_LB;
      } else {
        error = "its transform is not finite";
      }
    }
  } catch (const tf2::TransformException& exception) {
    error = exception.what();
  }
  if (!found.known && problem->empty()) *problem = "link '" + source.link + "': " + error;
  return found;
}

TfPoses::Found TfPoses::lookUp(std::size_t body, const ros::Time& stamp,
                               std::string* problem) const {
  std::string why;
  bool expected = expected_[body];
  for (const Source& source : sources_[body]) {
    const Found found = lookUpLink(source, stamp, expected, &why);
    if (found.known) {
      expected_[body] = true;
      return found;
    }
    expected = false;
  }
  expected_[body] = false;
  if (problem->empty()) *problem = why;
  return {};
}

StampedPoses TfPoses::latest(double max_age) const {
  std::vector<Found> found(sources_.size());
  std::string problem;
  ros::Time newest;
  for (std::size_t i = 0; i < found.size(); ++i) {
    found[i] = lookUp(i, ros::Time(0), &problem);
    if (found[i].known) newest = std::max(newest, found[i].stamp);
  }
  // Static transforms have the stamp 0 and are good at any instant.
  ros::Time common = newest;
  for (const Found& body : found) {
    if (!body.known || body.stamp.isZero()) continue;
    if ((newest - body.stamp).toSec() <= max_age) common = std::min(common, body.stamp);
  }
  // Most robots publish all joints with one stamp: then that was all.
  for (std::size_t i = 0; i < found.size(); ++i) {
    const bool is_there = found[i].stamp.isZero() || found[i].stamp == common;
    if (found[i].known && !is_there) found[i] = lookUp(i, common, &problem);
  }
  return gather(found, common, std::move(problem));
}

StampedPoses TfPoses::at(const ros::Time& stamp) const {
  std::vector<Found> found(sources_.size());
  std::string problem;
  for (std::size_t i = 0; i < found.size(); ++i) found[i] = lookUp(i, stamp, &problem);
  return gather(found, stamp, std::move(problem));
}

StampedPoses TfPoses::gather(const std::vector<Found>& found, const ros::Time& stamp,
                             std::string problem) const {
  StampedPoses result;
  result.stamp = stamp;
  result.problem = std::move(problem);
  result.poses.resize(found.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    result.poses.known[i] = found[i].known;
    if (found[i].known) result.poses.X_WB[i] = found[i].X_WB;
    if (isFrame(sources_[i])) continue;
    ++result.nb_asked;
    if (found[i].known) ++result.nb_found;
  }
  return result;
}

}  // namespace collision_pairs
