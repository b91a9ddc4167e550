// What a motion costs, in configurations and queries, and how much of the truth is certified.
#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "mixed_robot.h"
#include "motion_fixtures.h"

namespace collision_pairs::test_motion_costs {

const std::string SHAPES[] = {"<box size='0.4 0.1 0.2'/>", "<cylinder radius='0.1' length='0.3'/>",
                              "<sphere radius='0.15'/>", "<mesh filename='l'/>"};

/// A link that turns about z at x = 0.25 beside `post`, which is of the robot or of the world.
struct Beside {
  std::string turns, post;
  Eigen::Vector3d offset;  ///< of the link from its axis
  double slide;            ///< m, along the axis, during the motion
};

/// `turns_first`: which of the two comes first by name, and so is the first of their pair.
std::shared_ptr<const CollisionScene> sceneOf(const Beside& beside, bool turns_first,
                                              bool in_robot = true) {
  const std::string arm = turns_first ? "a" : "b", post = turns_first ? "b" : "a";
  std::string xml = emptyLink("root") + emptyLink("mast") +
                    linkWith(arm, beside.turns,
                             "<origin xyz='" + std::to_string(beside.offset[0]) + " " +
                                 std::to_string(beside.offset[1]) + " " +
                                 std::to_string(beside.offset[2]) + "' rpy='0.3 0.2 0.1'/>") +
                    hinge("turn", "root", "mast", "0.25 0 0", "revolute") +
                    hinge("slide", "mast", arm, "0 0 0", "prismatic");
  xml += in_robot ? linkWith(post, beside.post) + joint("weld", "fixed", "root", post) : "";
  SceneDescription description;
  description.robots.push_back(
      {RobotModel::fromUrdf("<robot name='r'>" + xml + "</robot>", testMesh), Srdf{}, ""});
  if (!in_robot) description.objects.push_back(boxAt(post, {0, 0, 0}, {0.4, 0.1, 0.2}));
  return CollisionScene::build(description);
}

Beside randomBeside(RandomInputs& random) {
  Beside beside{SHAPES[random.integer(0, 3)], "", {}, random.uniform(-0.5, 0.5)};
  beside.post = SHAPES[random.integer(0, 3)];
  beside.offset = random.vector(-0.1, 0.1);
  beside.offset[1] += random.uniform(0.2, 0.6);
  return beside;
}

/// From s = -1 to 1.
std::vector<double> positionsAt(double s, const RobotModel& robot, const Beside& beside) {
  std::vector<double> positions = robot.zeroPositions();
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (robot.joints()[i].name == "turn") positions[i] = s;
    if (robot.joints()[i].name == "slide") positions[i] = s * beside.slide;
  }
  return positions;
}

MotionReport checked(const std::shared_ptr<const CollisionScene>& scene, const Beside& beside,
                     const MotionSettings& settings = {}) {
  return checked(scene, positionsAt(-1.0, scene->robot(), beside),
                 positionsAt(1.0, scene->robot(), beside), settings);
}

/// Signed, of 200 configurations.
double leastDistance(const std::shared_ptr<const CollisionScene>& scene, const Beside& beside,
                     Fidelity fidelity) {
  CollisionDetector detector(scene);
  CheckSettings settings;
  settings.min_distance = true;
  settings.fidelity = fidelity;
  double least = INFINITY;
  std::vector<Eigen::Isometry3d> X_RB;
  BodyPoses poses;
  for (int i = 0; i <= 200; ++i) {
    scene->robot().forwardKinematics(positionsAt(i / 100.0 - 1.0, scene->robot(), beside), X_RB);
    scene->gatherPoses(X_RB, poses);
    least = std::min(least, detector.detect(poses, settings).min_distance);
  }
  return least;
}

// In the sum: the two distances differ in their last bits, which can cost a step of one motion in a
// thousand.
TEST(MotionCosts, AreTheSameWhicheverOfTheTwoMoves) {
  RandomInputs random;
  std::size_t checks = 0, queries = 0, other_checks = 0, other_queries = 0;
  for (int i = 0; i < 100; ++i) {
    const Beside beside = randomBeside(random);
    const MotionReport first = checked(sceneOf(beside, true), beside);
    const MotionReport second = checked(sceneOf(beside, false), beside);
    EXPECT_EQ(first.verdict, second.verdict);
    checks += first.nb_checks, other_checks += second.nb_checks;
    queries += first.nb_queries, other_queries += second.nb_queries;
  }
  EXPECT_NEAR(1.0 * other_checks / checks, 1.0, 0.01);
  EXPECT_NEAR(1.0 * other_queries / queries, 1.0, 0.01);
}

