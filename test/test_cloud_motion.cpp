// Motions past clouds of points are certified as those past the same boxes.
#include <gtest/gtest.h>

#include "collision_pairs/closing_motion.h"
#include "collision_pairs/collision_detector.h"
#include "collision_pairs/occupied_voxels.h"
#include "motion_fixtures.h"
#include "random_inputs.h"

namespace collision_pairs::test_cloud_motion {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double VOXEL_SIZE = 0.05;

std::shared_ptr<const OccupiedVoxels> voxelsAt(const std::vector<VoxelCell>& cells) {
  return std::make_shared<const OccupiedVoxels>(VOXEL_SIZE, cells);
}

std::shared_ptr<const CollisionScene> sceneWithCloud(std::shared_ptr<const RobotModel> robot) {
  SceneDescription description = described(std::move(robot), {});
  description.clouds.push_back(cloudOf("cloud", VOXEL_SIZE, {}));
  return CollisionScene::build(description);
}

/// Two bars of 1 m, hinged.
std::shared_ptr<const RobotModel> arm() {
  return robotFrom(emptyLink("root") + bar("upper", 1.0) + bar("lower", 1.0) +
                   hinge("shoulder", "root", "upper", "0 0 0") +
                   hinge("elbow", "upper", "lower", "1 0 0.03"));
}

TEST(CloudMotion, WhatIsCertifiedIsFreeWhereverOneLooksAndAContactIsOne) {
  RandomInputs random;
  const auto scene = sceneWithCloud(arm());
  MotionCheck check(scene);
  CollisionDetector detector(scene);
  int nb[3] = {0, 0, 0};
  for (int round = 0; round < 150; ++round) {
    std::vector<VoxelCell> cells;
    for (int i = random.integer(1, 4); i > 0; --i) {
      const VoxelCell corner(random.integer(-35, 35), random.integer(-35, 35), -1);
      for (int k = 0; k < 6; ++k) cells.push_back(corner + VoxelCell(k % 3, 0, k / 3));
    }
    const CloudVoxels voxels = {voxelsAt(cells)};
    JointMotion motion;
    for (int j = 0; j < 2; ++j) {
      motion.from.push_back(random.uniform(-3.0, 3.0));
      motion.to.push_back(motion.from.back() + random.uniform(-1.0, 1.0));
    }
    MotionSettings settings;
    settings.clearance = round % 3 == 2 ? 0.02 : 0.0;
    settings.fidelity = round % 5 == 4 ? Fidelity::OBB : Fidelity::MESH;
    const MotionReport report = check.check(motion, settings, {}, voxels);
    ++nb[static_cast<int>(report.verdict)];
    CheckSettings exact;
    exact.fidelity = settings.fidelity;
    exact.alarm_distance = 0.0;
    exact.min_distance = true;
    BodyPoses poses;
    poses.voxels = voxels;
    double smallest = 1e300;
    const auto at = [&](double fraction) -> const CollisionReport& {
      std::vector<double> q = motion.from;
      for (std::size_t j = 0; j < q.size(); ++j) q[j] += fraction * (motion.to[j] - q[j]);
      std::vector<Isometry3d> X_RB;
      scene->robot().forwardKinematics(q, X_RB);
      scene->gatherPoses(X_RB, poses);
      const CollisionReport& found = detector.detect(poses, exact);
      smallest = std::min(smallest, found.min_distance);
      return found;
    };
    if (report.verdict == Verdict::COLLISION) {
      EXPECT_EQ(at(report.contact_at).verdict, Verdict::COLLISION);
      ASSERT_FALSE(report.pairs.empty());
      continue;
    }
    for (int i = 0; i <= 200; ++i) at(i / 200.0);
    if (report.verdict == Verdict::FREE) {
      EXPECT_GE(report.clearance, settings.clearance);
      EXPECT_GE(smallest, report.clearance - 1e-7);
      EXPECT_GT(smallest, 0.0);
    } else {
      EXPECT_LT(smallest, settings.clearance + 0.01) << "was not certified, but is far away";
    }
  }
  EXPECT_GT(nb[0], 10);
  EXPECT_GT(nb[1], 10);
}

TEST(CloudMotion, AWallOfOneVoxelIsNotPassedThrough) {
  const auto scene = sceneWithCloud(turningBar());
  const CloudVoxels wall = {voxelsAt({{16, 0, 0}})};
  const MotionReport report = MotionCheck(scene).check({{-1.0}, {1.3}}, {}, {}, wall);
  EXPECT_EQ(report.verdict, Verdict::COLLISION);
  ASSERT_EQ(report.pairs.size(), 1u);
  EXPECT_EQ(scene->models()[report.pairs[0].second].name, "cloud");
}

TEST(CloudMotion, WithoutAllVoxelsNothingIsCertifiedAndTheCloudIsNamed) {
  const auto scene = sceneWithCloud(turningBar());
  MotionCheck check(scene);
  const auto far = std::vector<OccupiedVoxels::Block>{{{400, 0, 0}, 1}};
  const auto in_part = std::make_shared<const OccupiedVoxels>(VOXEL_SIZE, far, true);
  for (const CloudVoxels& voxels : {CloudVoxels{}, CloudVoxels{nullptr}, CloudVoxels{in_part}}) {
    const MotionReport report = check.check({{-1.0}, {1.3}}, {}, {}, voxels);
    EXPECT_EQ(report.verdict, Verdict::UNKNOWN);
    ASSERT_EQ(report.pairs.size(), 1u);
    EXPECT_EQ(scene->models()[report.pairs[0].second].name, "cloud");
  }
  EXPECT_EQ(check.check({{-1.0}, {1.3}}, {}, {}, {voxelsAt({})}).verdict, Verdict::FREE);
  EXPECT_EQ(check.check({{-1.0}, {1.3}}, {}, {}, {voxelsAt({{400, 0, 0}})}).verdict, Verdict::FREE);
}

// The nearest voxel is beside the way; another one, further away, is on it.
TEST(CloudMotion, TheTimeToContactIsNoLaterThanThatOfAnyVoxel) {
  const auto scene = sceneWithCloud(slidingBox());
  const CloudVoxels voxels = {voxelsAt({{0, 11, 0}, {12, 0, 0}})};
  BodyPoses before, now;
  before.resize(1);
  now.resize(1);
  now.voxels = voxels;
  now.X_WB[0].translation().x() = 0.0;
  before.X_WB[0].translation().x() = -0.1;
  CollisionDetector detector(scene);
  CheckSettings settings;
  settings.alarm_distance = 0.5;
  const CollisionReport& report = detector.detect(now, settings);
  ASSERT_EQ(report.pairs.size(), 1u);
  EarlierPoses earlier;
  earlier.poses = before;
  earlier.window = 0.1;
  const ClosingMotion closing = closingMotion(*scene, report, report.pairs[0], now, earlier);
  ASSERT_TRUE(closing.known);
  // 1 m/s towards the second voxel, which is 0.1 m away.
  EXPECT_LE(closing.time_to_contact, 0.1);
  EXPECT_GT(closing.time_to_contact, 0.0);
}

}  // namespace collision_pairs::test_cloud_motion
