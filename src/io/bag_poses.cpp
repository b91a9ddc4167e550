#include "bag_poses.h"

#include <algorithm>
#include <set>

#include "collision_pairs/input_error.h"
#include "frame_names.h"

namespace collision_pairs {
namespace {

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() > end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/// The prefix of the robot's link names in the bag's frames, if there is one.
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
  throw InputError("neither its transforms nor its joint states mention robot '" + robot.name() +
                   "'" + hint);
}

}  // namespace

BagPoses::BagPoses(const BagContents& bag, const CollisionScene& scene,
                   const BagPosesOptions& options)
    : bag_(bag),
      scene_(scene),
      prefix_(withoutSlashes(options.prefix)),
      robot_(scene.robot(), scene.robot().links().front().name, prefix_, options.static_joints) {}

std::vector<std::string> BagPoses::at(StampNs stamp, const std::vector<SceneBody>& bodies,
                                      BodyPoses& poses) const {
  const FoundBodies placed = robotAt(stamp);
  std::vector<std::string> problems;
  poses.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const int body = bodies[i].body;
    poses.X_WB[i] = placed.X_WB[body];
    poses.known[i] = placed.known[body];
    if (!placed.known[body]) {
      problems.push_back("link '" + bodies[i].link + "': " + placed.problems[body]);
    }
  }
  return problems;
}

void finishStamps(std::vector<StampNs>& stamps) {
  std::sort(stamps.begin(), stamps.end());
  stamps.erase(std::unique(stamps.begin(), stamps.end()), stamps.end());
}

std::unique_ptr<const BagPoses> makeBagPoses(const BagContents& bag, const CollisionScene& scene,
                                             const BagPosesOptions& options) {
  auto by_tf = bagPosesFromTf(bag, scene, options);
  auto by_joints = bagPosesFromJoints(bag, scene, options);
  if (by_tf->nbKnown() == 0 && by_joints->nbKnown() == 0) {
    const std::string why = by_tf->whyNone().empty() ? by_joints->whyNone() : by_tf->whyNone();
    if (!why.empty()) throw InputError("there is no stamp to check: " + why);
    refuse(bag, scene.robot());
  }
  if (by_tf->nbKnown() >= by_joints->nbKnown()) return by_tf;
  return by_joints;
}

}  // namespace collision_pairs
