#include "tf_poses.h"

#include <utility>

namespace collision_pairs {

TfPoses::TfPoses(const TransformInput& transforms, const RobotModel& robot,
                 std::vector<SceneBody> bodies, const std::string& frame,
                 const std::vector<std::string>& static_joints)
    : transforms_(transforms),
      bodies_(std::move(bodies)),
      robot_(transforms.buffer(), robot, frame, static_joints),
      all_(robot_.nbBodies(), 0) {
  for (const SceneBody& body : bodies_) all_[body.body] = 1;
}

StampedPoses TfPoses::latest(const ros::Time& now) const {
  FoundBodies placed = robot_.newest(toNs(now), all_);
  const ros::Time stamp = toTime(placed.stamp);
  return gather(std::move(placed), stamp);
}

StampedPoses TfPoses::at(const ros::Time& stamp) const {
  return gather(robot_.place({Instant::AT, toNs(stamp)}, all_), stamp);
}

BodyPoses TfPoses::at(const ros::Time& stamp, const std::vector<char>& wanted) const {
  std::vector<char> of_robot(robot_.nbBodies(), 0);
  for (std::size_t i = 0; i < bodies_.size(); ++i) of_robot[bodies_[i].body] |= wanted[i];
  const FoundBodies placed = robot_.place({Instant::AT, toNs(stamp)}, of_robot);
  BodyPoses poses;
  poses.resize(bodies_.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    poses.known[i] = wanted[i] && placed.known[bodies_[i].body];
    if (poses.known[i]) poses.X_WB[i] = placed.X_WB[bodies_[i].body];
  }
  return poses;
}

StampedPoses TfPoses::gather(FoundBodies placed, const ros::Time& stamp) const {
  StampedPoses result;
  result.stamp = stamp;
  result.poses.resize(bodies_.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const int body = bodies_[i].body;
    result.poses.known[i] = placed.known[body];
    if (placed.known[body]) {
      result.poses.X_WB[i] = placed.X_WB[body];
    } else {
      result.problems.push_back("link '" + bodies_[i].link + "': " + placed.problems[body]);
    }
    if (body == robot_.bodyOfFrame()) continue;
    ++result.nb_asked;
    if (placed.known[body]) ++result.nb_found;
  }
  return result;
}

}  // namespace collision_pairs
