// RobotModel::fromUrdf(): checks everything that a collision check relies on, with the line of a
// fault. What it does not read (visuals, inertias, plugins, …) cannot make it fail.
#include <algorithm>
#include <cstring>
#include <map>
#include <set>

#include <urdf_model/pose.h>

#include "collision_pairs/input_error.h"
#include "collision_pairs/robot_model.h"
#include "user_text.h"
#include "xml_file.h"
#include "xml_names.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using tinyxml2::XMLElement;

const std::string WHAT = "URDF";

[[noreturn]] void fail(const XMLElement& element, const std::string& message) {
  failAt(element, WHAT, message);
}

std::string quoted(const std::string& text) { return "'" + text + "'"; }

struct Collision {
  Shape shape;
  std::string mesh_file;  ///< in place of the shape, unless it is empty
  Vector3d scale = Vector3d::Ones();
  Isometry3d X_LE = Isometry3d::Identity();
};

struct ReadLink {
  const XMLElement* xml;
  std::vector<Collision> collisions;
  int index = -1;  ///< in the order of names
};

struct ReadJoint {
  const XMLElement* xml;
  Joint joint;  ///< without the indices of other parts
  std::string parent, child;
  std::string leader;  ///< that it mimics; empty: none
  int index = -1;      ///< in the order of names
};

/// Everything read while walking the file once.
struct Tree {
  std::map<std::string, ReadLink> links;
  std::map<std::string, ReadJoint> joints;
  std::map<std::string, const ReadJoint*> above;  // by child link
  std::vector<std::string> warnings;
};

double readNumber(const XMLElement& element, const char* attribute, const std::string& owner) {
  const std::string text = requiredAttribute(element, attribute, WHAT, owner + ": ");
  double value = 0.0;
  if (!parseNumber(text, value)) {
    fail(element, owner + ": " + attribute + " " + quoted(text) + " is not a finite number");
  }
  return value;
}

double readSize(const XMLElement& element, const char* attribute, const std::string& owner) {
  const double size = readNumber(element, attribute, owner);
  if (size >= 0.0) return size;
  fail(element,
       owner + ": " + attribute + " " + quoted(element.Attribute(attribute)) + " is negative");
}

Vector3d readVector(const XMLElement& element, const char* attribute, const std::string& owner) {
  const std::string text = requiredAttribute(element, attribute, WHAT, owner + ": ");
  Vector3d value;
  if (!parseVector3(text, value)) {
    fail(element, owner + ": " + attribute + " " + quoted(text) + " must be three finite numbers");
  }
  return value;
}

Isometry3d readOrigin(const XMLElement& parent, const std::string& owner) {
  Isometry3d X = Isometry3d::Identity();
  const XMLElement* origin = parent.FirstChildElement("origin");
  if (origin == nullptr) return X;
  if (origin->Attribute("xyz")) X.translation() = readVector(*origin, "xyz", owner + ": origin");
  if (origin->Attribute("rpy")) {
    const Vector3d rpy = readVector(*origin, "rpy", owner + ": origin");
    urdf::Rotation q;
    q.setFromRPY(rpy[0], rpy[1], rpy[2]);
    X.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
  }
  return X;
}

bool isShape(const XMLElement& element) {
  const auto& shapes = urdfGrammar().at("geometry").read;
  return std::find(shapes.begin(), shapes.end(), element.Name()) != shapes.end();
}

/// <geometry> holds one shape, beside elements of other namespaces. Names the child that is no
/// shape, or else the second.
const XMLElement& onlyShape(const XMLElement& geometry, const std::string& owner) {
  std::vector<const XMLElement*> own;
  for (auto* child = geometry.FirstChildElement(); child; child = child->NextSiblingElement()) {
    if (std::strchr(child->Name(), ':') == nullptr) own.push_back(child);
  }
  if (own.empty()) fail(geometry, owner + ": <geometry> is empty");
  if (own.size() == 1) return *own[0];
  const auto stray = std::find_if_not(own.begin(), own.end(), [](auto* e) { return isShape(*e); });
  const XMLElement& named = stray == own.end() ? *own[1] : **stray;
  fail(named, owner + ": <geometry> holds one shape, and <" + named.Name() + "> is one too many");
}

