#include <cmath>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "demo_scene.h"
#include "random_inputs.h"
#include "refusal.h"

namespace collision_pairs::test_collision_detector {

std::shared_ptr<const CollisionScene> sceneOf(const std::string& links_and_joints) {
  return CollisionScene::build(robotFrom(links_and_joints), std::nullopt, nullptr);
}

/// Puts the sliding boxes (unit cubes) at these x.
BodyPoses boxesAt(const CollisionScene& scene, const std::vector<double>& x) {
  std::vector<double> q = scene.robot().zeroPositions();
  for (std::size_t i = 0; i < x.size(); ++i) {
    q[scene.robot().findJoint("slide_" + std::string(1, static_cast<char>('a' + i)))] = x[i];
  }
  std::vector<Eigen::Isometry3d> X_RB;
  scene.robot().forwardKinematics(q, X_RB);
  BodyPoses poses;
  scene.gatherPoses(X_RB, poses);
  return poses;
}

std::map<std::string, double> distances(const CollisionReport& report,
                                        const CollisionScene& scene) {
  std::map<std::string, double> by_name;
  for (const PairReport& pair : report.pairs) {
    by_name[scene.models()[pair.first].name + "|" + scene.models()[pair.second].name] =
        pair.distance;
  }
  return by_name;
}

CheckSettings alarm(double distance) {
  CheckSettings settings;
  settings.alarm_distance = distance;
  return settings;
}

TEST(CollisionDetector, ReportsTheToleranceOfEachCheck) {
  const auto scene = sceneOf(slidingBoxes(2));
  CollisionDetector detector(scene);
  CheckSettings settings = alarm(0.2);
  for (const double tolerance : {0.01, 0.0}) {
    settings.tolerance = tolerance;
    EXPECT_EQ(detector.detect(boxesAt(*scene, {0.0, 1.1}), settings).tolerance, tolerance);
  }
}

TEST(CollisionDetector, ReportsContactNearAndNothingElse) {
  const auto scene = sceneOf(slidingBoxes(4));
  CollisionDetector detector(scene);
  const auto& report = detector.detect(boxesAt(*scene, {0.0, 0.9, 2.0, 5.0}), alarm(0.2));
  EXPECT_TRUE(report.in_collision);
  const auto found = distances(report, *scene);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found.at("a|b"), -0.1, 1e-12);
  EXPECT_NEAR(found.at("b|c"), 0.1, 1e-12);
  EXPECT_NEAR(report.min_distance, -0.1, 1e-12);
  EXPECT_FALSE(report.min_distance_is_bound);
  EXPECT_EQ(report.nb_boxes, 4u);
  EXPECT_EQ(report.candidates.size(), 2u);
}

// The distance of two spheres does not depend on how their links are turned, so the oracle needs
// the two positions only, as they were given.
TEST(CollisionDetector, AskedForAVerdictBeginsWithTheBoxesThatOverlapMost) {
  const auto scene = sceneOf(slidingBoxes(4));
  CollisionDetector detector(scene);
  CheckSettings settings;
  settings.verdict_only = true;
  for (const auto& [x, deepest] :
       std::map<std::vector<double>, std::string>{{{0.0, 0.9, 1.6, 2.5}, "b|c"},
                                                  {{0.0, 0.9, 1.8, 2.1}, "c|d"},
                                                  {{0.0, 0.3, 1.1, 1.9}, "a|b"}}) {
    const auto found = distances(detector.detect(boxesAt(*scene, x), settings), *scene);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found.begin()->first, deepest);
  }
}

