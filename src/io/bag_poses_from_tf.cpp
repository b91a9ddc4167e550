#include "bag_poses_from_tf.h"

#include <algorithm>
#include <cmath>

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;

std::string withoutSlashes(std::string name) {
  while (!name.empty() && name.front() == '/') name.erase(0, 1);
  while (!name.empty() && name.back() == '/') name.pop_back();
  return name;
}

/// Hangs from a joint that moves: its transforms tell when the robot moved.
bool isDriven(const Link& link, const RobotModel& robot) {
  return link.parent_joint >= 0 && robot.joints()[link.parent_joint].type != JointType::FIXED;
}

}  // namespace

BagPosesFromTf::BagPosesFromTf(const BagContents& bag, const CollisionScene& scene,
                               const BagPosesOptions& options)
    : tracks_(bag.transforms),
      scene_(scene),
      prefix_(withoutSlashes(options.prefix)),
      max_gap_(std::llround(1e9 * options.max_gap)) {
  source_ = "TF";
  const RobotModel& robot = scene.robot();
  for (std::size_t b = 0; b < robot.bodies().size(); ++b) {
    bodies_.push_back(framesOf(robot, static_cast<int>(b)));
  }
  // A root that TF does not know by its name with the prefix may be there without ("world").
  const int bare_root = tracks_.findFrame(robot.links().front().name);
  if (bodies_[0].empty() && bare_root >= 0) {
    bodies_[0].push_back({bare_root, Isometry3d::Identity()});
  }
  noteMissing();
  collectStamps();
}

void BagPosesFromTf::noteMissing() {
  std::string missing;
  for (const SceneBody& body : scene_.bodies()) {
    if (body.body == 0) continue;
    if (bodies_[body.body].empty())
      missing += (missing.empty() ? "" : ", ") + body.link;
    else
      ++nb_known_;
  }
  if (bodies_[0].empty()) nb_known_ = 0;
  if (!missing.empty()) notes_.push_back("TF has no frame for, so left out: " + missing);
}

int BagPosesFromTf::frameOf(const std::string& link) const {
  if (prefix_.empty()) return tracks_.findFrame(link);
  const int frame = tracks_.findFrame(withPrefix(prefix_, link));
  return frame >= 0 ? frame : tracks_.findFrame(prefix_ + link);
}

std::vector<BagPosesFromTf::Frame> BagPosesFromTf::framesOf(const RobotModel& robot,
                                                            int body) const {
  std::vector<Frame> frames;
  for (const Link& link : robot.links()) {
    const int frame = link.body == body ? frameOf(link.name) : -1;
    if (frame >= 0) frames.push_back({frame, link.X_BL});
  }
  return frames;
}

void BagPosesFromTf::collectStamps() {
  const RobotModel& robot = scene_.robot();
  for (const bool driven : {true, false}) {
    for (const Link& link : robot.links()) {
      const int frame = link.body == 0 ? -1 : frameOf(link.name);
      if (frame < 0 || tracks_.isStatic(frame) || isDriven(link, robot) != driven) continue;
      for (const auto& sample : tracks_.samples(frame)) stamps_.push_back(sample.stamp);
    }
    if (!stamps_.empty()) break;  // frames of fixed joints only where there are no others
  }
  std::sort(stamps_.begin(), stamps_.end());
  stamps_.erase(std::unique(stamps_.begin(), stamps_.end()), stamps_.end());
}

bool BagPosesFromTf::find(FramePoses& frames, int body, Isometry3d& X_RB) const {
  if (body == 0) {
    X_RB = Isometry3d::Identity();
    return true;
  }
  Isometry3d X_RL;
  for (const Frame& frame : bodies_[body]) {
    if (!frames.find(frame.frame, X_RL)) continue;
    X_RB = X_RL * frame.X_BL.inverse();
    return true;
  }
  return false;
}

void BagPosesFromTf::at(StampNs stamp, BodyPoses& poses) const {
  FramePoses frames(tracks_, stamp, max_gap_);
  std::vector<Isometry3d> X_RB(bodies_.size(), Isometry3d::Identity());
  std::vector<char> known(bodies_.size(), 0);
  // From the root outwards. Links on fixed joints are one body: the URDF says where they stand in
  // it, also where the recording begins before their transforms do.
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    known[b] = find(frames, static_cast<int>(b), X_RB[b]);
    if (!known[b]) continue;
    for (const Frame& frame : bodies_[b]) frames.anchor(frame.frame, X_RB[b] * frame.X_BL);
    if (b > 0) continue;
    for (const Frame& frame : bodies_[b]) frames.climbFrom(frame.frame);
  }
  poses.resize(scene_.bodies().size());
  scene_.gatherPoses(X_RB, poses);
  for (std::size_t i = 0; i < poses.known.size(); ++i) {
    poses.known[i] = known[scene_.bodies()[i].body];
  }
}

}  // namespace collision_pairs