Collision readCollision(const XMLElement& collision, const std::string& owner) {
  const XMLElement* geometry = collision.FirstChildElement("geometry");
  if (geometry == nullptr) fail(collision, owner + ": <collision> without <geometry>");
  if (const XMLElement* second = geometry->NextSiblingElement("geometry")) {
    fail(*second,
         owner + ": a second <geometry> in one <collision>; give it a <collision> of its own");
  }
  const XMLElement& shape = onlyShape(*geometry, owner);
  const std::string kind = shape.Name(), of_shape = owner + ": " + kind;
  Collision read;
  if (kind == "box") {
    const Vector3d size = readVector(shape, "size", of_shape);
    if ((size.array() < 0.0).any()) {
      fail(shape, of_shape + " size " + quoted(shape.Attribute("size")) + " is negative");
    }
    read.shape = Box{size};
  } else if (kind == "sphere") {
    read.shape = Sphere{readSize(shape, "radius", of_shape)};
  } else if (kind == "cylinder") {
    const double radius = readSize(shape, "radius", of_shape);
    read.shape = Cylinder{radius, readSize(shape, "length", of_shape)};
  } else if (kind == "capsule") {  // URDF 1.2; the length is that of the cylinder
    const double radius = readSize(shape, "radius", of_shape);
    read.shape = Capsule{radius, readSize(shape, "length", of_shape)};
  } else if (kind == "mesh") {
    read.mesh_file = requiredAttribute(shape, "filename", WHAT, of_shape + ": ");
    if (shape.Attribute("scale")) read.scale = readVector(shape, "scale", of_shape);
    if ((read.scale.array() == 0.0).any()) {
      fail(shape, of_shape + ": scale " + quoted(shape.Attribute("scale")) + " flattens the mesh");
    }
  } else {
    fail(shape, owner + ": unknown shape <" + kind +
                    ">; box, sphere, cylinder, capsule and mesh are known");
  }
  read.X_LE = readOrigin(collision, owner);
  return read;
}

void readLink(const XMLElement& element, Tree& tree) {
  const std::string name = requiredAttribute(element, "name", WHAT);
  const auto [link, is_new] = tree.links.try_emplace(name, ReadLink{&element, {}, -1});
  if (!is_new) fail(element, "a second link " + quoted(name));
  for (const XMLElement* collision : childrenOf(element, "collision")) {
    link->second.collisions.push_back(readCollision(*collision, "link " + quoted(name)));
  }
}

JointType readType(const XMLElement& joint, const std::string& owner) {
  static const std::map<std::string, JointType> TYPES = {
      {"fixed", JointType::FIXED},           {"revolute", JointType::REVOLUTE},
      {"continuous", JointType::CONTINUOUS}, {"prismatic", JointType::PRISMATIC},
      {"floating", JointType::FLOATING},     {"planar", JointType::PLANAR}};
  const std::string type = requiredAttribute(joint, "type", WHAT, owner + ": ");
  const auto found = TYPES.find(type);
  if (found == TYPES.end()) fail(joint, owner + ": unknown joint type " + quoted(type));
  return found->second;
}

void readLimits(const XMLElement& xml, const std::string& owner, Joint& joint) {
  const XMLElement* limit = xml.FirstChildElement("limit");
  if (limit == nullptr && joint.hasLimits()) fail(xml, owner + " has no <limit>");
  if (limit == nullptr) return;
  if (limit->Attribute("lower")) joint.lower = readNumber(*limit, "lower", owner);
  if (limit->Attribute("upper")) joint.upper = readNumber(*limit, "upper", owner);
  if (joint.hasLimits() && joint.lower > joint.upper) {
    fail(*limit, owner + ": its lower limit is above its upper limit");
  }
}

void readAxis(const XMLElement& xml, const std::string& owner, Joint& joint) {
  const XMLElement* element = xml.FirstChildElement("axis");
  const bool has_axis = joint.hasPosition() || joint.type == JointType::PLANAR;
  if (element == nullptr || !has_axis) return;
  const Vector3d axis = readVector(*element, "xyz", owner + ": axis");
  if (axis.isZero(0.0)) fail(*element, owner + ": its axis is zero");
  joint.axis = axis.stableNormalized();  // 1e-200 0 0 is valid, too
}

