// Certificates of motions whose joints deviate, and the settings that the limiter uses.
#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "collision_pairs/input_error.h"
#include "collision_pairs/occupied_voxels.h"
#include "motion_fixtures.h"
#include "random_inputs.h"
#include "random_robot.h"
#include "refusal.h"

namespace collision_pairs::test_motion_deviation {

double smallestDistance(const std::shared_ptr<const CollisionScene>& scene,
                        const std::vector<double>& q) {
  CheckSettings settings;
  settings.min_distance = true;
  std::vector<Eigen::Isometry3d> X_RB;
  scene->robot().forwardKinematics(q, X_RB);
  BodyPoses poses;
  scene->gatherPoses(X_RB, poses);
  return CollisionDetector(scene).detect(poses, settings).min_distance;
}

TEST(MotionDeviation, WhatIsCertifiedIsFreeWhereverTheJointsDeviateTo) {
  RandomInputs random;
  int nb_free = 0;
  for (int round = 0; round < 400; ++round) {
    const auto robot = randomRobot(random, random.integer(2, 6));
    const auto scene = sceneOf(robot, {boxAt("box", random.vector(-0.8, 0.8), {0.2, 0.1, 0.3})});
    JointMotion motion;
    motion.from = motion.to = randomPositions(random, *robot);
    motion.deviation.assign(motion.from.size(), 0.0);
    for (std::size_t i = 0; i < motion.from.size(); ++i) {
      motion.to[i] += random.uniform(-0.3, 0.3);
      if (random.integer(0, 3) > 0) motion.deviation[i] = random.uniform(0.0, 0.1);
    }
    MotionSettings settings;
    settings.clearance = random.integer(0, 1) ? 0.02 : 0.0;
    settings.only_free = random.integer(0, 1) == 1;
    if (random.integer(0, 4) == 0) settings.fidelity = Fidelity::OBB;
    const MotionReport report = MotionCheck(scene).check(motion, settings);
    if (report.verdict != Verdict::FREE) continue;
    ++nb_free;
    for (int k = 0; k < 60; ++k) {
      const double f = random.uniform(0.0, 1.0);
      std::vector<double> q = motion.from;
      for (std::size_t i = 0; i < q.size(); ++i) {
        const double sign = random.integer(0, 1) ? 1.0 : -1.0;
        q[i] += f * (motion.to[i] - q[i]) + sign * motion.deviation[i];
      }
      robot->applyMimics(q);
      ASSERT_GE(smallestDistance(scene, q), report.clearance - 1e-7) << "round " << round;
    }
  }
  EXPECT_GT(nb_free, 60);
}

// The bar's end moves by 0.1 m: as much as a motion of the same size would.
TEST(MotionDeviation, IsCertifiedUpToThePlaceThatItReaches) {
  const auto scene = sceneOf(turningBar(), {boxAt("box", {0.9, 0.2, 0.0}, {0.1, 0.1, 0.1})});
  MotionCheck check(scene);
  const double reached = std::asin((0.2 - 0.05 - 0.01) / 1.0);  // of the bar's upper edge, about
  JointMotion motion{{0.0}, {0.0}, {0.8 * reached}};
  EXPECT_EQ(check.check(motion, {}).verdict, Verdict::FREE);
  motion.deviation = {1.3 * reached};
  EXPECT_EQ(check.check(motion, {}).verdict, Verdict::UNKNOWN);
}

// Joints deviate along their own motion: a box that slides, and a plate that turns, beside a wall.
TEST(MotionDeviation, CountsOnlyTowardsWhatIsThere) {
  const auto verdict = [](const std::shared_ptr<const RobotModel>& robot, const RigidObject& wall,
                          double from, double to, double deviation) {
    MotionSettings settings;
    settings.clearance = 0.012;
    settings.only_free = true;
    return MotionCheck(sceneOf(robot, {wall})).check({{from}, {to}, {deviation}}, settings).verdict;
  };
  const Eigen::Vector3d wide(9.0, 1.0, 9.0), high(1.0, 9.0, 9.0);
  const RigidObject beside = boxAt("wall", {0.0, 1.02, 0.0}, wide),
                    ahead = boxAt("wall", {1.02, 0.0, 0.0}, high);
  for (const double length : {0.0, 0.3, 2.0}) {
    for (const double deviation : {0.007, 0.03, 0.5}) {
      EXPECT_EQ(verdict(slidingBox(), beside, 0.0, length, deviation), Verdict::FREE);
      EXPECT_EQ(verdict(slidingBox(), ahead, -length, 0.0, deviation),
                deviation < 0.008 ? Verdict::FREE : Verdict::UNKNOWN);
    }
  }
  const auto plate = robotFrom(emptyLink("root") + linkWith("plate", "<box size='0.8 0.3 0.02'/>") +
                               hinge("turn", "root", "plate", "0 0 0"));
  const RigidObject below = boxAt("floor", {0.0, 0.0, -0.53}, {2.0, 2.0, 1.0});
  for (const double angle : {0.0, 0.5, 2.0}) {
    EXPECT_EQ(verdict(plate, below, 0.3, 0.3 + angle, 0.1), Verdict::FREE) << angle;
  }
}

// The follower is at x = 1 - 2 q, and the wall 0.5 m beyond it.
TEST(MotionDeviation, OfAJointThatMimicsIsThatOfItsLeaderTimesTheMultiplierWithoutTheOffset) {
  const std::string along = "<axis xyz='1 0 0'/><limit lower='-9' upper='9'/>";
  const auto robot =
      robotFrom(emptyLink("root") + boxLink("leader", 1.0) + boxLink("follower", 1.0) +
                joint("lead", "prismatic", "root", "leader", "0 9 0", along) +
                joint("follow", "prismatic", "root", "follower", "0 0 0",
                      along + "<mimic joint='lead' multiplier='-2' offset='1'/>"));
  const auto scene = sceneOf(robot, {boxAt("wall", {2.5, 0.0, 0.0}, {1.0, 1.0, 1.0})});
  MotionCheck check(scene);
  std::vector<double> at = robot->zeroPositions(), deviation = at;
  robot->applyMimics(at);
  for (const double of_follower : {0.0, 0.7}) {  // its own says nothing
    deviation[robot->findJoint("follow")] = of_follower;
    deviation[robot->findJoint("lead")] = 0.24;
    EXPECT_EQ(check.check({at, at, deviation}, {}).verdict, Verdict::FREE);
    deviation[robot->findJoint("lead")] = 0.26;
    EXPECT_EQ(check.check({at, at, deviation}, {}).verdict, Verdict::UNKNOWN);
  }
}

TEST(MotionDeviation, ThatIsNotANumberForEachJointIsRefused) {
  const auto scene = sceneOf(turningBar(), {boxAt("box", {3.0, 0.0, 0.0}, {0.1, 0.1, 0.1})});
  MotionCheck check(scene);
  for (const std::vector<double>& bad :
       {std::vector<double>{0.1, 0.1}, {NAN_POSITION}, {-0.1}, {1.0 / 0.0}}) {
    EXPECT_THROW(check.check({{0.0}, {0.1}, bad}, {}), InputError);
  }
  MotionSettings settings;
  settings.clearance = -1.0;
  EXPECT_THROW(check.check({{0.0}, {0.1}}, settings), InputError);
}

TEST(OnlyFree, EndsWithoutAContactButAgreesAboutFree) {
  RandomInputs random;
  const auto scene = sceneOf(turningBar(), {boxAt("box", {0.9, 0.3, 0.0}, {0.1, 0.1, 0.1})});
  MotionCheck check(scene);
  MotionSettings whole, only_free;
  only_free.only_free = true;
  whole.clearance = only_free.clearance = 0.01;
  for (int i = 0; i < 300; ++i) {
    const double from = random.uniform(-3.0, 3.0);
    const JointMotion motion{{from}, {from + random.uniform(-1.0, 1.0)}};
    const bool is_free = check.check(motion, whole).verdict == Verdict::FREE;
    const MotionReport& report = check.check(motion, only_free);
    EXPECT_EQ(report.verdict == Verdict::FREE, is_free);
    EXPECT_EQ(report.pairs.size(), is_free ? 0u : 1u);
  }
}

// A base that stands in its table.
TEST(OnlyMoved, LeavesOutWhatTheMotionCannotChange) {
  const auto robot =
      robotFrom(boxLink("base", 0.4) + bar("arm", 1.0) + hinge("turn", "base", "arm", "0 0 0.5"));
  const auto scene = sceneOf(robot, {boxAt("table", {0.0, 0.0, -0.3}, {2.0, 2.0, 0.3}),
                                     boxAt("post", {0.7, 0.7, 0.5}, {0.1, 0.1, 0.1})});
  MotionSettings settings;
  settings.clearance = 0.01;
  EXPECT_EQ(checked(scene, {0.0}, {-0.5}, settings).verdict, Verdict::COLLISION);
  settings.only_moved = true;
  EXPECT_EQ(checked(scene, {0.0}, {-0.5}, settings).verdict, Verdict::FREE);
  EXPECT_NE(checked(scene, {0.0}, {1.0}, settings).verdict, Verdict::FREE);
  for (const bool from_start : {false, true}) {
    settings.from_start = from_start;
    const MotionReport report = checked(scene, {0.0}, {1.0}, settings);
    EXPECT_EQ(report.verdict, Verdict::COLLISION);
    const auto id = [&](const char* name) {
      return static_cast<std::uint32_t>(scene->findModel(name));
    };
    const std::pair<std::uint32_t, std::uint32_t> arm_and_post = std::minmax(id("arm"), id("post"));
    EXPECT_EQ(report.pairs, std::vector{arm_and_post}) << "not the base and the table";
  }
}

// Whichever pairs are looked at.
TEST(OnlyMoved, APlacedPoseHasARotation) {
  const auto robot =
      robotFrom(boxLink("base", 0.4) + bar("arm", 1.0) + hinge("turn", "base", "arm", "0 0 0.5"));
  const auto scene = sceneOf(robot, {boxAt("post", {0.7, 0.7, 0.5}, {0.1, 0.1, 0.1})});
  for (const double scale : {0.0, -1.0, 0.5, 0.99, 1.01, 2.0, 1.0 + 1e-5, 1.0}) {
    PlacedBodies placed(robot->bodies().size());
    placed[0] = Eigen::Isometry3d::Identity();
    placed[0]->linear() *= scale;
    for (const bool only_moved : {false, true}) {
      MotionSettings settings;
      settings.only_moved = only_moved;
      if (std::abs(scale - 1.0) < 1e-4) {
        EXPECT_EQ(checked(scene, {0.0}, {1.0}, settings, placed).verdict, Verdict::COLLISION);
        continue;
      }
      EXPECT_EQ(refusal([&] { checked(scene, {0.0}, {1.0}, settings, placed); }),
                "link 'base': the pose given for it is not finite, or has no rotation")
          << scale;
    }
  }
}

TEST(ClearanceOf, IsANumberAndNoMoreThanTheClearance) {
  const auto scene = sceneOf(turningBar(), {boxAt("box", {0.9, 0.3, 0.0}, {0.1, 0.1, 0.1})});
  for (const double wrong : {0.1001, std::nan(""), HUGE_VAL}) {
    MotionSettings settings;
    settings.clearance = 0.1;
    settings.clearance_of = [wrong](auto, auto) { return wrong; };
    const std::string why = refusal([&] { checked(scene, {0.0}, {0.1}, settings); });
    EXPECT_EQ(why, "clearance_of says " + std::to_string(wrong) +
                       " m of arm|box, but no pair keeps more than the clearance, 0.100000 m");
  }
}

// The wall is static, so it is found by sweep and prune; the two boxes are a pair from the start.
TEST(ClearanceOf, APairOnlyKeepsItsOwnClearanceAndOthersThatOfTheSettings) {
  const auto robot = robotFrom(slidingBoxes(2));
  const auto scene = sceneOf(robot, {boxAt("wall", {3.4, 0.0, 0.0}, {1.0, 1.0, 1.0})});
  const std::vector<double> at = {1.0, 2.2};  // gaps of 0.2 m
  MotionSettings settings;
  settings.clearance = 0.25;
  const auto models = checked(scene, at, at, settings).pairs;
  ASSERT_EQ(models.size(), 2u);
  for (const int last : {0, 1}) {
    const std::uint32_t first = models[1 - last].first, second = models[1 - last].second;
    for (const double kept : {-1.0, 0.15, 0.21}) {
      settings.clearance_of = [=](auto a, auto b) {
        EXPECT_LT(a, b);
        return std::pair(a, b) == std::pair(first, second) ? kept : 0.25;
      };
      const auto left = checked(scene, at, at, settings).pairs;
      ASSERT_EQ(left.size(), kept < 0.2 ? 1u : 2u);
      if (kept < 0.2) {
        EXPECT_EQ(left[0], models[last]);
      }
    }
  }
  settings.clearance_of = [](auto, auto) { return 0.15; };
  EXPECT_EQ(checked(scene, at, at, settings).verdict, Verdict::FREE);
}

TEST(ClearanceOf, APairThatIsLeftOutMayTouchAndIfNothingIsLeftNothingIsFree) {
  const auto scene = sceneOf(robotFrom(slidingBoxes(2)), {});
  const std::vector<double> touching = {1.0, 1.5};
  MotionSettings settings;
  EXPECT_EQ(checked(scene, touching, touching, settings).verdict, Verdict::COLLISION);
  settings.clearance_of = [](auto, auto) { return 0.0; };
  EXPECT_EQ(checked(scene, touching, touching, settings).verdict, Verdict::COLLISION);
  settings.clearance_of = [](auto, auto) { return -1.0; };
  for (const bool only_moved : {false, true}) {
    settings.only_moved = only_moved;
    const MotionReport report = checked(scene, touching, {1.0, 1.4}, settings);
    EXPECT_EQ(report.verdict, Verdict::UNKNOWN);
    EXPECT_EQ(report.unchecked, "every pair is left out");
    EXPECT_EQ(report.free_until, 0.0);
  }
  settings.only_moved = false;
  // A third one, apart from both, is checked; then it is in the way.
  const auto with_third =
      sceneOf(robotFrom(slidingBoxes(2)), {boxAt("wall", {5.0, 0.0, 0.0}, {1.0, 1.0, 1.0})});
  const int wall = with_third->findModel("wall");
  settings.clearance_of = [wall](auto a, auto b) {
    return static_cast<int>(a) == wall || static_cast<int>(b) == wall ? 0.0 : -1.0;
  };
  EXPECT_EQ(checked(with_third, touching, {1.0, 1.4}, settings).verdict, Verdict::FREE);
  EXPECT_EQ(checked(with_third, touching, {1.0, 4.5}, settings).verdict, Verdict::COLLISION);
}

TEST(OnlyMoved, AMotionThatMovesNothingIsNotFree) {
  const auto scene = sceneOf(robotFrom(slidingBoxes(2)), {});
  MotionSettings settings;
  settings.only_moved = true;
  for (const bool only_free : {false, true}) {
    settings.only_free = only_free;
    const MotionReport report = checked(scene, {1.0, 4.0}, {1.0, 4.0}, settings);
    EXPECT_EQ(report.verdict, Verdict::UNKNOWN);
    EXPECT_EQ(report.unchecked, "every pair is left out");
    EXPECT_EQ(report.clearance, 0.0);
    EXPECT_EQ(report.free_until, 0.0);
    EXPECT_EQ(checked(scene, {1.0, 4.0}, {1.0, 3.0}, settings).verdict, Verdict::FREE);
    // Beside something that stands still and is out of reach.
    const auto beside = sceneOf(robotFrom(slidingBoxes(1)), {boxAt("far", {0, 90, 0}, {1, 1, 1})});
    EXPECT_EQ(checked(beside, {1.0}, {2.0}, settings).verdict, Verdict::FREE);
    EXPECT_EQ(checked(beside, {1.0}, {1.0}, settings).verdict, Verdict::UNKNOWN);
  }
}

TEST(ClearanceOf, TheReportedClearanceIsKeptByEveryPair) {
  const auto scene = sceneOf(robotFrom(slidingBoxes(2)), {});  // 0.05 m apart
  MotionSettings settings;
  settings.clearance = 0.2;
  settings.clearance_of = [](auto, auto) { return 0.01; };
  for (const bool only_free : {false, true}) {
    settings.only_free = only_free;
    const MotionReport report = checked(scene, {1.0, 2.05}, {1.01, 2.06}, settings);
    EXPECT_EQ(report.verdict, Verdict::FREE);
    EXPECT_LE(report.clearance, 0.05);
  }
}

TEST(OnlyMoved, VoxelsOfAnotherSizeThanTheCloudsAreRefused) {
  const std::vector<VoxelCell> no_cells;
  SceneDescription description = described(robotFrom(slidingBoxes(2)), {});
  description.clouds.push_back(boxAt("camera", {0, 0, 0}, {0.02, 0.02, 0.02}));
  MotionCheck check(CollisionScene::build(description));
  for (const bool only_moved : {false, true}) {
    MotionSettings settings;
    settings.only_moved = only_moved;
    const CloudVoxels voxels = {std::make_shared<const OccupiedVoxels>(0.01, no_cells)};
    EXPECT_THROW(check.check({{1.0, 4.0}, {1.0, 4.5}}, settings, {}, voxels), InputError);
  }
}

}  // namespace collision_pairs::test_motion_deviation