/// In the mean of a verdict; the share of the true clearance that is certified.
struct Costs {
  double checks, queries, share;
};

/// Of 100 motions that are the same in each run: for FREE, and for COLLISION.
std::array<Costs, 2> costsOf(const MotionSettings& settings, bool in_robot) {
  RandomInputs random(7);
  std::array<Costs, 3> costs{};
  std::array<int, 3> nb{};
  for (int i = 0; i < 100; ++i) {
    const Beside beside = randomBeside(random);
    const auto scene = sceneOf(beside, true, in_robot);
    const MotionReport report = checked(scene, beside, settings);
    const auto kind = static_cast<std::size_t>(report.verdict);
    ++nb[kind];
    costs[kind].checks += report.nb_checks;
    costs[kind].queries += report.nb_queries;
    if (report.verdict != Verdict::FREE) continue;
    costs[kind].share += report.clearance / leastDistance(scene, beside, settings.fidelity);
  }
  for (std::size_t kind = 0; kind < 2; ++kind) {
    EXPECT_GT(nb[kind], 15);
    costs[kind] = {costs[kind].checks / nb[kind], costs[kind].queries / nb[kind],
                   costs[kind].share / nb[kind]};
  }
  return {costs[0], costs[1]};
}

TEST(MotionCosts, AreAFewConfigurationsAndQueriesForAShareOfTheClearance) {
  struct Case {
    bool in_robot;
    double clearance;
    Fidelity fidelity;
    Costs free, contact;
  };
  const Case cases[] = {
      {true, 0.0, Fidelity::OBB, {16.2, 0.0, 0.118}, {5.9, 0.0, 0.0}},
      {true, 0.0, Fidelity::MESH, {4.4, 1.15, 0.158}, {3.1, 2.0, 0.0}},
      {true, 0.02, Fidelity::MESH, {4.7, 1.28, 0.322}, {3.4, 2.35, 0.0}},
      {false, 0.0, Fidelity::OBB, {19.5, 0.0, 0.128}, {8.1, 0.0, 0.0}},
      {false, 0.0, Fidelity::MESH, {11.4, 0.88, 0.234}, {6.7, 2.05, 0.0}},
      {false, 0.02, Fidelity::MESH, {11.8, 1.12, 0.38}, {7.1, 2.55, 0.0}},
  };
  for (const Case& one : cases) {
    MotionSettings settings;
    settings.clearance = one.clearance;
    settings.fidelity = one.fidelity;
    const auto costs = costsOf(settings, one.in_robot);
    SCOPED_TRACE(&one - cases);
    EXPECT_LE(costs[0].checks, one.free.checks);
    EXPECT_LE(costs[0].queries, one.free.queries);
    EXPECT_GE(costs[0].share, one.free.share);
    EXPECT_LE(costs[1].checks, one.contact.checks);
    EXPECT_LE(costs[1].queries, one.contact.queries);
  }
}

// Nothing moves: what is looked for beside static things is a share of the larger of the element
// and the resolution.
TEST(MotionCosts, AClearanceOfAShareOfTheSizeAndOfTheResolutionCostsOneConfiguration) {
  const auto scene = sceneOf(slidingBox(), {boxAt("plate", {5.0, 0.0, 0.0}, {0.2, 0.2, 0.2})});
  MotionSettings settings;
  for (const double resolution : {1e-3, 5.0}) {
    settings.resolution = resolution;
    const MotionReport report = checked(scene, {0.0}, {0.0}, settings);
    EXPECT_EQ(report.nb_checks, 1u);
    EXPECT_EQ(report.nb_queries, 0u);
    EXPECT_NEAR(report.clearance, 0.05 * std::max(resolution, std::sqrt(0.75)), 1e-9);
  }
}

}  // namespace collision_pairs::test_motion_costs