void readMimic(const XMLElement& xml, const std::string& of_joint, ReadJoint& read, Tree& tree) {
  const XMLElement* mimic = xml.FirstChildElement("mimic");
  if (mimic == nullptr) return;
  const std::string owner = of_joint + ": mimic";
  if (read.joint.type == JointType::FIXED) {
    tree.warnings.push_back(placed(*mimic, WHAT, owner + " on a fixed joint has no effect"));
    return;
  }
  if (!read.joint.hasPosition()) {
    fail(*mimic,
         owner + ": a " + xml.Attribute("type") + " joint has no position that could follow");
  }
  read.leader = requiredAttribute(*mimic, "joint", WHAT, owner + ": ");
  read.joint.mimic = Joint::Mimic{-1, 1.0, 0.0};
  if (mimic->Attribute("multiplier")) {
    read.joint.mimic->multiplier = readNumber(*mimic, "multiplier", owner);
  }
  if (mimic->Attribute("offset")) read.joint.mimic->offset = readNumber(*mimic, "offset", owner);
}

void readJoint(const XMLElement& element, Tree& tree) {
  const std::string name = requiredAttribute(element, "name", WHAT);
  const std::string owner = "joint " + quoted(name);
  const auto [entry, is_new] = tree.joints.try_emplace(name);
  if (!is_new) fail(element, "a second " + owner);
  ReadJoint& read = entry->second;
  read.xml = &element;
  read.joint.name = name;
  read.joint.type = readType(element, owner);
  for (auto [tag, link] : {std::pair("parent", &read.parent), std::pair("child", &read.child)}) {
    const XMLElement* end = element.FirstChildElement(tag);
    if (end == nullptr) fail(element, owner + " has no <" + tag + ">");
    *link = requiredAttribute(*end, "link", WHAT, owner + ": ");
  }
  const auto [above, is_first] = tree.above.try_emplace(read.child, &read);
  if (!is_first) {
    fail(element, "link " + quoted(read.child) + " has two parents, joints " +
                      quoted(above->second->joint.name) + " and " + quoted(name));
  }
  read.joint.X_PJ = readOrigin(element, owner);
  readLimits(element, owner, read.joint);
  readAxis(element, owner, read.joint);
  readMimic(element, owner, read, tree);
}

void checkEndsExist(const Tree& tree) {
  for (const auto& [child, joint] : tree.above) {
    for (const std::string& link : {child, joint->parent}) {
      if (tree.links.count(link) > 0) continue;
      fail(*joint->xml, "joint " + quoted(joint->joint.name) + " names link " + quoted(link) +
                            ", which does not exist");
    }
  }
}

void checkOneRoot(const Tree& tree, const XMLElement& robot) {
  std::string root;
  for (const auto& [name, link] : tree.links) {
    if (tree.above.count(name)) continue;
    if (!root.empty()) {
      fail(*link.xml,
           "two root links, " + quoted(root) + " and " + quoted(name) + "; join one to the other");
    }
    root = name;
  }
  if (root.empty()) fail(robot, "no root link: the links form a cycle");
}

// With one root and one parent per link, a link whose ancestors do not include the root is on, or
// below, a cycle.
void checkNoCycle(const Tree& tree) {
  std::set<std::string> reaches_root;
  for (const auto& [name, its] : tree.links) {
    std::set<std::string> path;
    std::string link = name;
    while (reaches_root.count(link) == 0) {
      if (!path.insert(link).second) {
        fail(*its.xml, "link " + quoted(name) + " is part of, or attached to, a cycle of links");
      }
      const auto above = tree.above.find(link);
      if (above == tree.above.end()) break;
      link = above->second->parent;
    }
    reaches_root.merge(path);
  }
}

/// Why the joint cannot be led as its <mimic> says, or empty.
std::string whyNoLeader(const Tree& tree, const ReadJoint& joint) {
  const auto found = tree.joints.find(joint.leader);
  if (found == tree.joints.end()) return "which does not exist";
  const ReadJoint* next = &found->second;
  if (!next->joint.hasPosition()) return "which has no position";
  for (std::size_t steps = 0; steps <= tree.joints.size() && next != &joint; ++steps) {
    const auto above = tree.joints.find(next->leader);
    if (above == tree.joints.end()) return "";
    next = &above->second;
  }
  return next == &joint ? "which mimics it in turn" : "";
}

