// RobotModel::fromParts(): checks links and joints, and numbers them from the root outwards.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "collision_pairs/robot_model.h"
#include "part_error.h"
#include "pose_repair.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;

constexpr double UNIT = 2e-15;  // rounding of a unit axis: of its squared length

bool isWithin(int index, std::size_t size) {
  return index >= 0 && static_cast<std::size_t>(index) < size;
}

std::string outOf(const std::string& what, int index, std::size_t size) {
  return "there is no " + what + " " + std::to_string(index) + ": they are numbered from 0 to " +
         std::to_string(static_cast<long>(size) - 1);
}

/// Throws InputError that names the link or joint that is wrong.
class PartsCheck {
 public:
  PartsCheck(const std::string& robot, const std::vector<Link>& links,
             const std::vector<Joint>& joints)
      : robot_(robot), links_(links), joints_(joints), joint_above_(links.size(), -1) {}

  /// Returns the root.
  int run() {
    requireNames(links_, "link");
    requireNames(joints_, "joint");
    for (const Link& link : links_) checkElements(link);
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      checkEnds(static_cast<int>(i));
      checkMotion(joints_[i], "joint " + quoted(joints_[i].name) + ": ");
    }
    for (const Joint& joint : joints_) {
      if (joint.mimic) checkMimic(joint, "joint " + quoted(joint.name) + ": ");
    }
    return onlyRoot();
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw PartError("robot", robot_, robot_, message);
  }
  [[noreturn]] void fail(const Link& link, const std::string& message) const {
    throw PartError("link", link.name, robot_, message);
  }
  [[noreturn]] void fail(const Joint& joint, const std::string& message) const {
    throw PartError("joint", joint.name, robot_, message);
  }

  template <class Part>
  void requireNames(const std::vector<Part>& parts, const std::string& kind) const {
    std::unordered_map<std::string, std::size_t> ids;
    for (const Part& part : parts) {
      if (part.name.empty()) fail(kind + " " + std::to_string(ids.size()) + " has no name");
      if (!ids.emplace(part.name, ids.size()).second)
        fail(part, "a second " + kind + " " + quoted(part.name));
    }
  }

  template <class Part>
  void requirePose(const Isometry3d& X, const Part& part, const std::string& what) const {
    if (!isPose(X)) fail(part, what + " is not a rotation and a translation in finite numbers");
  }

  void checkElements(const Link& link) const {
    const std::string where = "link " + quoted(link.name) + ": ";
    for (std::size_t i = 0; i < link.elements.size(); ++i) {
      try {
        validateShape(link.elements[i].shape);
      } catch (const std::invalid_argument& error) {
        fail(link, where + error.what());
      }
      requirePose(link.elements[i].X_LE, link, where + "X_LE of element " + std::to_string(i));
    }
  }

  void checkEnds(int index) {
    const Joint& joint = joints_[index];
    for (const int link : {joint.parent_link, joint.child_link}) {
      if (!isWithin(link, links_.size())) {
        fail(joint, "joint " + quoted(joint.name) + ": " + outOf("link", link, links_.size()));
      }
    }
    int& above = joint_above_[joint.child_link];
    if (above >= 0) {
      fail(joint, "link " + quoted(links_[joint.child_link].name) + " has two parents, joints " +
                      quoted(joints_[above].name) + " and " + quoted(joint.name));
    }
    above = index;
  }

  void checkMotion(const Joint& joint, const std::string& where) const {
    requirePose(joint.X_PJ, joint, where + "X_PJ");
    if (joint.hasAxis() && !(joint.axis.allFinite() && !joint.axis.isZero(0.0))) {
      fail(joint, where + "its axis is zero, or not finite");
    }
    if (!joint.hasLimits()) return;
    if (!std::isfinite(joint.lower) || !std::isfinite(joint.upper)) {
      fail(joint, where + "its limits are not finite");
    }
    if (joint.lower > joint.upper) fail(joint, where + "its lower limit is above its upper limit");
  }

  void checkMimic(const Joint& joint, const std::string& where) const {
    const Joint::Mimic& mimic = *joint.mimic;
    if (!joint.hasPosition())
      fail(joint, where + "it mimics another, but has no position that could follow");
    if (!isWithin(mimic.joint, joints_.size())) {
      fail(joint, where + "what it mimics: " + outOf("joint", mimic.joint, joints_.size()));
    }
    if (!std::isfinite(mimic.multiplier) || !std::isfinite(mimic.offset)) {
      fail(joint, where + "multiplier or offset of its mimic is not finite");
    }
    const Joint* leader = &joints_[mimic.joint];
    if (!leader->hasPosition()) {
      fail(joint, where + "it mimics " + quoted(leader->name) + ", which has no position");
    }
    for (std::size_t steps = 0; leader->mimic && isWithin(leader->mimic->joint, joints_.size());
         ++steps) {
      if (steps > joints_.size()) {
        fail(joint, where + "it mimics " + quoted(joints_[mimic.joint].name) +
                        ", which is part of a circle of mimics");
      }
      leader = &joints_[leader->mimic->joint];
    }
  }

  int onlyRoot() const {
    int root = -1;
    for (std::size_t i = 0; i < links_.size(); ++i) {
      if (joint_above_[i] >= 0) continue;
      if (root >= 0) {
        fail(links_[i], "two root links, " + quoted(links_[root].name) + " and " +
                            quoted(links_[i].name) +
                            "; join one to the other, or make them two robots of one scene");
      }
      root = static_cast<int>(i);
    }
    if (root < 0) fail(links_.empty() ? "it has no link" : "no root link: the links form a cycle");
    return root;
  }

  const std::string& robot_;
  const std::vector<Link>& links_;
  const std::vector<Joint>& joints_;
  std::vector<int> joint_above_;  // by link
};

