#include "bag_poses.h"

#include <set>

#include "collision_pairs/input_error.h"

namespace collision_pairs {
namespace {

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() > end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/// What stands before the robot's link names in the bag's frames, should it have a prefix.
std::set<std::string> possiblePrefixes(const BagContents& bag, const RobotModel& robot) {
  std::set<std::string> prefixes;
  for (const std::string& frame : bag.transforms.frames()) {
    for (const Link& link : robot.links()) {
      if (endsWith(frame, "/" + link.name)) {
        prefixes.insert(frame.substr(0, frame.size() - link.name.size() - 1));
      }
    }
  }
  for (const auto& [topic, tracks] : bag.joints) {
    const std::string ns = topic.substr(0, topic.rfind('/'));
    if (ns.size() > 1) prefixes.insert(ns.substr(ns.front() == '/' ? 1 : 0));
  }
  return prefixes;
}

[[noreturn]] void refuse(const BagContents& bag, const RobotModel& robot) {
  std::string hint;
  for (const std::string& prefix : possiblePrefixes(bag, robot)) {
    hint += (hint.empty() ? "; try --prefix " : " or ") + prefix;
  }
  throw InputError("neither its transforms nor its joint states say anything about robot '" +
                   robot.name() + "'" + hint);
}

}  // namespace

std::unique_ptr<const BagPoses> makeBagPoses(const BagContents& bag, const CollisionScene& scene,
                                             const BagPosesOptions& options) {
  auto by_tf = bagPosesFromTf(bag, scene, options);
  auto by_joints = bagPosesFromJoints(bag, scene, options);
  if (by_tf->nbKnown() == 0 && by_joints->nbKnown() == 0) refuse(bag, scene.robot());
  if (by_tf->nbKnown() >= by_joints->nbKnown()) return by_tf;
  return by_joints;
}

}  // namespace collision_pairs
