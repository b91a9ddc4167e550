#include "collision_pairs/robot_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision_pairs/input_error.h"
#include "pose_repair.h"

namespace collision_pairs {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

std::string withPrefix(const std::string& prefix, const std::string& name) {
  return prefix.empty() ? name : prefix + "/" + name;
}

Isometry3d Joint::motion(double position) const {
  Isometry3d X = Isometry3d::Identity();
  if (type == JointType::PRISMATIC) {
    X.translation() = position * axis;
  } else if (hasPosition()) {
    X.linear() = Eigen::AngleAxisd(position, axis).toRotationMatrix();
  }
  return X;
}

void RobotModel::indexNames() {
  for (std::size_t i = 0; i < links_.size(); ++i) link_ids_[links_[i].name] = static_cast<int>(i);
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    joint_ids_[joints_[i].name] = static_cast<int>(i);
  }
}

void RobotModel::groupIntoBodies() {
  bodies_.clear();
  for (std::size_t i = 0; i < links_.size(); ++i) {
    Link& link = links_[i];
    const int joint_id = link.parent_joint;
    if (joint_id >= 0 && joints_[joint_id].type == JointType::FIXED) {
      const Link& parent = links_[joints_[joint_id].parent_link];
      link.body = parent.body;
      link.X_BL = parent.X_BL * joints_[joint_id].X_PJ;
      continue;
    }
    Body body;
    body.link = static_cast<int>(i);
    if (joint_id >= 0) {
      const Link& parent = links_[joints_[joint_id].parent_link];
      body.joint = joint_id;
      body.parent = parent.body;
      body.X_PJ = parent.X_BL * joints_[joint_id].X_PJ;
    }
    link.body = static_cast<int>(bodies_.size());
    link.X_BL = Isometry3d::Identity();
    bodies_.push_back(body);
  }
  foldJoints();
}

void RobotModel::foldJoints() {
  motions_.clear();
  for (const Body& body : bodies_) {
    BodyMotion motion;
    motion.R = body.X_PJ.linear();
    motion.p = body.X_PJ.translation();
    motion.p_slope.setZero();
    const bool moves = body.joint >= 0 && joints_[body.joint].hasPosition();
    if (moves && joints_[body.joint].type == JointType::PRISMATIC) {
      motion.p_slope = motion.R * joints_[body.joint].axis;
    } else if (moves) {
      motion.turns = true;
      const Vector3d& a = joints_[body.joint].axis;
      const Matrix3d R_PJ = body.X_PJ.linear();
      Matrix3d cross;
      cross << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
      motion.R = R_PJ * (a * a.transpose());
      motion.R_cos = R_PJ * (Matrix3d::Identity() - a * a.transpose());
      motion.R_sin = R_PJ * cross;
    }
    motions_.push_back(motion);
  }
}

std::shared_ptr<const RobotModel> RobotModel::withElements(
    const std::function<std::vector<Element>(const Link&)>& elements,
    const std::function<std::vector<std::string>(const Link&)>& missing) const {
  std::shared_ptr<RobotModel> copy(new RobotModel(*this));
  for (Link& link : copy->links_) {
    link.elements = elements(link);
    if (missing) link.missing = missing(link);
  }
  return copy;
}

std::shared_ptr<const RobotModel> RobotModel::merge(const std::vector<Placed>& robots) {
  std::shared_ptr<RobotModel> all(new RobotModel);
  for (const Placed& robot : robots) {
    if (!isPose(robot.X_WR)) {
      throw InputError("robot '" + robot.model->name() +
                       "': X_WR is not a rotation and a translation in finite numbers");
    }
    all->append(robot);
  }
  all->indexNames();
  if (all->link_ids_.size() < all->links_.size() || all->joint_ids_.size() < all->joints_.size()) {
    throw InputError("robots '" + all->name_ +
                     "' have links or joints of the same name; give each a different prefix");
  }
  all->groupIntoBodies();
  // A robot has one root, or as many as it was merged of.
  std::size_t root = 0;
  std::vector<Eigen::Isometry3d> X_WR;
  for (const Placed& robot : robots) {
    for (const Body& body : robot.model->bodies_) {
      if (body.joint < 0) X_WR.push_back(robot.X_WR * body.X_PJ);
    }
  }
  for (Body& body : all->bodies_) {
    if (body.joint < 0) body.X_PJ = X_WR[root++];
  }
  return all;
}