TEST(CollisionDetector, FarFromTheOriginDistancesAreThoseOfTheGivenPoses) {
  std::string xml = emptyLink("root");
  for (const char* name : {"a", "b"}) {
    xml += "<link name='" + std::string(name) +
           "'><collision><geometry><sphere radius='0.25'/></geometry></collision></link>" +
           joint("to_" + std::string(name), "floating", "root", name, "0 0 0");
  }
  const auto scene = sceneOf(xml);
  CollisionDetector detector(scene);
  RandomInputs random;
  for (const double offset : {0.0, 1e3, 1e6, 1e8}) {
    for (int i = 0; i < 200; ++i) {
      BodyPoses poses;
      poses.resize(2);
      for (Eigen::Isometry3d& X : poses.X_WB) X = random.pose(1.0);
      for (Eigen::Isometry3d& X : poses.X_WB)
        X.translation() += offset * Eigen::Vector3d(1, -0.7, 0.3);
      const double expected =
          (poses.X_WB[1].translation() - poses.X_WB[0].translation()).norm() - 0.5;
      const auto& report = detector.detect(poses, alarm(10.0));
      ASSERT_EQ(report.pairs.size(), 1u);
      EXPECT_NEAR(report.pairs[0].distance, expected, 4e-15) << "at " << offset;
    }
  }
}

TEST(CollisionDetector, StageTimesAreThereIfAskedForAndZeroOtherwise) {
  const auto scene = sceneOf(slidingBoxes(4));
  CollisionDetector detector(scene);
  CheckSettings settings;
  settings.stage_times = true;
  const BodyPoses poses = boxesAt(*scene, {0.0, 0.9, 2.0, 5.0});
  const StageTimes times = detector.detect(poses, settings).times;
  EXPECT_GT(times.boxes, 0.0);
  EXPECT_GT(times.broad_phase, 0.0);
  EXPECT_GT(times.narrow_phase, 0.0);
  EXPECT_GT(times.total, 0.0);
  settings.stage_times = false;
  EXPECT_EQ(detector.detect(poses, settings).times.total, 0.0);
}

TEST(CollisionDetector, TouchingIsContactAlsoWithoutAlarmDistance) {
  const auto scene = sceneOf(slidingBoxes(2));
  CollisionDetector detector(scene);
  EXPECT_TRUE(detector.detect(boxesAt(*scene, {0.0, 1.0}), alarm(0.0)).in_collision);
  EXPECT_TRUE(detector.detect(boxesAt(*scene, {1.0, 0.0}), alarm(0.0)).in_collision);
  EXPECT_FALSE(detector.detect(boxesAt(*scene, {0.0, 1.0 + 1e-9}), alarm(0.0)).in_collision);
}

TEST(CollisionDetector, WitnessPointsAndNormalAreInTheWorldFrameFromFirstToSecond) {
  const auto scene = sceneOf(slidingBoxes(2));
  CollisionDetector detector(scene);
  const auto& report = detector.detect(boxesAt(*scene, {10.0, 8.75}), alarm(0.5));
  ASSERT_EQ(report.contacts.size(), 1u);
  const Contact& contact = report.contacts[0];
  EXPECT_NEAR(contact.p_WFirst.x(), 9.5, 1e-12);
  EXPECT_NEAR(contact.p_WSecond.x(), 9.25, 1e-12);
  EXPECT_TRUE(contact.nhat_W.isApprox(-Eigen::Vector3d::UnitX(), 1e-9));
  EXPECT_NEAR(contact.depth, -0.25, 1e-12);
}

TEST(CollisionDetector, AnswerDependsOnThisCycleAlone) {
  const auto scene = sceneOf(slidingBoxes(3));
  CollisionDetector used(scene);
  used.detect(boxesAt(*scene, {0, 0.5, 0.7}), alarm(1.0));
  CollisionDetector fresh(scene);
  const BodyPoses poses = boxesAt(*scene, {0, 1.05, 4});
  EXPECT_EQ(distances(used.detect(poses, alarm(0.1)), *scene),
            distances(fresh.detect(poses, alarm(0.1)), *scene));
}

TEST(CollisionDetector, MinimumIsFoundHoweverFarItIs) {
  RandomInputs random;
  const auto scene = sceneOf(slidingBoxes(5));
  CollisionDetector detector(scene);
  CheckSettings settings = alarm(0.0);
  settings.min_distance = true;
  for (int round = 0; round < 200; ++round) {
    std::vector<double> x(5);
    for (double& value : x) value = random.uniform(-90.0, 90.0);
    double expected = 1e9;
    for (int i = 0; i < 5; ++i) {
      for (int j = 0; j < i; ++j) expected = std::min(expected, std::abs(x[i] - x[j]) - 1.0);
    }
    const auto& report = detector.detect(boxesAt(*scene, x), settings);
    EXPECT_FALSE(report.min_distance_is_bound);
    EXPECT_NEAR(report.min_distance, expected, 1e-12);
    EXPECT_EQ(report.in_collision, expected <= 0.0);
  }
}

