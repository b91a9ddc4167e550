#include "joint_query.h"

#include <cmath>

#include <geometry_msgs/TransformStamped.h>
#include <tf2/exceptions.h>

#include "collision_pairs/input_error.h"
#include "geometry_conversions.h"
#include "tf_poses.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;

constexpr double MIMIC_TOLERANCE = 1e-6;  // rad or m

/// By body of the robot: whether one that the scene checks is it, or moves with it.
std::vector<char> bodiesNeeded(const CollisionScene& scene) {
  const auto& bodies = scene.robot().bodies();
  std::vector<char> is_needed(bodies.size(), 0);
  for (const SceneBody& checked : scene.bodies()) {
    for (int body = checked.body; body >= 0 && !is_needed[body]; body = bodies[body].parent) {
      is_needed[body] = 1;
    }
  }
  return is_needed;
}

/// Where TF has the child in the parent; false if nowhere. `doubt` says so if that is too old.
bool askTf(const JointQueryTf& tf, const std::string& parent, const std::string& child,
           Isometry3d& X_PC, std::string& doubt) {
  if (!tf.transforms.buffer().canTransform(parent, child, tf.stamp)) return false;
  try {
    const auto found = tf.transforms.lookUp(parent, child, tf.stamp);
    if (!toIsometry(found.transform, X_PC)) return false;
    if (tf.stamp.isZero()) {
      const std::string why = whyTooOld(found.header.stamp, tf.now, tf.max_pose_age);
      if (!why.empty()) doubt = "link '" + child + "': " + why;
    }
    return true;
  } catch (const tf2::TransformException&) {
    return false;
  }
}

}  // namespace

JointQuery::JointQuery(const std::vector<std::string>& names, const CollisionScene& scene,
                       const JointQueryTf& tf)
    : scene_(scene), name_of_joint_(scene.robot().joints().size(), -1) {
  readNames(names);
  refuseLoneMimics();
  const std::vector<char> is_needed = bodiesNeeded(scene);
  for (const Body& body : scene.robot().bodies()) {
    std::string doubt;
    sources_.push_back(sourceOf(body, tf, doubt));
    if (!doubt.empty() && is_needed[sources_.size() - 1]) doubts_.push_back(std::move(doubt));
  }
}

JointQuery::Source JointQuery::sourceOf(const Body& body, const JointQueryTf& tf,
                                        std::string& doubt) {
  const RobotModel& robot = scene_.robot();
  const std::string& link = robot.links()[body.link].name;
  if (body.joint < 0) {
    Source root;
    root.X_PB = Isometry3d::Identity();
    if (tf.frame == link || askTf(tf, tf.frame, link, root.X_PB, doubt)) return root;
    throw InputError("TF does not know root link '" + link + "' in frame '" + tf.frame +
                     "' at stamp " + std::to_string(tf.stamp.toSec()));
  }
  Source source = leaderOf(body.joint);
  if (source.name >= 0) return source;
  const Joint& joint = robot.joints()[body.joint];
  const std::string& parent = robot.links()[robot.bodies()[body.parent].link].name;
  if (askTf(tf, parent, link, source.X_PB, doubt)) {
    joints_from_tf_.push_back(joint.name);
    return source;
  }
  joints_at_zero_.push_back(joint.name);
  doubt = "joint '" + joint.name + "' is not named and TF does not know it: it was taken at zero";
  source.X_PB = body.X_PJ * joint.motion(robot.zeroPositions()[body.joint]);
  return source;
}

void JointQuery::readNames(const std::vector<std::string>& names) {
  const RobotModel& robot = scene_.robot();
  for (const std::string& name : names) {
    const int joint = robot.findJoint(name);
    if (joint < 0) throw InputError("joint '" + name + "' is not in robot '" + robot.name() + "'");
    if (!robot.joints()[joint].hasPosition()) {
      throw InputError("joint '" + name +
                       "' is fixed, floating or planar: it has no position to set");
    }
    if (name_of_joint_[joint] >= 0) throw InputError("joint '" + name + "' is named twice");
    name_of_joint_[joint] = static_cast<int>(joint_of_name_.size());
    joint_of_name_.push_back(joint);
  }
}

JointQuery::Source JointQuery::leaderOf(int joint) const {
  Source source;
  const auto& joints = scene_.robot().joints();
  for (; joints[joint].mimic; joint = joints[joint].mimic->joint) {
    source.offset += source.multiplier * joints[joint].mimic->offset;
    source.multiplier *= joints[joint].mimic->multiplier;
  }
  source.name = name_of_joint_[joint];
  return source;
}

void JointQuery::refuseLoneMimics() const {
  for (const int joint : joint_of_name_) {
    const Joint& named = scene_.robot().joints()[joint];
    if (!named.mimic || leaderOf(joint).name >= 0) continue;
    throw InputError("joint '" + named.name + "' mimics '" +
                     scene_.robot().joints()[named.mimic->joint].name + "'; name that one");
  }
}

void JointQuery::refuseWrong(const std::vector<double>& positions) const {
  const RobotModel& robot = scene_.robot();
  if (positions.size() != joint_of_name_.size()) {
    throw InputError(std::to_string(joint_of_name_.size()) + " joints are named, but there are " +
                     std::to_string(positions.size()) + " positions");
  }
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Joint& joint = robot.joints()[joint_of_name_[i]];
    if (!std::isfinite(positions[i])) {
      throw InputError("joint '" + joint.name + "': its position is not finite");
    }
    if (!joint.mimic) continue;
    const Source leader = leaderOf(joint_of_name_[i]);
    const double expected = leader.multiplier * positions[leader.name] + leader.offset;
    if (std::abs(positions[i] - expected) <= MIMIC_TOLERANCE) continue;
    throw InputError("joint '" + joint.name + "' is " + std::to_string(positions[i]) +
                     ", but by the joint it mimics it must be " + std::to_string(expected));
  }
}

void JointQuery::posesAt(const std::vector<double>& positions, BodyPoses& poses) const {
  refuseWrong(positions);
  const RobotModel& robot = scene_.robot();
  thread_local std::vector<Isometry3d> X_WB;
  X_WB.resize(robot.bodies().size());
  for (std::size_t i = 0; i < robot.bodies().size(); ++i) {
    const Body& body = robot.bodies()[i];
    const Source& source = sources_[i];
    if (body.joint < 0) {
      X_WB[i] = source.X_PB;
    } else if (source.name < 0) {
      X_WB[i] = X_WB[body.parent] * source.X_PB;
    } else {
      const double position = source.multiplier * positions[source.name] + source.offset;
      X_WB[i] = X_WB[body.parent] * body.X_PJ * robot.joints()[body.joint].motion(position);
    }
  }
  scene_.gatherPoses(X_WB, poses);
}

std::vector<double> JointQuery::jointPositionsAt(const std::vector<double>& positions) const {
  refuseWrong(positions);
  std::vector<double> all = scene_.robot().zeroPositions();
  for (std::size_t i = 0; i < positions.size(); ++i) all[joint_of_name_[i]] = positions[i];
  return all;
}

std::vector<std::optional<Isometry3d>> JointQuery::placedBodies() const {
  std::vector<std::optional<Isometry3d>> placed;
  for (const Source& source : sources_) {
    placed.emplace_back();
    if (source.name < 0) placed.back() = source.X_PB;
  }
  return placed;
}

}  // namespace collision_pairs
