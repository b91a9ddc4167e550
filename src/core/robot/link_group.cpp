#include "link_group.h"

#include <set>

#include "collision_pairs/input_error.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

class GroupReader {
 public:
  GroupReader(const Srdf& srdf, const RobotModel& robot)
      : srdf_(srdf), robot_(robot), moves_(robot.links().size(), 0) {}

  // Subgroups may refer to each other in a cycle.
  void add(const std::string& name) {
    if (!seen_.insert(name).second) return;
    const Srdf::Group& group = find(name);
    for (const std::string& link : group.links) addLink(link);
    for (const std::string& joint : group.joints) addJoint(joint);
    for (const auto& [base, tip] : group.chains) addChain(base, tip);
    for (const std::string& subgroup : group.subgroups) add(subgroup);
  }

  std::vector<int> moved() {
    while (spread()) continue;
    std::vector<int> moved;
    for (std::size_t i = 0; i < moves_.size(); ++i) {
      if (moves_[i]) moved.push_back(static_cast<int>(i));
    }
    return moved;
  }

 private:
  /// To what hangs on links that move, and to what mimics their joints; false: nothing new.
  bool spread() {
    bool is_new = false;
    for (const Joint& joint : robot_.joints()) {
      const bool moves = moves_[joint.parent_link] ||
                         (joint.mimic && moves_[robot_.joints()[joint.mimic->joint].child_link]);
      if (!moves || moves_[joint.child_link]) continue;
      moves_[joint.child_link] = 1;
      is_new = true;
    }
    return is_new;
  }

  const Srdf::Group& find(const std::string& name) const {
    std::vector<std::string> names;
    for (const Srdf::Group& group : srdf_.groups) {
      if (group.name == name) return group;
      names.push_back(group.name);
    }
    std::string error = "there is no group '" + name + "' in the SRDF of robot '" + robot_.name();
    error += names.empty() ? "', which has no groups"
                           : "'; did you mean '" + nearestName(name, names) + "'?";
    throw InputError(error);
  }

  void addLink(const std::string& name) {
    const int link = robot_.findLink(name);
    if (link >= 0) moves_[link] = 1;
  }

  void addJoint(const std::string& name) {
    const int joint = robot_.findJoint(name);
    if (joint >= 0) moves_[robot_.joints()[joint].child_link] = 1;
    for (const Srdf::VirtualJoint& virtual_joint : srdf_.virtual_joints) {
      if (virtual_joint.name == name) addLink(virtual_joint.child_link);
    }
  }

  // The joints from the base to the tip, which do not move the base itself.
  void addChain(const std::string& base, const std::string& tip) {
    const int stop = robot_.findLink(base);
    for (int link = robot_.findLink(tip); link >= 0 && link != stop;) {
      moves_[link] = 1;
      const int joint = robot_.links()[link].parent_joint;
      link = joint < 0 ? -1 : robot_.joints()[joint].parent_link;
    }
  }

  const Srdf& srdf_;
  const RobotModel& robot_;
  std::vector<char> moves_;  // by link
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
