#include "collision_pairs/joint_columns.h"

#include <cmath>

#include "collision_pairs/input_error.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

constexpr double LARGEST_ANGLE = 1e6;     // rad; a digit is 1e-10 there
constexpr double MIMIC_TOLERANCE = 1e-6;  // rad or m: precision of output with six decimals

[[noreturn]] void refuseUnknown(const std::string& name, const RobotModel& robot) {
  std::vector<std::string> known;
  for (const Joint& joint : robot.joints()) {
    if (joint.hasPosition()) known.push_back(joint.name);
  }
  throw InputError("joint '" + name + "' is not in robot '" + robot.name() + "'" +
                   didYouMean(name, known));
}

}  // namespace

JointColumns::JointColumns(const std::vector<std::string>& names, const RobotModel& robot)
    : robot_(robot) {
  const auto& joints = robot.joints();
  std::vector<int> column_of_joint(joints.size(), -1);
  for (const std::string& name : names) {
    const int exact = robot.findJoint(name);
    const int joint = exact < 0 ? robot.findJoint(withoutLeadingSlash(name)) : exact;
    if (joint < 0) refuseUnknown(name, robot);
    if (!joints[joint].hasPosition()) {
      throw InputError("joint '" + name +
                       "' is fixed, floating or planar: it has no position to set");
    }
    if (column_of_joint[joint] >= 0) throw InputError("joint '" + name + "' is named twice");
    column_of_joint[joint] = static_cast<int>(joint_of_column_.size());
    joint_of_column_.push_back(joint);
  }
  for (std::size_t i = 0; i < joints.size(); ++i) {
    source_of_joint_.push_back(followed(static_cast<int>(i), column_of_joint));
  }
  for (const int joint : joint_of_column_) {
    if (source_of_joint_[joint].column >= 0) continue;
    throw InputError("joint '" + joints[joint].name + "' mimics '" +
                     joints[joints[joint].mimic->joint].name + "'; name that joint instead");
  }
}

JointColumns::Source JointColumns::followed(int joint,
                                            const std::vector<int>& column_of_joint) const {
  Source source;
  const auto& joints = robot_.joints();
  for (; joints[joint].mimic; joint = joints[joint].mimic->joint) {
    source.offset += source.multiplier * joints[joint].mimic->offset;
    source.multiplier *= joints[joint].mimic->multiplier;
  }
  source.column = column_of_joint[joint];
  return source;
}

void JointColumns::check(const double* state) const {
  for (std::size_t i = 0; i < size(); ++i) {
    const Joint& joint = robot_.joints()[joint_of_column_[i]];
    if (!std::isfinite(state[i])) {
      throw InputError("joint '" + joint.name + "': its position is not finite");
    }
    const bool is_angle = joint.type == JointType::REVOLUTE || joint.type == JointType::CONTINUOUS;
    if (is_angle && std::abs(state[i]) > LARGEST_ANGLE) {
      throw InputError("joint '" + joint.name + "' is at " + std::to_string(state[i]) +
                       " rad: beyond 1e6 its digits do not say where in a turn it is");
    }
    if (!joint.mimic) continue;
    const Source& leader = source_of_joint_[joint_of_column_[i]];
    const double expected = leader.multiplier * state[leader.column] + leader.offset;
    if (std::abs(state[i] - expected) <= MIMIC_TOLERANCE) continue;
    throw InputError("joint '" + joint.name + "' is " + std::to_string(state[i]) +
                     ", but by the joint it mimics it must be " + std::to_string(expected));
  }
}

void JointColumns::apply(const double* state, std::vector<double>& positions) const {
  check(state);
  for (std::size_t i = 0; i < source_of_joint_.size(); ++i) {
    const Source& source = source_of_joint_[i];
    if (source.column < 0) continue;
    positions[i] = source.multiplier * state[source.column] + source.offset;
  }
}

std::vector<std::string> JointColumns::notNamed() const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < source_of_joint_.size(); ++i) {
    const Joint& joint = robot_.joints()[i];
    if (joint.hasPosition() && !joint.mimic && source_of_joint_[i].column < 0) {
      names.push_back(joint.name);
    }
  }
  return names;
}

std::vector<std::string> JointColumns::atZero() const {
  std::vector<std::string> names;
  for (const std::string& name : notNamed()) {
    if (!robot_.joints()[robot_.findJoint(name)].leader_missing) names.push_back(name);
  }
  for (const Joint& joint : robot_.joints()) {
    const bool is_free = joint.type == JointType::FLOATING || joint.type == JointType::PLANAR;
    if (is_free) names.push_back(joint.name);
  }
  return names;
}

}  // namespace collision_pairs
