#include "bag_poses.h"

#include <algorithm>
#include <set>

#include "collision_pairs/input_error.h"
#include "frame_names.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() > end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/// Attached to a movable joint: the stamps of its transforms are those of the robot's motion.
bool isDriven(const Link& link, const RobotModel& robot) {
  return link.parent_joint >= 0 && robot.joints()[link.parent_joint].type != JointType::FIXED;
}

class BagPosesFromTf : public BagPoses {
 public:
  BagPosesFromTf(const BagContents& bag, const CollisionScene& scene,
                 const BagPosesOptions& options)
      : BagPoses(bag, scene, options) {
    source_ = "TF";
    collectStamps();
    countKnown();
  }

 private:
  bool hasFrame(int body) const {
    const auto& links = scene_.robot().links();
    return std::any_of(links.begin(), links.end(), [&](const Link& link) {
      return link.body == body && robot_->frameOf(link.name) >= 0;
    });
  }

  void collectStamps() {
    const RobotModel& robot = scene_.robot();
    for (const bool driven : {true, false}) {
      for (const Link& link : robot.links()) {
        const int frame = link.body == 0 ? -1 : robot_->frameOf(link.name);
        if (frame < 0 || isDriven(link, robot) != driven) continue;
        const auto& stamps = bag_.stamps[static_cast<std::size_t>(frame)];
        stamps_.insert(stamps_.end(), stamps.begin(), stamps.end());
      }
      if (!stamps_.empty()) break;  // frames of fixed joints only if there are no others
    }
    finishStamps(stamps_);
  }

  /// Bodies that only /tf_static places do not count: joint states may know them.
  void countKnown() {
    std::vector<std::string> missing;
    std::size_t nb_named = 0;
    for (const SceneBody& body : scene_.bodies()) {
      if (body.body == 0) continue;
      if (hasFrame(body.body)) {
        ++nb_named;
      } else {
        missing.push_back(body.link);
      }
    }
    if (!hasFrame(0) || nb_named == 0) return;
    if (!missing.empty()) {
      notes_.push_back("left out, because TF has no frame for them: " + joined(missing));
    }
    if (stamps_.empty()) {
      why_none_ = "of its " + std::to_string(nb_named) +
                  " links on moving joints that TF names, /tf moves none: they are on /tf_static "
                  "only, and no joint states move them";
      return;
    }
    const std::vector<char> is_held = robot_->heldAt(stamps_.back());
    for (const SceneBody& body : scene_.bodies()) {
      if (body.body != 0 && hasFrame(body.body) && !is_held[body.body]) ++nb_known_;
    }
    if (nb_known_ == 0) {
      why_none_ = "where TF ends, /tf_static places all of its " + std::to_string(nb_named) +
                  " links on moving joints that TF names, and no joint states move them";
    }
  }
};

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
  for (const auto& [topic, positions] : bag.joints) {
    const std::string ns = topic.substr(0, topic.rfind('/'));
    if (ns.size() > 1) prefixes.insert(ns.substr(ns.front() == '/' ? 1 : 0));
  }
  return prefixes;
}

[[noreturn]] void refuse(const BagContents& bag, const CollisionScene& scene) {
  const RobotModel& robot = scene.robot();
  const auto moves = [](const SceneBody& body) { return body.body != 0; };
  if (std::none_of(scene.bodies().begin(), scene.bodies().end(), moves)) {
    throw InputError(
        "there is nothing to check: no link of robot '" + robot.name() +
        "' that moves is in a pair; links, group, pair_rules and the SRDF choose them");
  }
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
      all_(scene.robot().bodies().size(), 1) {
  place(bag.transforms, options.static_joints);
}

void BagPoses::place(const TransformBuffer& transforms,
                     const std::vector<std::string>& static_joints) {
  const RobotModel& robot = scene_.robot();
  robot_ = std::make_unique<const RobotPoses>(transforms, robot, robot.links().front().name,
                                              prefix_, static_joints);
}

std::vector<std::string> BagPoses::at(StampNs stamp, const std::vector<SceneBody>& bodies,
                                      BodyPoses& poses) const {
  const FoundBodies placed = robot_->place({Instant::AS_IT_ARRIVED, stamp}, all_);
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
  auto by_tf = std::make_unique<const BagPosesFromTf>(bag, scene, options);
  auto by_joints = bagPosesFromJoints(bag, scene, options);
  if (by_tf->nbKnown() == 0 && by_joints->nbKnown() == 0) {
    if (!by_tf->whyNone().empty()) {
      throw InputError("there is no stamp to check: " + by_tf->whyNone());
    }
    refuse(bag, scene);
  }
  if (by_tf->nbKnown() >= by_joints->nbKnown()) return by_tf;
  return by_joints;
}

}  // namespace collision_pairs
