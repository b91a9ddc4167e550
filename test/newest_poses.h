// A robot of three bodies, and a buffer of its transforms.
#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "demo_scene.h"
#include "refusal.h"
#include "robot_poses.h"

namespace collision_pairs {

/// The newest poses of a base, of an arm that slides on it with a tool fixed to the arm, and of a
/// wheel that spins on the tool.
class NewestPoses : public testing::Test {
 protected:
  static constexpr StampNs SECOND = 1000000000;

  void take(const std::string& parent, const std::string& child, double seconds,
            bool is_static = false) {
    const auto stamp = static_cast<StampNs>(seconds * 1e9);
    buffer_.take({parent, child, stamp, Eigen::Vector3d(1, 0, 0), Eigen::Quaterniond::Identity()},
                 is_static, "", 10 * SECOND);
  }
  /// As soon as it was measured, at `x`.
  static void send(TransformBuffer& buffer, const std::string& parent, const std::string& child,
                   double seconds, double x, const std::string& publisher) {
    const auto stamp = static_cast<StampNs>(seconds * 1e9);
    buffer.take({parent, child, stamp, Eigen::Vector3d(x, 0, 0), Eigen::Quaterniond::Identity()},
                false, publisher, stamp);
  }
  /// The arm on the base from 18 s to 19 s, by two nodes that contradict each other.
  static void makeArmSuspect(TransformBuffer& buffer) {
    for (const double later : {18.0, 18.5, 19.0}) {
      send(buffer, "base", "arm", later, 1.0, "/one");
      send(buffer, "base", "arm", later - 0.25, 9.0, "/two");
    }
  }
  FoundBodies found(const std::vector<std::string>& static_joints = {}) const {
    const RobotPoses poses(buffer_, *robot_, "base", static_joints);
    return poses.newest(10 * SECOND, std::vector<char>(poses.nbBodies(), 1));
  }
  std::string between(const std::string& target, const std::string& source,
                      StampNs stamp = 10 * SECOND) const {
    return refusal([&] { poseBetween(buffer_, target, source, {Instant::AT, stamp}); });
  }
  const std::shared_ptr<const RobotModel> robot_ = robotFrom(
      emptyLink("base") + emptyLink("arm") + emptyLink("tool") + emptyLink("wheel") +
      joint("slide", "prismatic", "base", "arm") + joint("flange", "fixed", "arm", "tool") +
      joint("spin", "continuous", "tool", "wheel"));
  TransformBuffer buffer_{PoseLimits{2.0, 1.0, 0.5}};
};

}  // namespace collision_pairs
