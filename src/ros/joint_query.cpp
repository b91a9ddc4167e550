#include "joint_query.h"

#include <cmath>

#include <geometry_msgs/TransformStamped.h>
#include <tf2/exceptions.h>

#include "collision_pairs/input_error.h"
#include "geometry_conversions.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;

constexpr double MIMIC_TOLERANCE = 1e-6;  // rad or m

bool lookUp(const tf2::BufferCore& buffer, const std::string& target, const std::string& source,
            const ros::Time& stamp, Isometry3d& X) {
  if (!buffer.canTransform(target, source, stamp)) return false;
  try {
    return toIsometry(buffer.lookupTransform(target, source, stamp).transform, X);
  } catch (const tf2::TransformException&) {
    return false;
  }
}

}  // namespace

JointQuery::JointQuery(const std::vector<std::string>& names, const CollisionScene& scene,
                       const tf2::BufferCore& buffer, const std::string& frame,
                       const ros::Time& stamp)
    : scene_(scene), name_of_joint_(scene.robot().joints().size(), -1) {
  readNames(names);
  refuseLoneMimics();
  const RobotModel& robot = scene.robot();
  const std::vector<double> zero = robot.zeroPositions();
  const auto linkOf = [&](const Body& body) { return robot.links()[body.link].name; };
  for (const Body& body : robot.bodies()) {
    if (body.joint < 0) {
      Source root;
      root.X_PB = Isometry3d::Identity();
      if (frame != linkOf(body) && !lookUp(buffer, frame, linkOf(body), stamp, root.X_PB)) {
        throw InputError("TF does not know root link '" + linkOf(body) + "' in frame '" + frame +
                         "' at stamp " + std::to_string(stamp.toSec()));
      }
      sources_.push_back(root);
      continue;
    }
    const Joint& joint = robot.joints()[body.joint];
    Source source = leaderOf(body.joint);
    if (source.name < 0) {
      if (lookUp(buffer, linkOf(robot.bodies()[body.parent]), linkOf(body), stamp, source.X_PB)) {
        joints_from_tf_.push_back(joint.name);
      } else {
        joints_at_zero_.push_back(joint.name);
        source.X_PB = body.X_PJ * joint.motion(zero[body.joint]);
      }
    }
    sources_.push_back(source);
  }
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

void JointQuery::posesAt(const std::vector<double>& positions, BodyPoses& poses) const {
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

}  // namespace collision_pairs
