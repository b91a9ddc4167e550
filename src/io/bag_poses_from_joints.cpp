// bagPosesFromJoints()
#include <algorithm>
#include <cmath>
#include <set>

#include "bag_poses.h"
#include "frame_names.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

/// Number of joints of the robot that a topic names, with `prefix` before their names.
std::size_t nbNamed(const JointTracks& tracks, const RobotModel& robot, const std::string& prefix) {
  return static_cast<std::size_t>(
      std::count_if(robot.joints().begin(), robot.joints().end(),
                    [&](const Joint& joint) { return tracks.has(prefix + joint.name); }));
}

/// The topic, and the prefix of the joints' names in it.
struct Choice {
  const std::string* topic = nullptr;
  const JointTracks* tracks = nullptr;
  std::string prefix;
  std::size_t nb_named = 0;
};

void offer(Choice& best, const std::string& topic, const JointTracks& tracks,
           const RobotModel& robot, const std::string& prefix) {
  const std::size_t count = nbNamed(tracks, robot, prefix);
  if (count > best.nb_named) best = {&topic, &tracks, prefix, count};
}

Choice choose(const BagContents& bag, const RobotModel& robot, const std::string& prefix) {
  Choice best;
  for (const auto& [topic, tracks] : bag.joints) {
    const bool is_own =
        topic == "/" + prefix + "/joint_states" || topic == prefix + "/joint_states";
    const bool is_common = topic == "/joint_states" || topic == "joint_states";
    // Without a prefix, a namespace tells one robot from another: only the one without is plain.
    if (prefix.empty() ? is_common || bag.joints.size() == 1 : is_own) {
      offer(best, topic, tracks, robot, "");
    }
    if (prefix.empty()) continue;
    offer(best, topic, tracks, robot, withPrefix(prefix, ""));
    offer(best, topic, tracks, robot, prefix);
  }
  return best;
}

class BagPosesFromJoints : public BagPoses {
 public:
  BagPosesFromJoints(const BagContents& bag, const CollisionScene& scene,
                     const BagPosesOptions& options)
      : BagPoses(bag, scene, options),
        tracks_(scene.robot().joints().size(), nullptr),
        zero_(scene.robot().zeroPositions()) {
    const Choice choice = choose(bag, scene.robot(), prefix_);
    if (!choice.tracks) return;
    source_ = "joint states of " + *choice.topic;
    chooseTracks(*choice.tracks, choice.prefix);
    countKnown();
    noteJointsAtZero();
    collectStamps();
  }

  /// A link, or a frame that the bag's transforms connect to one.
  bool frameAt(StampNs stamp, const std::string& frame, Eigen::Isometry3d& X_RF) const override {
    const FoundBodies placed = robotAt(stamp);
    const std::string name = withoutLeadingSlash(frame);
    for (const Link& link : scene_.robot().links()) {
      if (!isFrameOf(link.name, prefix_, name) || !placed.known[link.body]) continue;
      X_RF = placed.X_WB[link.body] * link.X_BL;
      return true;
    }
    const TransformBuffer& transforms = bag_.transforms;
    const int number = transforms.findFrame(name);
    if (number < 0) return false;
    FramePoses frames(transforms, {Instant::AT, stamp});
    for (const Link& link : scene_.robot().links()) {
      const int of_link = robot_.frameOf(link.name);
      if (of_link < 0 || !placed.known[link.body]) continue;
      frames.anchor(of_link, {placed.X_WB[link.body] * link.X_BL});
    }
    FramePoses::Known found;
    if (!frames.find(number, found)) return false;
    X_RF = found.X_RF;
    return true;
  }

 private:
  FoundBodies robotAt(StampNs stamp) const override {
    const RobotModel& robot = scene_.robot();
    const auto& joints = robot.joints();
    std::vector<double> positions = zero_;
    std::vector<std::string> whys(joints.size());
    for (std::size_t i = 0; i < joints.size(); ++i) {
      if (!tracks_[i]) continue;
      const bool is_continuous = joints[i].type == JointType::CONTINUOUS;
      if (!JointTracks::lookUp(*tracks_[i], stamp, bag_.transforms.limits(), is_continuous,
                               positions[i], whys[i])) {
        positions[i] = zero_[i];
      }
    }
    robot.applyMimics(positions);
    FoundBodies placed;
    robot.forwardKinematics(positions, placed.X_WB);

    placed.known.assign(robot.bodies().size(), 1);
    placed.problems.resize(robot.bodies().size());
    for (std::size_t b = 0; b < robot.bodies().size(); ++b) {
      const Body& body = robot.bodies()[b];
      if (body.joint < 0) continue;
      int driver = body.joint;
      while (joints[driver].mimic) driver = joints[driver].mimic->joint;
      placed.known[b] = placed.known[body.parent] && whys[driver].empty();
      placed.problems[b] = placed.known[body.parent]
                               ? "joint '" + joints[driver].name + "': " + whys[driver]
                               : placed.problems[body.parent];
    }
    return placed;
  }

  void chooseTracks(const JointTracks& tracks, const std::string& prefix) {
    const auto& joints = scene_.robot().joints();
    for (std::size_t i = 0; i < joints.size(); ++i) {
      if (!joints[i].hasPosition() || joints[i].mimic) continue;
      const auto found = tracks.joints().find(prefix + joints[i].name);
      if (found != tracks.joints().end()) tracks_[i] = &found->second;
    }
  }

  void countKnown() {
    const auto& bodies = scene_.robot().bodies();
    for (const SceneBody& scene_body : scene_.bodies()) {
      int body = scene_body.body;
      while (bodies[body].joint >= 0 && !tracks_[bodies[body].joint]) body = bodies[body].parent;
      if (bodies[body].joint >= 0) ++nb_known_;
    }
  }

  void noteJointsAtZero() {
    const auto& joints = scene_.robot().joints();
    const auto& bodies = scene_.robot().bodies();
    std::set<std::string> names;
    for (const SceneBody& scene_body : scene_.bodies()) {
      for (int body = scene_body.body; bodies[body].joint >= 0; body = bodies[body].parent) {
        int driver = bodies[body].joint;
        while (joints[driver].mimic) driver = joints[driver].mimic->joint;
        if (!tracks_[driver]) names.insert(joints[driver].name);
      }
    }
    joints_at_zero_.assign(names.begin(), names.end());
    if (names.empty()) return;
    notes_.push_back("joints that it does not name are taken as zero: " + joined(joints_at_zero_));
  }

  void collectStamps() {
    for (const JointTracks::OfJoint* joint : tracks_) {
      if (joint) stamps_.insert(stamps_.end(), joint->stamps.begin(), joint->stamps.end());
    }
    finishStamps(stamps_);
  }

  /// By joint; null: it stays at zero, or mimics another.
  std::vector<const JointTracks::OfJoint*> tracks_;
  std::vector<double> zero_;
};

}  // namespace

std::unique_ptr<const BagPoses> bagPosesFromJoints(const BagContents& bag,
                                                   const CollisionScene& scene,
                                                   const BagPosesOptions& options) {
  return std::make_unique<BagPosesFromJoints>(bag, scene, options);
}

}  // namespace collision_pairs
