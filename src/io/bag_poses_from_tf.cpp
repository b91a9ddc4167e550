// bagPosesFromTf()
#include <algorithm>

#include "bag_poses.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;

/// Attached to a movable joint: the stamps of its transforms are those of the robot's motion.
bool isDriven(const Link& link, const RobotModel& robot) {
  return link.parent_joint >= 0 && robot.joints()[link.parent_joint].type != JointType::FIXED;
}

class BagPosesFromTf : public BagPoses {
 public:
  BagPosesFromTf(const BagContents& bag, const CollisionScene& scene,
                 const BagPosesOptions& options);

 private:
  void robotAt(StampNs stamp, std::vector<Isometry3d>& X_RB,
               std::vector<char>& known) const override;
  void noteMissing();
  void collectStamps();
  bool find(FramePoses& frames, int body, Eigen::Isometry3d& X_RB) const;
};

BagPosesFromTf::BagPosesFromTf(const BagContents& bag, const CollisionScene& scene,
                               const BagPosesOptions& options)
    : BagPoses(bag, scene, options) {
  source_ = "TF";
  noteMissing();
  collectStamps();
}

void BagPosesFromTf::noteMissing() {
  std::vector<std::string> missing;
  for (const SceneBody& body : scene_.bodies()) {
    if (body.body == 0) continue;
    if (frames_[body.body].empty())
      missing.push_back(body.link);
    else
      ++nb_known_;
  }
  if (frames_[0].empty()) nb_known_ = 0;
  if (missing.empty()) return;
  notes_.push_back("left out, because TF has no frame for them: " + joined(missing));
}

void BagPosesFromTf::collectStamps() {
  const RobotModel& robot = scene_.robot();
  for (const bool driven : {true, false}) {
    for (const Link& link : robot.links()) {
      const int frame = link.body == 0 ? -1 : frameOf(link.name);
      if (frame < 0 || tracks_.isStatic(frame) || isDriven(link, robot) != driven) continue;
      for (const auto& sample : tracks_.samples(frame)) stamps_.push_back(sample.stamp);
    }
    if (!stamps_.empty()) break;  // frames of fixed joints only if there are no others
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
  for (const Frame& frame : frames_[body]) {
    if (!frames.find(frame.frame, X_RL)) continue;
    X_RB = X_RL * frame.X_BL.inverse();
    return true;
  }
  return false;
}

void BagPosesFromTf::robotAt(StampNs stamp, std::vector<Isometry3d>& X_RB,
                             std::vector<char>& known) const {
  FramePoses frames(tracks_, stamp, max_gap_);
  X_RB.assign(frames_.size(), Isometry3d::Identity());
  known.assign(frames_.size(), 0);
  // From the root outwards. Links on fixed joints are one body, and the URDF gives their poses in
  // it, even before their transforms begin in the recording.
  for (std::size_t b = 0; b < frames_.size(); ++b) {
    known[b] = find(frames, static_cast<int>(b), X_RB[b]);
    if (!known[b]) continue;
    for (const Frame& frame : frames_[b]) frames.anchor(frame.frame, X_RB[b] * frame.X_BL);
    if (b > 0) continue;
    for (const Frame& frame : frames_[b]) frames.climbFrom(frame.frame);
  }
}

}  // namespace

std::unique_ptr<const BagPoses> bagPosesFromTf(const BagContents& bag, const CollisionScene& scene,
                                               const BagPosesOptions& options) {
  return std::make_unique<BagPosesFromTf>(bag, scene, options);
}

}  // namespace collision_pairs
