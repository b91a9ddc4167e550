#include "urdf_checks.h"

#include <array>
#include <map>
#include <set>

#include "collision_pairs/input_error.h"
#include "user_text.h"
#include "xml_file.h"

namespace collision_pairs {
namespace {

using tinyxml2::XMLElement;

const std::string WHAT = "URDF";

[[noreturn]] void fail(const XMLElement& element, const std::string& message) {
  failAt(element, WHAT, message);
}

std::string quoted(const std::string& text) { return "'" + text + "'"; }

/// Everything read while walking the file once.
struct Tree {
  std::map<std::string, const XMLElement*> links;
  std::map<std::string, const XMLElement*> joints;
  std::map<std::string, std::string> parent_of;    // link by child link
  std::map<std::string, const XMLElement*> above;  // joint by child link
  std::map<std::string, std::string> mimic_of;     // joint by mimicking joint
  std::vector<std::string> warnings;
};

double checkNumber(const XMLElement& element, const char* attribute, const std::string& owner) {
  const std::string text = requiredAttribute(element, attribute, WHAT, owner + ": ");
  double value = 0.0;
  if (!parseNumber(text, value)) {
    fail(element, owner + ": " + attribute + " " + quoted(text) + " is not a finite number");
  }
  return value;
}

void checkSize(const XMLElement& element, const char* attribute, const std::string& owner) {
  if (checkNumber(element, attribute, owner) < 0.0) {
    fail(element,
         owner + ": " + attribute + " " + quoted(element.Attribute(attribute)) + " is negative");
  }
}

Eigen::Vector3d checkVector(const XMLElement& element, const char* attribute,
                            const std::string& owner) {
  const std::string text = requiredAttribute(element, attribute, WHAT, owner + ": ");
  Eigen::Vector3d value;
  if (!parseVector3(text, value)) {
    fail(element, owner + ": " + attribute + " " + quoted(text) + " must be three finite numbers");
  }
  return value;
}

void checkOrigin(const XMLElement& parent, const std::string& owner) {
  const XMLElement* origin = parent.FirstChildElement("origin");
  if (origin == nullptr) return;
  for (const char* attribute : {"xyz", "rpy"}) {
    if (origin->Attribute(attribute)) checkVector(*origin, attribute, owner + ": origin");
  }
}

void checkMesh(const XMLElement& mesh, const std::string& owner) {
  requiredAttribute(mesh, "filename", WHAT, owner + ": ");
  if (mesh.Attribute("scale") && (checkVector(mesh, "scale", owner).array() == 0.0).any()) {
    fail(mesh, owner + ": scale " + quoted(mesh.Attribute("scale")) + " flattens the mesh");
  }
}

bool isShape(const XMLElement& element) {
  const std::string kind = element.Name();
  return kind == "box" || kind == "sphere" || kind == "cylinder" || kind == "mesh";
}

/// <geometry> holds one shape and nothing else. Names the child that is no shape, or else the
/// second.
const XMLElement& onlyShape(const XMLElement& geometry, const std::string& owner) {
  const XMLElement* first = geometry.FirstChildElement();
  if (first == nullptr) fail(geometry, owner + ": <geometry> is empty");
  const XMLElement* second = first->NextSiblingElement();
  if (second == nullptr) return *first;
  const XMLElement* stray = first;
  while (stray != nullptr && isShape(*stray)) stray = stray->NextSiblingElement();
  if (stray == nullptr) stray = second;
  fail(*stray, owner + ": <geometry> holds one shape, and <" + stray->Name() + "> is one too many");
}

void checkGeometry(const XMLElement& collision, const std::string& owner) {
  const XMLElement* geometry = collision.FirstChildElement("geometry");
  if (geometry == nullptr) fail(collision, owner + ": <collision> without <geometry>");
  const XMLElement* shape = &onlyShape(*geometry, owner);
  const std::string kind = shape->Name();
  if (kind == "box") {
    if ((checkVector(*shape, "size", owner + ": box").array() < 0.0).any()) {
      fail(*shape, owner + ": box size " + quoted(shape->Attribute("size")) + " is negative");
    }
  } else if (kind == "sphere") {
    checkSize(*shape, "radius", owner + ": sphere");
  } else if (kind == "cylinder") {
    checkSize(*shape, "radius", owner + ": cylinder");
    checkSize(*shape, "length", owner + ": cylinder");
  } else if (kind == "mesh") {
    checkMesh(*shape, owner + ": mesh");
  } else {
    fail(*shape,
         owner + ": unknown shape <" + kind + ">; box, sphere, cylinder and mesh are known");
  }
}

void readLink(const XMLElement& element, Tree& tree) {
  const std::string name = requiredAttribute(element, "name", WHAT);
  if (!tree.links.emplace(name, &element).second) fail(element, "a second link " + quoted(name));
  for (auto* collision = element.FirstChildElement("collision"); collision;
       collision = collision->NextSiblingElement("collision")) {
    checkGeometry(*collision, "link " + quoted(name));
    checkOrigin(*collision, "link " + quoted(name));
  }
}

void checkLimits(const XMLElement& joint, const std::string& owner) {
  const XMLElement* limit = joint.FirstChildElement("limit");
  if (limit == nullptr) fail(joint, owner + " has no <limit>");
  const double lower = limit->Attribute("lower") ? checkNumber(*limit, "lower", owner) : 0.0;
  const double upper = limit->Attribute("upper") ? checkNumber(*limit, "upper", owner) : 0.0;
  if (lower > upper) fail(*limit, owner + ": its lower limit is above its upper limit");
}

void checkMotion(const XMLElement& joint, const std::string& type, const std::string& owner) {
  static const std::set<std::string> TYPES = {"fixed",     "revolute", "continuous",
                                              "prismatic", "floating", "planar"};
  if (TYPES.count(type) == 0) fail(joint, owner + ": unknown joint type " + quoted(type));
  if (type == "revolute" || type == "prismatic") checkLimits(joint, owner);
  const XMLElement* axis = joint.FirstChildElement("axis");
  if (axis && type != "fixed" && type != "floating" &&
      checkVector(*axis, "xyz", owner + ": axis").isZero(0.0)) {
    fail(*axis, owner + ": its axis is zero");
  }
}

void readMimic(const XMLElement& joint, const std::string& name, const std::string& type,
               Tree& tree) {
  const XMLElement* mimic = joint.FirstChildElement("mimic");
  if (mimic == nullptr) return;
  const std::string owner = "joint " + quoted(name) + ": mimic";
  if (type == "fixed") {
    tree.warnings.push_back(placed(*mimic, WHAT, owner + " on a fixed joint has no effect"));
    return;
  }
  if (type != "revolute" && type != "continuous" && type != "prismatic") {
    fail(*mimic, owner + ": a " + type + " joint has no position that could follow");
  }
  tree.mimic_of[name] = requiredAttribute(*mimic, "joint", WHAT, owner + ": ");
  for (const char* attribute : {"multiplier", "offset"}) {
    if (mimic->Attribute(attribute)) checkNumber(*mimic, attribute, owner);
  }
}

void readJoint(const XMLElement& element, Tree& tree) {
  const std::string name = requiredAttribute(element, "name", WHAT);
  const std::string owner = "joint " + quoted(name);
  if (!tree.joints.emplace(name, &element).second) fail(element, "a second " + owner);
  const std::string type = requiredAttribute(element, "type", WHAT, owner + ": ");
  std::array<std::string, 2> ends;
  const std::array<const char*, 2> tags = {"parent", "child"};
  for (int i = 0; i < 2; ++i) {
    const XMLElement* end = element.FirstChildElement(tags[i]);
    if (end == nullptr) fail(element, owner + " has no <" + tags[i] + ">");
    ends[i] = requiredAttribute(*end, "link", WHAT, owner + ": ");
  }
  if (!tree.parent_of.emplace(ends[1], ends[0]).second) {
    fail(element, "link " + quoted(ends[1]) + " has two parents, joints " +
                      quoted(tree.above[ends[1]]->Attribute("name")) + " and " + quoted(name));
  }
  tree.above[ends[1]] = &element;
  checkOrigin(element, owner);
  checkMotion(element, type, owner);
  readMimic(element, name, type, tree);
}

void checkEndsExist(const Tree& tree) {
  for (const auto& [child, joint] : tree.above) {
    for (const std::string& link : {child, tree.parent_of.at(child)}) {
      if (tree.links.count(link) == 0) {
        fail(*joint, "joint " + quoted(joint->Attribute("name")) + " names link " + quoted(link) +
                         ", which does not exist");
      }
    }
  }
}

void checkOneRoot(const Tree& tree, const XMLElement& robot) {
  std::string root;
  for (const auto& [name, element] : tree.links) {
    if (tree.parent_of.count(name)) continue;
    if (!root.empty()) {
      fail(*element,
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
  for (const auto& [name, element] : tree.links) {
    std::set<std::string> path;
    std::string link = name;
    while (reaches_root.count(link) == 0) {
      if (!path.insert(link).second) {
        fail(*element, "link " + quoted(name) + " is part of, or attached to, a cycle of links");
      }
      const auto parent = tree.parent_of.find(link);
      if (parent == tree.parent_of.end()) break;
      link = parent->second;
    }
    reaches_root.merge(path);
  }
}

/// Why the joint cannot be led as its <mimic> says, or empty.
std::string whyNoLeader(const Tree& tree, const std::string& joint) {
  static const std::set<std::string> MOVING = {"revolute", "continuous", "prismatic"};
  const std::string& leader = tree.mimic_of.at(joint);
  const auto found = tree.joints.find(leader);
  if (found == tree.joints.end()) return "which does not exist";
  if (MOVING.count(found->second->Attribute("type")) == 0) return "which has no position";
  std::string next = leader;
  for (std::size_t steps = 0; steps <= tree.mimic_of.size() && next != joint; ++steps) {
    const auto above = tree.mimic_of.find(next);
    if (above == tree.mimic_of.end()) return "";
    next = above->second;
  }
  return next == joint ? "which mimics it in turn" : "";
}

/// A joint whose leader is missing becomes a joint of its own: one link in doubt is no reason to
/// check none.
std::set<std::string> freeOfMissingLeaders(Tree& tree) {
  std::set<std::string> freed;
  for (auto entry = tree.mimic_of.begin(); entry != tree.mimic_of.end();) {
    const auto& [joint, leader] = *entry;
    const std::string why = whyNoLeader(tree, joint);
    if (why.empty()) {
      ++entry;
      continue;
    }
    tree.warnings.push_back(placed(*tree.joints.at(joint), WHAT,
                                   "joint " + quoted(joint) + " mimics " + quoted(leader) + ", " +
                                       why + ": it is taken as a joint of its own, unknown where "
                                             "its position is not given"));
    freed.insert(joint);
    entry = tree.mimic_of.erase(entry);
  }
  return freed;
}

void keepOnly(XMLElement& parent, const std::set<std::string>& names) {
  for (XMLElement* child = parent.FirstChildElement(); child;) {
    XMLElement* next = child->NextSiblingElement();
    if (names.count(child->Name()) == 0) parent.DeleteChild(child);
    child = next;
  }
}

// urdfdom requires attributes of <limit> that no collision check reads.
void completeLimit(XMLElement& joint) {
  XMLElement* limit = joint.FirstChildElement("limit");
  if (limit == nullptr) return;
  limit->SetAttribute("effort", "0");
  limit->SetAttribute("velocity", "0");
}

void reduce(XMLElement& robot, const Tree& tree) {
  keepOnly(robot, {"link", "joint"});
  robot.DeleteAttribute("version");
  for (XMLElement* child = robot.FirstChildElement(); child; child = child->NextSiblingElement()) {
    if (child->Name() == std::string("link")) {
      keepOnly(*child, {"collision"});
    } else {
      std::set<std::string> kept = {"origin", "parent", "child", "axis", "limit"};
      if (tree.mimic_of.count(child->Attribute("name")) > 0) kept.insert("mimic");
      keepOnly(*child, kept);
      completeLimit(*child);
    }
  }
}

}  // namespace

CheckedUrdf checkedUrdf(const std::string& xml, std::vector<std::string>& warnings) {
  tinyxml2::XMLDocument document;
  XMLElement* robot = parseXml(document, xml, "robot", WHAT);
  requiredAttribute(*robot, "name", WHAT);
  Tree tree;
  for (auto* link = robot->FirstChildElement("link"); link;
       link = link->NextSiblingElement("link")) {
    readLink(*link, tree);
  }
  if (tree.links.empty()) fail(*robot, "the robot has no <link>");
  for (auto* joint = robot->FirstChildElement("joint"); joint;
       joint = joint->NextSiblingElement("joint")) {
    readJoint(*joint, tree);
  }
  checkEndsExist(tree);
  checkOneRoot(tree, *robot);
  checkNoCycle(tree);
  const std::set<std::string> freed = freeOfMissingLeaders(tree);
  reduce(*robot, tree);
  warnings.insert(warnings.end(), tree.warnings.begin(), tree.warnings.end());
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  return {printer.CStr(), freed};
}

}  // namespace collision_pairs