/// Indices of links and joints from the root outwards. Joint k of these is above link k + 1.
struct Order {
  std::vector<int> links, joints;
};

Order orderFrom(int root, const std::vector<Joint>& joints, std::size_t nb_links) {
  std::vector<std::vector<int>> below(nb_links);  // joints, by parent link
  for (std::size_t i = 0; i < joints.size(); ++i) {
    below[joints[i].parent_link].push_back(static_cast<int>(i));
  }
  Order order;
  order.links.push_back(root);
  for (std::size_t i = 0; i < order.links.size(); ++i) {
    for (const int joint : below[order.links[i]]) {
      order.joints.push_back(joint);
      order.links.push_back(joints[joint].child_link);
    }
  }
  return order;
}

/// The new index of each old one; -1 where there is none.
std::vector<int> inverseOf(const std::vector<int>& order, std::size_t size) {
  std::vector<int> new_index(size, -1);
  for (std::size_t i = 0; i < order.size(); ++i) new_index[order[i]] = static_cast<int>(i);
  return new_index;
}

}  // namespace

std::shared_ptr<const RobotModel> RobotModel::fromParts(std::string name, std::vector<Link> links,
                                                        std::vector<Joint> joints,
                                                        std::vector<std::string> warnings) {
  const Order order = orderFrom(PartsCheck(name, links, joints).run(), joints, links.size());
  const std::vector<int> new_link = inverseOf(order.links, links.size());
  const std::vector<int> new_joint = inverseOf(order.joints, joints.size());
  // With one root and one parent for each link, what the root does not reach hangs on a cycle.
  const auto lost = std::find(new_link.begin(), new_link.end(), -1);
  if (lost != new_link.end()) {
    const std::string& link = links[lost - new_link.begin()].name;
    throw PartError("link", link, name,
                    "link " + quoted(link) + " is part of, or attached to, a cycle of links");
  }
  std::shared_ptr<RobotModel> model(new RobotModel);
  for (const int old : order.links) {
    Link& link = links[old];
    link.parent_joint = static_cast<int>(model->links_.size()) - 1;
    link.has_geometry |= !link.elements.empty();
    model->links_.push_back(std::move(link));
  }
  for (const int old : order.joints) {
    Joint& joint = joints[old];
    joint.parent_link = new_link[joint.parent_link];
    joint.child_link = new_link[joint.child_link];
    if (joint.mimic) joint.mimic->joint = new_joint[joint.mimic->joint];
    const bool is_unit = std::abs(joint.axis.squaredNorm() - 1.0) <= UNIT;
    if (joint.hasAxis() && !is_unit) joint.axis.stableNormalize();  // also 1e-200 0 0
    model->joints_.push_back(std::move(joint));
  }
  model->name_ = std::move(name);
  model->warnings_ = std::move(warnings);
  model->indexNames();
  model->groupIntoBodies();
  return model;
}

}  // namespace collision_pairs