/// A joint whose leader is missing becomes a joint of its own: one link in doubt is no reason to
/// check none.
void freeOfMissingLeaders(Tree& tree) {
  for (auto& [name, read] : tree.joints) {
    const std::string why = read.leader.empty() ? "" : whyNoLeader(tree, read);
    if (why.empty()) continue;
    tree.warnings.push_back(placed(*read.xml, WHAT,
                                   "joint " + quoted(name) + " mimics " + quoted(read.leader) +
                                       ", " + why +
                                       ": it is taken as a joint of its own, unknown where its "
                                       "position is not given"));
    read.leader.clear();
    read.joint.mimic.reset();
    read.joint.leader_missing = true;
  }
}

/// Links that are drawn, but not checked, in one line.
void noteBareVisuals(Tree& tree) {
  std::vector<std::string> bare;
  std::size_t nb_visual = 0;
  for (const auto& [name, link] : tree.links) {
    if (link.xml->FirstChildElement("visual") == nullptr) continue;
    ++nb_visual;
    if (link.collisions.empty()) bare.push_back(name);
  }
  if (bare.empty()) return;
  constexpr std::size_t MOST_NAMED = 10;
  const std::size_t nb_bare = bare.size();
  if (nb_bare > MOST_NAMED) {
    bare.resize(MOST_NAMED);
    bare.push_back("and " + std::to_string(nb_bare - MOST_NAMED) + " more");
  }
  tree.warnings.push_back(std::to_string(nb_bare) + " of " + std::to_string(nb_visual) +
                          " links with a visual have no collision geometry, so nothing checks "
                          "them: " +
                          joined(bare));
}

Tree readTree(const XMLElement& robot, std::vector<std::string> warnings) {
  Tree tree;
  tree.warnings = std::move(warnings);
  for (const XMLElement* link : childrenOf(robot, "link")) readLink(*link, tree);
  if (tree.links.empty()) fail(robot, "the robot has no <link>");
  for (const XMLElement* joint : childrenOf(robot, "joint")) readJoint(*joint, tree);
  checkEndsExist(tree);
  checkOneRoot(tree, robot);
  checkNoCycle(tree);
  freeOfMissingLeaders(tree);
  noteBareVisuals(tree);
  return tree;
}

/// Without the elements: meshes are loaded once all else is known to be sound.
std::shared_ptr<const RobotModel> skeletonOf(const std::string& name, Tree& tree) {
  std::vector<Link> links;
  for (auto& [link_name, read] : tree.links) {
    read.index = static_cast<int>(links.size());
    links.emplace_back();
    links.back().name = link_name;
    links.back().has_geometry = !read.collisions.empty();
  }
  int next = 0;
  for (auto& entry : tree.joints) entry.second.index = next++;
  std::vector<Joint> joints;
  for (const auto& [joint_name, read] : tree.joints) {
    joints.push_back(read.joint);
    joints.back().parent_link = tree.links.at(read.parent).index;
    joints.back().child_link = tree.links.at(read.child).index;
    if (read.joint.mimic) joints.back().mimic->joint = tree.joints.at(read.leader).index;
  }
  return RobotModel::fromParts(name, std::move(links), std::move(joints), std::move(tree.warnings));
}

}  // namespace

std::shared_ptr<const RobotModel> RobotModel::fromUrdf(const std::string& xml,
                                                       const MeshLoader& load_mesh,
                                                       std::vector<BrokenElement>* broken) {
  tinyxml2::XMLDocument document;
  const XMLElement* robot = parseXml(document, xml, "robot", WHAT);
  std::vector<std::string> warnings = checkNames(*robot, urdfGrammar(), WHAT);
  const std::string name = requiredAttribute(*robot, "name", WHAT);
  Tree tree = readTree(*robot, std::move(warnings));
  return skeletonOf(name, tree)->withElements([&](const Link& link) {
    std::vector<Element> elements;
    for (Collision& read : tree.links.at(link.name).collisions) {
      try {
        if (!read.mesh_file.empty()) read.shape = Mesh{load_mesh(read.mesh_file, read.scale)};
        validateShape(read.shape);
        elements.push_back({read.shape, read.X_LE});
      } catch (const std::exception& error) {
        if (!broken) throw InputError("URDF: link '" + link.name + "': " + error.what());
        broken->push_back({link.name, error.what()});
      }
    }
    return elements;
  });
}

}  // namespace collision_pairs
