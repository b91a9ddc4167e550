// RobotModel::fromUrdf(): from the model of urdfdom to ours. What urdfdom lets pass and a check
// cannot use is refused, with its line; the tree is checked by RobotModel::fromParts().
#include <map>

#include "collision_pairs/robot_model.h"
#include "part_error.h"
#include "urdfdom_parser.h"
#include "user_text.h"
#include "xml_file.h"
#include "xml_names.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using tinyxml2::XMLElement;

Vector3d fromUrdfdom(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

Isometry3d fromUrdfdom(const urdf::Pose& pose) {
  Isometry3d X = Isometry3d::Identity();
  const urdf::Rotation& q = pose.rotation;
  X.translation() = fromUrdfdom(pose.position);
  X.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
  return X;
}

/// Empty for a mesh, which is loaded once all else is known to be sound.
std::optional<Shape> shapeOf(const urdf::Geometry& geometry, bool is_capsule) {
  switch (geometry.type) {
    case urdf::Geometry::BOX:
      return Box{fromUrdfdom(static_cast<const urdf::Box&>(geometry).dim)};
    case urdf::Geometry::SPHERE:
      return Sphere{static_cast<const urdf::Sphere&>(geometry).radius};
    case urdf::Geometry::CYLINDER: {
      const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
      if (is_capsule) return Capsule{cylinder.radius, cylinder.length};
      return Cylinder{cylinder.radius, cylinder.length};
    }
    case urdf::Geometry::MESH:
      break;
  }
  return std::nullopt;
}

JointType typeOf(const urdf::Joint& joint) {
  switch (joint.type) {
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

class UrdfReader {
 public:
  explicit UrdfReader(const std::string& xml) {
    robot_ = parseXml(document_, xml, "robot", URDF);
    warnings_ = checkNames(*robot_, urdfGrammar(), URDF);
    urdf_ = parseWithUrdfdom(*robot_);
    for (const char* tag : {"link", "joint"}) {
      for (const XMLElement* element : childrenOf(*robot_, tag)) {
        elements_[{tag, element->Attribute("name")}] = element;
      }
    }
    for (const auto& link : urdf_->links_) {
      collisions_[link.first] = childrenOf(*elements_.at({"link", link.first}), "collision");
    }
  }

  /// Without the elements.
  std::shared_ptr<const RobotModel> skeleton() {
    for (const auto& [name, link] : urdf_->links_) {
      checkShapes(*link);
      link_ids_[name] = static_cast<int>(links_.size());
      links_.emplace_back();
      links_.back().name = name;
      links_.back().has_geometry = !link->collision_array.empty();
    }
    for (const auto& [name, joint] : urdf_->joints_) {
      joint_ids_[name] = static_cast<int>(joints_.size());
      joints_.push_back(readJoint(*joint));
    }
    for (Joint& joint : joints_) readMimic(joint);
    noteBareVisuals();
    try {
      return RobotModel::fromParts(urdf_->getName(), std::move(links_), std::move(joints_),
                                   std::move(warnings_));
    } catch (const PartError& error) {
      const auto part = elements_.find({error.tag, error.name});
      failAt(part == elements_.end() ? *robot_ : *part->second, URDF, error.reason);
    }
  }

  /// As of <collision> in the link's order. Throws what `load_mesh` throws.
  Element element(const std::string& link, std::size_t index, const MeshLoader& load_mesh) const {
    const urdf::Collision& collision = *urdf_->links_.at(link)->collision_array[index];
    std::optional<Shape> shape = shapeOf(*collision.geometry, isCapsule(link, index));
    if (!shape) {
      const auto& mesh = static_cast<const urdf::Mesh&>(*collision.geometry);
      shape = Mesh{load_mesh(mesh.filename, fromUrdfdom(mesh.scale))};
      validateShape(*shape);
    }
    return {*shape, fromUrdfdom(collision.origin)};
  }

  std::size_t nbElements(const std::string& link) const {
    return urdf_->links_.at(link)->collision_array.size();
  }

 private:
  [[noreturn]] void fail(const XMLElement& element, const std::string& message) const {
    failAt(element, URDF, message);
  }

  const XMLElement& geometryOf(const std::string& link, std::size_t index) const {
    return *collisions_.at(link)[index]->FirstChildElement("geometry");
  }

  bool isCapsule(const std::string& link, std::size_t index) const {
    return geometryOf(link, index).FirstChildElement("capsule") != nullptr;
  }

  void checkShapes(const urdf::Link& link) const {
    const std::string owner = "link " + quoted(link.name) + ": ";
    for (std::size_t i = 0; i < link.collision_array.size(); ++i) {
      const urdf::Geometry& geometry = *link.collision_array[i]->geometry;
      const auto shape = shapeOf(geometry, isCapsule(link.name, i));
      try {
        if (shape) validateShape(*shape);
      } catch (const std::invalid_argument& error) {
        fail(geometryOf(link.name, i), owner + error.what());
      }
      if (shape) continue;
      const auto& mesh = static_cast<const urdf::Mesh&>(geometry);
      if (mesh.filename.empty()) fail(geometryOf(link.name, i), owner + "mesh: no filename");
      if ((fromUrdfdom(mesh.scale).array() == 0.0).any()) {
        fail(geometryOf(link.name, i), owner + "mesh: a scale of 0 flattens it");
      }
    }
  }

  Joint readJoint(const urdf::Joint& read) const {
    Joint joint;
    joint.name = read.name;
    joint.type = typeOf(read);
    joint.parent_link = link_ids_.at(read.parent_link_name);
    joint.child_link = link_ids_.at(read.child_link_name);
    joint.X_PJ = fromUrdfdom(read.parent_to_joint_origin_transform);
    if (joint.hasAxis()) joint.axis = fromUrdfdom(read.axis);
    if (read.limits) {
      joint.lower = read.limits->lower;
      joint.upper = read.limits->upper;
    }
    return joint;
  }

  /// A joint whose leader is missing becomes a joint of its own: one suspect link is no reason to
  /// check none.
  void readMimic(Joint& joint) {
    const auto& read = urdf_->joints_.at(joint.name)->mimic;
    if (!read) return;
    const XMLElement& mimic = *elements_.at({"joint", joint.name})->FirstChildElement("mimic");
    if (joint.type == JointType::FIXED) {
      warnings_.push_back(placed(
          mimic, URDF, "joint " + quoted(joint.name) + ": mimic on a fixed joint has no effect"));
      return;
    }
    const std::string why = joint.hasPosition() ? whyNoLeader(joint.name) : "";
    if (why.empty()) {
      const auto leader = joint_ids_.find(read->joint_name);
      joint.mimic = Joint::Mimic{leader == joint_ids_.end() ? -1 : leader->second, read->multiplier,
                                 read->offset};
      return;
    }
    warnings_.push_back(placed(mimic, URDF,
                               "joint " + quoted(joint.name) + " mimics " +
                                   quoted(read->joint_name) + ", " + why +
                                   ": it is taken as a joint of its own, unknown where its "
                                   "position is not given"));
    joint.leader_missing = true;
  }

  /// Why the joint cannot be led as its <mimic> says, or empty.
  std::string whyNoLeader(const std::string& joint) const {
    const urdf::Joint* next = urdf_->joints_.at(joint).get();
    for (std::size_t steps = 0; steps <= joints_.size() && next->mimic; ++steps) {
      const auto leader = joint_ids_.find(next->mimic->joint_name);
      const bool is_there = leader != joint_ids_.end();
      if (steps == 0 && !is_there) return "which does not exist";
      const bool moves = is_there && joints_[leader->second].hasPosition();
      if (steps == 0 && !moves) return "which has no position";
      if (!moves || joints_[leader->second].leader_missing) return "";  // it leads itself
      next = urdf_->joints_.at(leader->first).get();
      if (next->name == joint) return "which mimics it in turn";
    }
    return "";
  }

  /// Links that are drawn, but not checked, in one line.
  void noteBareVisuals() {
    std::vector<std::string> bare;
    std::size_t nb_visual = 0;
    for (const auto& [name, link] : urdf_->links_) {
      if (!elements_.at({"link", name})->FirstChildElement("visual")) continue;
      ++nb_visual;
      if (link->collision_array.empty()) bare.push_back(name);
    }
    if (bare.empty()) return;
    warnings_.push_back(std::to_string(bare.size()) + " of " + std::to_string(nb_visual) +
                        " links with a visual have no collision geometry, so nothing checks "
                        "them: " +
                        firstOf(bare));
  }

  tinyxml2::XMLDocument document_;
  const XMLElement* robot_;
  urdf::ModelInterfaceSharedPtr urdf_;
  std::map<std::pair<std::string, std::string>, const XMLElement*> elements_;  // by tag and name
  std::map<std::string, std::vector<const XMLElement*>> collisions_;           // by link
  std::map<std::string, int> link_ids_, joint_ids_;
  std::vector<Link> links_;
  std::vector<Joint> joints_;
  std::vector<std::string> warnings_;
};

}  // namespace

std::shared_ptr<const RobotModel> RobotModel::fromUrdf(const std::string& xml,
                                                       const MeshLoader& load_mesh,
                                                       std::vector<BrokenElement>* broken) {
  UrdfReader reader(xml);
  std::vector<std::string> missing;
  const auto elementsOf = [&](const Link& link) {
    std::vector<Element> elements;
    missing.clear();
    for (std::size_t i = 0; i < reader.nbElements(link.name); ++i) {
      try {
        elements.push_back(reader.element(link.name, i, load_mesh));
      } catch (const std::exception& error) {
        if (!broken) throw InputError("URDF: link '" + link.name + "': " + error.what());
        broken->push_back({link.name, error.what()});
        missing.push_back(error.what());
      }
    }
    return elements;
  };
  return reader.skeleton()->withElements(elementsOf, [&](const Link&) { return missing; });
}

}  // namespace collision_pairs