TEST(CollisionDetector, ALinkWithoutPoseIsLeftOutAndNamed) {
  const auto scene = sceneOf(slidingBoxes(3));
  CollisionDetector detector(scene);
  BodyPoses poses = boxesAt(*scene, {0.0, 0.1, 0.2});
  poses.known[scene->models()[1].body] = 0;
  const auto& report = detector.detect(poses, alarm(0.0));
  EXPECT_EQ(report.left_out, (std::vector<std::uint32_t>{1}));
  EXPECT_THAT(distances(report, *scene), testing::ElementsAre(testing::Key("a|c")));
  EXPECT_EQ(report.nb_boxes, 2u);
}

TEST(CollisionDetector, APoseThatIsNotFiniteCountsAsUnknown) {
  const auto scene = sceneOf(slidingBoxes(2));
  CollisionDetector detector(scene);
  BodyPoses poses = boxesAt(*scene, {0.0, 0.1});
  poses.X_WB[scene->models()[0].body].translation().x() = std::nan("");
  const auto& report = detector.detect(poses, alarm(0.0));
  EXPECT_EQ(report.left_out, (std::vector<std::uint32_t>{0}));
  EXPECT_EQ(report.verdict, Verdict::UNKNOWN);
  EXPECT_TRUE(report.in_collision);
}

TEST(CollisionDetector, PairByPairEqualsAllAtOnce) {
  const auto scene = sceneOf(slidingBoxes(4));
  const BodyPoses poses = boxesAt(*scene, {0.0, 0.5, 1.2, 1.9});
  CollisionDetector detector(scene);
  const auto expected = distances(detector.detect(poses, alarm(0.3)), *scene);
  detector.beginNarrowPhase(poses, alarm(0.3));
  for (std::uint32_t a = 0; a < 4; ++a) {
    for (std::uint32_t b = 0; b < a; ++b) detector.addCollisionPair(a, b);
  }
  EXPECT_EQ(distances(detector.endNarrowPhase(), *scene), expected);
}

TEST(CollisionDetector, PairsThatWereNotAddedStayOut) {
  // A-B and C-D were added; A-C, which touches too, was not.
  const auto scene = sceneOf(slidingBoxes(4));
  CollisionDetector detector(scene);
  detector.beginNarrowPhase(boxesAt(*scene, {0.0, 0.1, 0.2, 0.3}), alarm(0.0));
  detector.addCollisionPair(1, 0);
  detector.addCollisionPair(2, 3);
  EXPECT_THAT(distances(detector.endNarrowPhase(), *scene),
              testing::ElementsAre(testing::Key("a|b"), testing::Key("c|d")));
}

TEST(CollisionDetector, PairsThatWereAddedBeforeAreNotInTheNextRound) {
  const auto scene = sceneOf(slidingBoxes(3));
  const BodyPoses poses = boxesAt(*scene, {0.0, 0.1, 0.2});
  CollisionDetector detector(scene);
  for (const std::uint32_t other : {1, 2}) {
    detector.beginNarrowPhase(poses, alarm(0.0));
    detector.addCollisionPair(0, other);
    EXPECT_THAT(distances(detector.endNarrowPhase(), *scene),
                testing::ElementsAre(testing::Key(other == 1 ? "a|b" : "a|c")));
  }
}

TEST(CollisionDetector, RefusesToEndWhatWasNotBegun) {
  const auto scene = sceneOf(slidingBoxes(2));
  const BodyPoses poses = boxesAt(*scene, {0.0, 0.5});
  CollisionDetector detector(scene);
  EXPECT_THROW(detector.endNarrowPhase(), InputError);
  detector.beginNarrowPhase(poses, alarm(0.0));
  EXPECT_TRUE(detector.endNarrowPhase().pairs.empty());
  EXPECT_THROW(detector.endNarrowPhase(), InputError);
  detector.beginNarrowPhase(poses, alarm(0.0));
  detector.detect(poses, alarm(0.0));
  EXPECT_THROW(detector.endNarrowPhase(), InputError) << "a check in between ends what was begun";
}