void RobotModel::append(const Placed& robot) {
  const int first_link = static_cast<int>(links_.size());
  const int first_joint = static_cast<int>(joints_.size());
  for (Link link : robot.model->links_) {
    link.name = withPrefix(robot.prefix, link.name);
    if (link.parent_joint >= 0) link.parent_joint += first_joint;
    links_.push_back(std::move(link));
  }
  for (Joint joint : robot.model->joints_) {
    joint.name = withPrefix(robot.prefix, joint.name);
    joint.parent_link += first_link;
    joint.child_link += first_link;
    if (joint.mimic) joint.mimic->joint += first_joint;
    joints_.push_back(std::move(joint));
  }
  warnings_.insert(warnings_.end(), robot.model->warnings_.begin(), robot.model->warnings_.end());
  name_ += (name_.empty() ? "" : "', '") + withPrefix(robot.prefix, robot.model->name_);
}

int RobotModel::findLink(const std::string& name) const {
  const auto found = link_ids_.find(name);
  return found == link_ids_.end() ? -1 : found->second;
}

int RobotModel::findJoint(const std::string& name) const {
  const auto found = joint_ids_.find(name);
  return found == joint_ids_.end() ? -1 : found->second;
}

std::vector<std::pair<int, int>> RobotModel::adjacentLinks() const {
  std::vector<std::pair<int, int>> pairs;
  std::vector<int> with_geometry;  // by link: itself, or its nearest ancestor; parents come first
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const int joint = links_[i].parent_joint;
    const int above = joint < 0 ? -1 : with_geometry[joints_[joint].parent_link];
    with_geometry.push_back(links_[i].has_geometry ? static_cast<int>(i) : above);
    if (links_[i].has_geometry && above >= 0) pairs.emplace_back(above, static_cast<int>(i));
  }
  return pairs;
}

std::vector<double> RobotModel::zeroPositions() const {
  std::vector<double> positions(joints_.size(), 0.0);
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    if (joints_[i].hasLimits()) {
      positions[i] = std::clamp(0.0, joints_[i].lower, joints_[i].upper);
    }
  }
  applyMimics(positions);
  return positions;
}

std::vector<double> RobotModel::unnamedPositions() const {
  std::vector<double> positions = zeroPositions();
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    if (joints_[i].leader_missing) positions[i] = std::numeric_limits<double>::quiet_NaN();
  }
  applyMimics(positions);
  return positions;
}

void RobotModel::refuse(std::size_t nb_positions) const {
  throw InputError(std::to_string(nb_positions) + " joint positions, but the robot has " +
                   std::to_string(joints_.size()) +
                   " joints: one for each is needed, fixed joints included");
}

void RobotModel::applyMimics(std::vector<double>& positions) const {
  requireOneEntryPerJoint(positions);
  // A chain of mimic joints is followed to the leading joint; the reader refuses cycles.
  const std::function<double(int)> position = [&](int joint) -> double {
    const auto& mimic = joints_[joint].mimic;
    return mimic ? mimic->multiplier * position(mimic->joint) + mimic->offset : positions[joint];
  };
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    if (joints_[i].mimic) positions[i] = position(static_cast<int>(i));
  }
}

void RobotModel::forwardKinematics(const std::vector<double>& positions,
                                   std::vector<Isometry3d>& X_RB) const {
  forwardKinematics(positions, {}, X_RB);
}

void RobotModel::forwardKinematics(const std::vector<double>& positions,
                                   const std::vector<std::optional<Isometry3d>>& placed,
                                   std::vector<Isometry3d>& X_WB) const {
  requireOneEntryPerJoint(positions);
  X_WB.resize(bodies_.size(), Isometry3d::Identity());
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Body& body = bodies_[i];
    const bool is_placed = i < placed.size() && placed[i];
    if (body.joint < 0) {
      X_WB[i] = is_placed ? *placed[i] : body.X_PJ;
    } else if (is_placed) {
      X_WB[i] = X_WB[body.parent] * *placed[i];
    } else {
      placeBody(static_cast<int>(i), X_WB[body.parent], positions[body.joint], X_WB[i]);
    }
  }
}

void RobotModel::placeBody(int body, const Isometry3d& X_RP, double position,
                           Isometry3d& X_RB) const {
  const BodyMotion& motion = motions_[body];
  if (motion.turns) {
    const Matrix3d R_PB =
        motion.R + std::cos(position) * motion.R_cos + std::sin(position) * motion.R_sin;
    X_RB.linear().noalias() = X_RP.linear() * R_PB;
    X_RB.translation().noalias() = X_RP.linear() * motion.p;
  } else {
    X_RB.linear().noalias() = X_RP.linear() * motion.R;
    X_RB.translation().noalias() = X_RP.linear() * (motion.p + position * motion.p_slope);
  }
  X_RB.translation() += X_RP.translation();
  X_RB.makeAffine();
}

}  // namespace collision_pairs
