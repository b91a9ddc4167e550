#include "link_group.h"

#include <set>

#include "collision_pairs/input_error.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

class GroupReader {
 public:
  GroupReader(const Srdf& srdf, const RobotModel& robot)
      : srdf_(srdf), robot_(robot), moves_(robot.joints().size(), 0) {}

  // Subgroups may refer to each other in a cycle.
  void add(const std::string& name) {
    if (!seen_.insert(name).second) return;
    const Srdf::Group& group = find(name);
    const std::string by = "group '" + name + "'";
    for (const std::string& link : group.links) moveAt(linkOf(link, by));
    for (const std::string& joint : group.joints) addJoint(joint, by);
    for (const auto& [base, tip] : group.chains) addChain(linkOf(base, by), linkOf(tip, by));
    for (const std::string& subgroup : group.subgroups) add(subgroup);
  }

  std::vector<int> moved() {
    while (addMimics()) continue;
    std::vector<char> is_moved(robot_.links().size(), 0);
    std::vector<int> moved;
    for (std::size_t i = 0; i < is_moved.size(); ++i) {  // parents come first
      const int joint = robot_.links()[i].parent_joint;
      is_moved[i] =
          joint < 0 ? root_moves_ : moves_[joint] || is_moved[robot_.joints()[joint].parent_link];
      if (is_moved[i]) moved.push_back(static_cast<int>(i));
    }
    return moved;
  }

 private:
  /// Those of joints that move; false: nothing new.
  bool addMimics() {
    bool is_new = false;
    for (std::size_t i = 0; i < moves_.size(); ++i) {
      const Joint& joint = robot_.joints()[i];
      if (moves_[i] || !joint.mimic || !moves_[joint.mimic->joint]) continue;
      moves_[i] = 1;
      is_new = true;
    }
    return is_new;
  }

  const Srdf::Group& find(const std::string& name) const {
    const Srdf::Group* found = nullptr;
    for (const Srdf::Group& group : srdf_.groups) {
      if (group.name != name) continue;
      if (found) {
        throw InputError("the SRDF of robot '" + robot_.name() + "' has two groups '" + name +
                         "'; rename one of them");
      }
      found = &group;
    }
    if (found) return *found;
    throw InputError(
        "there is no group '" + name + "' in the SRDF of robot '" + robot_.name() + "'" +
        (srdf_.groups.empty() ? ", which has no groups" : didYouMean(name, namesOf(srdf_.groups))));
  }

  /// What a misspelled name stands for would not be checked.
  [[noreturn]] void refuse(const std::string& what, const std::string& by, const std::string& name,
                           const std::vector<std::string>& known) const {
    throw InputError(by + " names " + what + " '" + name + "', which robot '" + robot_.name() +
                     "' does not have" + didYouMean(name, known));
  }

  int linkOf(const std::string& name, const std::string& by) const {
    const int found = robot_.findLink(name);
    if (found >= 0) return found;
    refuse("link", by, name, namesOf(robot_.links()));
  }

  void moveAt(int link) {
    const int joint = robot_.links()[link].parent_joint;
    (joint < 0 ? root_moves_ : moves_[joint]) = 1;
  }

  void addJoint(const std::string& name, const std::string& by) {
    const int joint = robot_.findJoint(name);
    if (joint >= 0) moves_[joint] = 1;
    std::vector<std::string> known = namesOf(srdf_.virtual_joints);
    for (const Srdf::VirtualJoint& virtual_joint : srdf_.virtual_joints) {
      if (virtual_joint.name != name) continue;
      moveAt(linkOf(virtual_joint.child_link, "virtual_joint '" + name + "'"));
    }
    if (joint >= 0 || contains(known, name)) return;
    for (const std::string& other : namesOf(robot_.joints())) known.push_back(other);
    refuse("joint", by, name, known);
  }

  // The joints from the base to the tip, which do not move the base itself.
  void addChain(int base, int tip) {
    for (int link = tip; link >= 0 && link != base;) {
      moveAt(link);
      const int joint = robot_.links()[link].parent_joint;
      link = joint < 0 ? -1 : robot_.joints()[joint].parent_link;
    }
  }

  const Srdf& srdf_;
  const RobotModel& robot_;
  std::vector<char> moves_;  // by joint
  char root_moves_ = 0;
  std::set<std::string> seen_;
};

}  // namespace

std::vector<int> linksMovedBy(const Srdf& srdf, const RobotModel& robot, const std::string& group) {
  GroupReader reader(srdf, robot);
  reader.add(group);
  std::vector<int> moved = reader.moved();
  if (moved.empty()) {
    throw InputError("group '" + group + "' moves no link of robot '" + robot.name() + "'");
  }
  return moved;
}

}  // namespace collision_pairs