// A rotation that is none has a distance that is known from below only.
TEST(CollisionDetector, TheSmallestDistanceIsABoundWhereTheNarrowPhaseIsDegraded) {
  const auto scene = sceneOf(slidingBoxes(3));
  CollisionDetector detector(scene);
  for (const double x : {0.5, 1.2, 9.0}) {  // in contact, near, and only found as the minimum
    BodyPoses poses = boxesAt(*scene, {0.0, x, 30.0});
    CheckSettings settings = alarm(0.5);
    settings.min_distance = true;
    EXPECT_FALSE(detector.detect(poses, settings).min_distance_is_bound) << x;
    for (Eigen::Isometry3d& X_WB : poses.X_WB) X_WB.linear().row(1) << 0.6, 0.8, 0.0;  // a shear
    const CollisionReport& report = detector.detect(poses, settings);
    EXPECT_TRUE(report.min_distance_is_bound) << x;
    EXPECT_LT(report.min_distance, x - 1.0);
  }
}

TEST(CollisionDetector, EveryRungReportsTheContactsOfTheNext) {
  RandomInputs random;
  std::string xml = emptyLink("root");
  const char* shapes[] = {"<box size='1 0.3 0.2'/>", "<cylinder radius='0.3' length='1'/>",
                          "<sphere radius='0.4'/>"};
  for (int i = 0; i < 6; ++i) {
    const std::string name(1, static_cast<char>('a' + i));
    xml += linkWith(name, shapes[i % 3]) +
           joint("float_" + name, "floating", "root", name, "0 0 0", "");
  }
  const auto scene = sceneOf(xml);
  CollisionDetector detector(scene);
  BodyPoses poses;
  poses.resize(scene->bodies().size());
  for (int round = 0; round < 300; ++round) {
    for (auto& X_WB : poses.X_WB) X_WB = random.pose(0.8);
    CheckSettings settings = alarm(0.2);
    std::map<std::string, double> dearer;
    for (const Fidelity fidelity :
         {Fidelity::MESH, Fidelity::CONVEX, Fidelity::OBB, Fidelity::AABB}) {
      settings.fidelity = fidelity;
      const auto found = distances(detector.detect(poses, settings), *scene);
      for (const auto& [names, distance] : dearer) {
        ASSERT_TRUE(found.count(names)) << names << " at " << fidelityName(fidelity);
        EXPECT_LE(found.at(names), distance > 0.0 ? distance + 1e-9 : 0.0) << names;
      }
      dearer = found;
    }
  }
}

TEST(CollisionDetector, RefusesSettingsAndPosesThatDoNotFit) {
  const auto scene = sceneOf(slidingBoxes(2));
  CollisionDetector detector(scene);
  EXPECT_THROW(detector.detect(BodyPoses{}, alarm(0.0)), InputError);
  EXPECT_THROW(detector.detect(boxesAt(*scene, {0, 1}), alarm(-0.1)), InputError);
  EXPECT_THROW(detector.detect(boxesAt(*scene, {0, 1}), alarm(std::nan(""))), InputError);
  EXPECT_THROW(detector.beginNarrowPhase(BodyPoses{}, alarm(0.0)), InputError);
  EXPECT_THROW(detector.beginNarrowPhase(boxesAt(*scene, {0, 1}), alarm(-0.1)), InputError);
}

TEST(CollisionScene, OfARobotWithoutGeometryIsEmptyAndUnknown) {
  const auto scene = sceneOf(emptyLink("root"));
  CollisionDetector detector(scene);
  BodyPoses none;
  CheckSettings settings;
  settings.min_distance = true;
  const auto& report = detector.detect(none, settings);
  EXPECT_EQ(report.verdict, Verdict::UNKNOWN);
  EXPECT_EQ(report.unchecked, "the robot has no collision geometry");
  EXPECT_TRUE(report.pairs.empty());
  EXPECT_TRUE(report.min_distance_is_bound);
}

