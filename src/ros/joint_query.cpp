#include "joint_query.h"

#include <cmath>
#include <optional>

#include <geometry_msgs/TransformStamped.h>
#include <tf2/exceptions.h>

#include "collision_pairs/input_error.h"
#include "tf_poses.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;

constexpr double MIMIC_TOLERANCE = 1e-6;  // rad or m

/// By joint; empty where the request does not say.
using GivenPositions = std::vector<std::optional<double>>;

GivenPositions readPositions(const sensor_msgs::JointState& state, const RobotModel& robot) {
  if (state.name.size() != state.position.size()) {
    throw InputError("joint_state has " + std::to_string(state.name.size()) + " names, but " +
                     std::to_string(state.position.size()) + " positions");
  }
  GivenPositions given(robot.joints().size());
  for (std::size_t i = 0; i < state.name.size(); ++i) {
    const std::string quoted = "joint '" + state.name[i] + "'";
    const int joint = robot.findJoint(state.name[i]);
    if (joint < 0) throw InputError(quoted + " is not in robot '" + robot.name() + "'");
    if (!robot.joints()[joint].hasPosition()) {
      throw InputError(quoted + " is fixed, floating or planar: it has no position to set");
    }
    if (given[joint]) throw InputError(quoted + " is named twice");
    if (!std::isfinite(state.position[i]))
      throw InputError(quoted + ": its position is not finite");
    given[joint] = state.position[i];
  }
  return given;
}

/// Fills in the joints that mimic a given one, and refuses what contradicts it.
void followMimics(const RobotModel& robot, GivenPositions& given) {
  for (std::size_t i = 0; i < given.size(); ++i) {
    const Joint& joint = robot.joints()[i];
    if (!joint.mimic) continue;
    double multiplier = joint.mimic->multiplier, offset = joint.mimic->offset;
    int leader = joint.mimic->joint;
    while (robot.joints()[leader].mimic) {
      const Joint::Mimic& next = *robot.joints()[leader].mimic;
      offset += multiplier * next.offset;
      multiplier *= next.multiplier;
      leader = next.joint;
    }
    const std::string& leader_name = robot.joints()[leader].name;
    if (!given[leader]) {
      if (given[i]) {
        throw InputError("joint '" + joint.name + "' mimics '" + leader_name + "'; name that one");
      }
      continue;
    }
    const double position = multiplier * *given[leader] + offset;
    if (given[i] && std::abs(*given[i] - position) > MIMIC_TOLERANCE) {
      throw InputError("joint '" + joint.name + "' is " + std::to_string(*given[i]) + ", but as '" +
                       leader_name + "' leads it, it must be " + std::to_string(position));
    }
    given[i] = position;
  }
}

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

HypotheticalPoses posesFor(const sensor_msgs::JointState& joint_state, const CollisionScene& scene,
                           const tf2::BufferCore& buffer, const std::string& frame,
                           const ros::Time& stamp) {
  const RobotModel& robot = scene.robot();
  GivenPositions given = readPositions(joint_state, robot);
  followMimics(robot, given);
  const std::vector<double> zero = robot.zeroPositions();
  const auto linkOf = [&](const Body& body) { return robot.links()[body.link].name; };

  std::vector<Isometry3d> X_WB(robot.bodies().size());
  HypotheticalPoses result;
  for (std::size_t i = 0; i < robot.bodies().size(); ++i) {
    const Body& body = robot.bodies()[i];
    if (body.joint < 0) {
      X_WB[i] = Isometry3d::Identity();
      if (frame != linkOf(body) && !lookUp(buffer, frame, linkOf(body), stamp, X_WB[i])) {
        throw InputError("TF does not know root link '" + linkOf(body) + "' in frame '" + frame +
                         "' at stamp " + std::to_string(stamp.toSec()));
      }
      continue;
    }
    const Joint& joint = robot.joints()[body.joint];
    Isometry3d X_PB;
    if (given[body.joint]) {
      X_PB = body.X_PJ * joint.motion(*given[body.joint]);
    } else if (lookUp(buffer, linkOf(robot.bodies()[body.parent]), linkOf(body), stamp, X_PB)) {
      result.joints_from_tf.push_back(joint.name);
    } else {
      result.joints_at_zero.push_back(joint.name);
      X_PB = body.X_PJ * joint.motion(zero[body.joint]);
    }
    X_WB[i] = X_WB[body.parent] * X_PB;
  }
  scene.gatherPoses(X_WB, result.poses);
  return result;
}

}  // namespace collision_pairs
