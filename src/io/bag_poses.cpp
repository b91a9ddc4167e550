#include "bag_poses.h"

#include <cmath>
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
    : tracks_(bag.transforms),
      scene_(scene),
      prefix_(withoutSlashes(options.prefix)),
      max_gap_(std::llround(1e9 * options.max_gap)) {
  const RobotModel& robot = scene.robot();
  for (std::size_t b = 0; b < robot.bodies().size(); ++b) {
    frames_.push_back(framesOf(static_cast<int>(b)));
  }
  // A root that TF does not have under its prefixed name may be there without prefix ("world").
  const int bare_root = tracks_.findFrame(robot.links().front().name);
  if (frames_[0].empty() && bare_root >= 0) {
    frames_[0].push_back({bare_root, Eigen::Isometry3d::Identity()});
  }
}

int BagPoses::frameOf(const std::string& link) const {
  if (prefix_.empty()) return tracks_.findFrame(link);
  const int frame = tracks_.findFrame(withPrefix(prefix_, link));
  return frame >= 0 ? frame : tracks_.findFrame(prefix_ + link);
}

std::vector<BagPoses::Frame> BagPoses::framesOf(int body) const {
  std::vector<Frame> frames;
  for (const Link& link : scene_.robot().links()) {
    const int frame = link.body == body ? frameOf(link.name) : -1;
    if (frame >= 0) frames.push_back({frame, link.X_BL});
  }
  return frames;
}

void BagPoses::at(StampNs stamp, const std::vector<SceneBody>& bodies, BodyPoses& poses) const {
  std::vector<Eigen::Isometry3d> X_RB;
  std::vector<char> known;
  robotAt(stamp, X_RB, known);
  poses.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    poses.X_WB[i] = X_RB[bodies[i].body];
    poses.known[i] = known[bodies[i].body];
  }
}

bool BagPoses::frameAt(StampNs stamp, const std::string& frame, Eigen::Isometry3d& X_RF) const {
  std::vector<Eigen::Isometry3d> X_RB;
  std::vector<char> known;
  robotAt(stamp, X_RB, known);
  const std::string name = withoutLeadingSlash(frame);
  for (const Link& link : scene_.robot().links()) {
    const bool is_it = name == withPrefix(prefix_, link.name) || name == prefix_ + link.name;
    if (!is_it || !known[link.body]) continue;
    X_RF = X_RB[link.body] * link.X_BL;
    return true;
  }
  const int number = tracks_.findFrame(name);
  if (number < 0) return false;
  FramePoses frames(tracks_, stamp, max_gap_);
  for (std::size_t b = 0; b < frames_.size(); ++b) {
    if (!known[b]) continue;
    for (const Frame& of_link : frames_[b]) frames.anchor(of_link.frame, X_RB[b] * of_link.X_BL);
  }
  for (const Frame& of_root : frames_[0]) frames.climbFrom(of_root.frame);
  return frames.find(number, X_RF);
}

std::unique_ptr<const BagPoses> makeBagPoses(const BagContents& bag, const CollisionScene& scene,
                                             const BagPosesOptions& options) {
  auto by_tf = bagPosesFromTf(bag, scene, options);
  auto by_joints = bagPosesFromJoints(bag, scene, options);
  if (by_tf->nbKnown() == 0 && by_joints->nbKnown() == 0) refuse(bag, scene.robot());
  if (by_tf->nbKnown() >= by_joints->nbKnown()) return by_tf;
  return by_joints;
}

}  // namespace collision_pairs
