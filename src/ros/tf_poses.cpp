#include "tf_poses.h"

#include <algorithm>
#include <cstdio>

#include <geometry_msgs/TransformStamped.h>
#include <tf2/exceptions.h>

#include "geometry_conversions.h"

namespace collision_pairs {

using Eigen::Isometry3d;

namespace {

std::string formatted(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", seconds);
  return text;
}

}  // namespace

std::string whyTooOld(const ros::Time& stamp, const ros::Time& now, double max_pose_age) {
  if (stamp.isZero() || max_pose_age == 0.0) return "";
  const double age = now.toSec() - stamp.toSec();  // ros::Duration throws beyond 68 years
  if (age <= max_pose_age) return "";
  return "its newest transform is " + formatted(age) + " s old, and max_pose_age is " +
         formatted(max_pose_age) + " s";
}

TfPoses::TfPoses(const TransformInput& transforms, const RobotModel& robot,
                 const std::vector<SceneBody>& bodies, std::string frame)
    : transforms_(transforms), frame_(std::move(frame)) {
  for (const SceneBody& body : bodies) {
    std::vector<Source> sources;
    for (const Link& link : robot.links()) {
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

TfPoses::Found TfPoses::lookUpLink(const Source& source, const ros::Time& stamp,
                                   bool expected) const {
  Found found;
  if (source.link == frame_) {  // by definition, at any instant
    found.known = true;
    found.X_WB = source.X_LB;
    return found;
  }
  std::string error;
  try {
    if (expected || transforms_.buffer().canTransform(frame_, source.link, stamp, &error)) {
      const auto transform = transforms_.lookUp(frame_, source.link, stamp);
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
  if (!found.known) found.problem = "link '" + source.link + "': " + error;
  return found;
}

TfPoses::Found TfPoses::lookUp(std::size_t body, const ros::Time& stamp) const {
  std::string problem;
  bool expected = expected_[body];
  for (const Source& source : sources_[body]) {
    Found found = lookUpLink(source, stamp, expected);
    if (found.known) {
      expected_[body] = true;
      return found;
    }
    if (problem.empty()) problem = std::move(found.problem);
    expected = false;
  }
  expected_[body] = false;
  Found nothing;
  nothing.problem = std::move(problem);
  return nothing;
}

void TfPoses::leaveOut(std::size_t body, const std::string& why, Found& found) const {
  found.known = false;
  found.problem = "link '" + sources_[body].front().link + "': " + why;
}

StampedPoses TfPoses::latest(const ros::Time& now, const PoseLimits& limits) const {
  std::vector<Found> found(sources_.size());
  ros::Time newest;
  for (std::size_t i = 0; i < found.size(); ++i) {
    found[i] = lookUp(i, ros::Time(0));
    if (!found[i].known) continue;
    const std::string why = whyTooOld(found[i].stamp, now, limits.max_pose_age);
    if (!why.empty()) {
      leaveOut(i, why, found[i]);
    } else {
      newest = std::max(newest, found[i].stamp);
    }
  }
  // Static transforms have the stamp 0 and are valid at any instant.
  ros::Time common = newest;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (!found[i].known || found[i].stamp.isZero()) continue;
    const double lag = newest.toSec() - found[i].stamp.toSec();
    if (lag > limits.max_transform_age) {
      leaveOut(i,
               "its newest transform is " + formatted(lag) +
                   " s older than the newest of all links, and max_transform_age is " +
                   formatted(limits.max_transform_age) + " s",
               found[i]);
    } else {
      common = std::min(common, found[i].stamp);
    }
  }
  // Most robots publish all joints with one stamp; then nothing has to be looked up again.
  for (std::size_t i = 0; i < found.size(); ++i) {
    const bool is_there = found[i].stamp.isZero() || found[i].stamp == common;
    if (found[i].known && !is_there) found[i] = lookUp(i, common);
  }
  return gather(std::move(found), common);
}

StampedPoses TfPoses::at(const ros::Time& stamp) const {
  std::vector<Found> found(sources_.size());
  for (std::size_t i = 0; i < found.size(); ++i) found[i] = lookUp(i, stamp);
  return gather(std::move(found), stamp);
}

BodyPoses TfPoses::at(const ros::Time& stamp, const std::vector<char>& wanted) const {
  BodyPoses poses;
  poses.resize(sources_.size());
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const Found found = wanted[i] ? lookUp(i, stamp) : Found();
    poses.known[i] = found.known;
    if (found.known) poses.X_WB[i] = found.X_WB;
  }
  return poses;
}

StampedPoses TfPoses::gather(std::vector<Found> found, const ros::Time& stamp) const {
  StampedPoses result;
  result.stamp = stamp;
  result.poses.resize(found.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    result.poses.known[i] = found[i].known;
    if (found[i].known) {
      result.poses.X_WB[i] = found[i].X_WB;
    } else {
      result.problems.push_back(std::move(found[i].problem));
    }
    if (isFrame(sources_[i])) continue;
    ++result.nb_asked;
    if (found[i].known) ++result.nb_found;
  }
  return result;
}

}  // namespace collision_pairs
