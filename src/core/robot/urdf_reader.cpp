// Converts urdfdom's model to ours. The only file that includes urdfdom.
#include <map>

#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include "collision_pairs/input_error.h"
#include "collision_pairs/robot_model.h"
#include "console_messages.h"
#include "urdf_checks.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;

Isometry3d toIsometry(const urdf::Pose& pose) {
  Isometry3d X = Isometry3d::Identity();
  X.translation() = Eigen::Vector3d(pose.position.x, pose.position.y, pose.position.z);
  X.linear() =
      Eigen::Quaterniond(pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z)
          .normalized()
          .toRotationMatrix();
  return X;
}

Eigen::Vector3d toVector(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

JointType toJointType(int type) {
  switch (type) {
    case urdf::Joint::REVOLUTE:
      return JointType::REVOLUTE;
    case urdf::Joint::CONTINUOUS:
      return JointType::CONTINUOUS;
    case urdf::Joint::PRISMATIC:
      return JointType::PRISMATIC;
    case urdf::Joint::FLOATING:
      return JointType::FLOATING;
    case urdf::Joint::PLANAR:
      return JointType::PLANAR;
    default:
      return JointType::FIXED;
  }
}

urdf::ModelInterfaceSharedPtr parseWithUrdfdom(const std::string& xml) {
  ConsoleMessages messages;
  urdf::ModelInterfaceSharedPtr model;
  std::string reason;
  try {
    model = urdf::parseURDF(xml);
  } catch (const std::exception& error) {
    reason = error.what();
  }
  if (!model) throw InputError("URDF: " + (reason.empty() ? messages.firstError() : reason));
  return model;
}

/// The links and joints of urdfdom's model, from the root outwards.
class UrdfReader {
 public:
  UrdfReader(const urdf::ModelInterface& source, const MeshLoader& load_mesh,
             std::vector<BrokenElement>* broken)
      : source_(source), load_mesh_(load_mesh), broken_(broken) {}

  std::shared_ptr<const RobotModel> read(std::vector<std::string> warnings,
                                         const std::set<std::string>& leader_missing) {
    addLink(*source_.getRoot());
    // Parents first; no recursion, so that a chain of any length is read.
    for (std::size_t i = 0; i < links_.size(); ++i) {
      for (const auto& joint : source_.getLink(links_[i].name)->child_joints) {
        addJoint(*joint, static_cast<int>(i));
      }
    }
    addMimics();
    for (Joint& joint : joints_) joint.leader_missing = leader_missing.count(joint.name) > 0;
    return RobotModel::fromParts(source_.getName(), std::move(links_), std::move(joints_),
                                 std::move(warnings));
  }

 private:
  void addLink(const urdf::Link& source) {
    Link link;
    link.name = source.name;
    link.has_geometry = !source.collision_array.empty();
    for (const auto& collision : source.collision_array) {
      try {
        link.elements.push_back({toShape(*collision->geometry), toIsometry(collision->origin)});
      } catch (const std::exception& error) {
        if (!broken_) throw InputError("URDF: link '" + source.name + "': " + error.what());
        broken_->push_back({source.name, error.what()});
      }
    }
    links_.push_back(std::move(link));
  }

  void addJoint(const urdf::Joint& source, int parent) {
    Joint joint;
    joint.name = source.name;
    joint.type = toJointType(source.type);
    joint.parent_link = parent;
    joint.child_link = static_cast<int>(links_.size());
    joint.X_PJ = toIsometry(source.parent_to_joint_origin_transform);
    const Eigen::Vector3d axis = toVector(source.axis);
    if (!axis.isZero(0.0)) joint.axis = axis.stableNormalized();  // 1e-200 0 0 is valid, too
    if (source.limits) {
      joint.lower = source.limits->lower;
      joint.upper = source.limits->upper;
    }
    addLink(*source_.getLink(source.child_link_name));
    joints_.push_back(std::move(joint));
  }

  void addMimics() {
    std::map<std::string, int> ids;
    for (const Joint& joint : joints_) ids.emplace(joint.name, ids.size());
    for (Joint& joint : joints_) {
      const auto& mimic = source_.getJoint(joint.name)->mimic;
      if (!mimic) continue;
      joint.mimic = Joint::Mimic{ids.at(mimic->joint_name), mimic->multiplier, mimic->offset};
    }
  }

  Shape toShape(const urdf::Geometry& geometry) const {
    const Shape shape = convert(geometry);
    validateShape(shape);
    return shape;
  }

  Shape convert(const urdf::Geometry& geometry) const {
    if (const auto* box = dynamic_cast<const urdf::Box*>(&geometry)) return Box{toVector(box->dim)};
    if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(&geometry)) {
      return Sphere{sphere->radius};
    }
    if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(&geometry)) {
      return Cylinder{cylinder->radius, cylinder->length};
    }
    const auto& mesh = dynamic_cast<const urdf::Mesh&>(geometry);
    return Mesh{load_mesh_(mesh.filename, toVector(mesh.scale))};
  }

  const urdf::ModelInterface& source_;
  const MeshLoader& load_mesh_;
  std::vector<BrokenElement>* broken_;
  std::vector<Link> links_;
  std::vector<Joint> joints_;
};

}  // namespace

std::shared_ptr<const RobotModel> RobotModel::fromUrdf(const std::string& xml,
                                                       const MeshLoader& load_mesh,
                                                       std::vector<BrokenElement>* broken) {
  std::vector<std::string> warnings;
  const CheckedUrdf checked = checkedUrdf(xml, warnings);
  const auto source = parseWithUrdfdom(checked.xml);
  return UrdfReader(*source, load_mesh, broken).read(std::move(warnings), checked.leader_missing);
}

}  // namespace collision_pairs