TEST(CollisionScene, LinksInNoAllowedPairAreNotInIt) {
  const auto robot = robotFrom(slidingBoxes(3));
  const Srdf srdf = Srdf::fromXml(
      "<robot name='r'><disable_collisions link1='a' link2='b'/>"
      "<disable_collisions link1='a' link2='c'/></robot>");
  const auto scene = CollisionScene::build(robot, srdf, nullptr);
  ASSERT_EQ(scene->models().size(), 2u);
  EXPECT_EQ(scene->findModel("a"), -1);
  EXPECT_EQ(scene->bodies().size(), 2u);
}

TEST(CollisionScene, WorldIsCheckedAgainstTheRobotAndNotAgainstItself) {
  const auto world = robotFrom(emptyLink("w") + boxLink("wall", 1) + boxLink("floor", 1) +
                               joint("j1", "fixed", "w", "wall", "5 0 0") +
                               joint("j2", "fixed", "w", "floor", "5 0 0"));
  const auto scene = CollisionScene::build(robotFrom(slidingBoxes(2)), std::nullopt, world);
  EXPECT_EQ(scene->nbStaticElements(), 2u);
  CollisionDetector detector(scene);
  const auto found = distances(detector.detect(boxesAt(*scene, {5.5, 0.0}), alarm(0.0)), *scene);
  EXPECT_THAT(found, testing::ElementsAre(testing::Key("a|floor"), testing::Key("a|wall")));
}

TEST(CollisionScene, WhatIsStaticMayBeAddedPairByPair) {
  const auto scene = CollisionScene::build(robotFrom(slidingBoxes(2)), std::nullopt,
                                           robotFrom(boxLink("wall", 1)));
  CollisionDetector detector(scene);
  detector.beginNarrowPhase(boxesAt(*scene, {0.0, 0.1}), alarm(0.0));
  detector.addCollisionPair(static_cast<std::uint32_t>(scene->findModel("wall")),
                            static_cast<std::uint32_t>(scene->findModel("a")));
  EXPECT_THAT(distances(detector.endNarrowPhase(), *scene),
              testing::ElementsAre(testing::Key("a|wall")));
}

/// A mesh around the boxes, 10 m times `size`.
RigidObject meshAround(double size) {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->vertices = {{-1, -1, -1}, {3, -1, -1}, {-1, 3, -1}, {-1, -1, 3}};
  for (Eigen::Vector3d& vertex : mesh->vertices) vertex *= 10.0 * size;
  mesh->triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  RigidObject around;
  around.name = "around";
  around.elements = {{Mesh{mesh}, Eigen::Isometry3d::Identity()}};
  return around;
}

// Volumes overflow long before lengths.
TEST(CollisionScene, AMeshAroundTheRobotIsFoundWhateverItsSizeOrRefused) {
  SceneDescription description;
  description.robots.push_back({robotFrom(slidingBoxes(2)), std::nullopt, ""});
  int nb_found = 0, nb_refused = 0;
  for (double size = 1.0; size < 1e300; size *= 1e3) {
    description.objects = {meshAround(size)};
    std::shared_ptr<const CollisionScene> scene;
    const std::string why = refusal([&] { scene = CollisionScene::build(description); });
    if (!scene) {
      EXPECT_THAT(why, testing::HasSubstr("'around' is too large or too far away"));
      ++nb_refused;
      continue;
    }
    ++nb_found;
    for (const Fidelity fidelity : {Fidelity::CONVEX, Fidelity::MESH}) {
      CheckSettings settings;
      settings.fidelity = fidelity;
      const Verdict verdict =
          CollisionDetector(scene).detect(boxesAt(*scene, {0, 4}), settings).verdict;
      EXPECT_EQ(verdict, Verdict::COLLISION) << size;
    }
  }
  EXPECT_GT(nb_found, 30);
  EXPECT_GT(nb_refused, 30);
}

TEST(CollisionScene, ANameInRobotAndWorldIsRefused) {
  const auto world = robotFrom(boxLink("a", 1));
  EXPECT_THROW(CollisionScene::build(robotFrom(slidingBoxes(2)), std::nullopt, world), InputError);
}

}  // namespace collision_pairs::test_collision_detector
