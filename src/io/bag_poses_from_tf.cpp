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
  bool frameAt(StampNs stamp, const std::string& frame, Isometry3d& X_RF) const override;

 private:
  FoundBodies robotAt(StampNs stamp) const override;
  bool hasFrame(int body) const;
  void collectStamps();
  void countKnown();

  std::vector<char> all_;  ///< bodies of the robot
};

BagPosesFromTf::BagPosesFromTf(const BagContents& bag, const CollisionScene& scene,
                               const BagPosesOptions& options)
    : BagPoses(bag, scene, options), all_(scene.robot().bodies().size(), 1) {
  source_ = "TF";
  collectStamps();
  countKnown();
}

bool BagPosesFromTf::hasFrame(int body) const {
  const auto& links = scene_.robot().links();
  return std::any_of(links.begin(), links.end(), [&](const Link& link) {
    return link.body == body && robot_.frameOf(bag_.transforms, link.name) >= 0;
  });
}

void BagPosesFromTf::collectStamps() {
  const RobotModel& robot = scene_.robot();
  for (const bool driven : {true, false}) {
    for (const Link& link : robot.links()) {
      const int frame = link.body == 0 ? -1 : robot_.frameOf(bag_.transforms, link.name);
      if (frame < 0 || isDriven(link, robot) != driven) continue;
      const auto& stamps = bag_.stamps[static_cast<std::size_t>(frame)];
      stamps_.insert(stamps_.end(), stamps.begin(), stamps.end());
    }
    if (!stamps_.empty()) break;  // frames of fixed joints only if there are no others
  }
  finishStamps(stamps_);
}

/// Bodies that only /tf_static places do not count: joint states may know them.
void BagPosesFromTf::countKnown() {
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
  const std::vector<char> is_held = robot_.heldAt(bag_.transforms, stamps_.back());
  for (const SceneBody& body : scene_.bodies()) {
    if (body.body != 0 && hasFrame(body.body) && !is_held[body.body]) ++nb_known_;
  }
}

FoundBodies BagPosesFromTf::robotAt(StampNs stamp) const {
  return robot_.place(bag_.transforms, {Instant::AS_IT_ARRIVED, stamp}, all_);
}

bool BagPosesFromTf::frameAt(StampNs stamp, const std::string& frame, Isometry3d& X_RF) const {
  FramePoses::Known found;
  std::string why;
  if (!robot_.frameIn(bag_.transforms, {Instant::AT, stamp}, frame, found, why)) return false;
  X_RF = found.X_RF;
  return true;
}

}  // namespace

std::unique_ptr<const BagPoses> bagPosesFromTf(const BagContents& bag, const CollisionScene& scene,
                                               const BagPosesOptions& options) {
  return std::make_unique<BagPosesFromTf>(bag, scene, options);
}

}  // namespace collision_pairs
