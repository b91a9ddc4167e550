// Verdicts of joint states, one by one by the exact check and by the batch.
#pragma once

#include <vector>

#include <gtest/gtest.h>

#include "collision_pairs/batch_check.h"

namespace collision_pairs {

class Verdicts {
 public:
  explicit Verdicts(const std::shared_ptr<const CollisionScene>& scene)
      : scene_(scene), detector_(scene), batch_(scene, 2) {
    settings_.verdict_only = true;
  }

  Verdict exact(const std::vector<double>& positions) {
    scene_->robot().forwardKinematics(positions, X_RB_);
    scene_->gatherPoses(X_RB_, poses_);
    return detector_.detect(poses_, settings_).verdict;
  }

  std::vector<Verdict> batch(const std::vector<std::vector<double>>& states) {
    std::vector<Verdict> verdicts(states.size());
    batch_.runJoints(
        states.size(), settings_, [&](std::size_t i, std::vector<double>& q) { q = states[i]; }, {},
        [&](std::size_t i, const CollisionReport& report) {
          verdicts[i] = report.verdict;
          EXPECT_EQ(report.in_collision, report.verdict != Verdict::FREE);
          for (const PairReport& pair : report.pairs) {
            EXPECT_TRUE(scene_->filter().allowed(pair.first, pair.second));
          }
          EXPECT_EQ(report.pairs.empty(), report.verdict != Verdict::COLLISION);
        });
    return verdicts;
  }

  BatchCheck& check() { return batch_; }
  CheckSettings& settings() { return settings_; }

 private:
  std::shared_ptr<const CollisionScene> scene_;
  CollisionDetector detector_;
  BatchCheck batch_;
  CheckSettings settings_;
  std::vector<Eigen::Isometry3d> X_RB_;
  BodyPoses poses_;
};

}  // namespace collision_pairs
