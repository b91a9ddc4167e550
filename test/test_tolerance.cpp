// A tolerance makes distances smaller by no more than itself, and changes nothing else.
#include <limits>
#include <map>

#include <gtest/gtest.h>

#include "benchmark/benchmark_robots.h"
#include "collision_pairs/collision_detector.h"
#include "collision_pairs/distance_gradient.h"
#include "collision_pairs/input_error.h"
#include "mixed_robot.h"
#include "prepared_shape.h"
#include "test_shapes.h"
#include "triangle_distance.h"

namespace collision_pairs::test_tolerance {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double INF = std::numeric_limits<double>::infinity();
constexpr double ROUNDING = 1e-12;
constexpr double CYLINDER_ACCURACY = 1e-10;  // docs/accuracy.md
constexpr double TOLERANCES[] = {1e-7, 1e-4, 1e-3, 1e-2, 0.1};

/// Of the closest of all pairs of triangles.
double distanceOfTriangles(const TriangleMesh& a, const TriangleMesh& b, const Isometry3d& X_AB) {
  ClosestPoints best{INF};
  for (std::uint32_t s = 0; s < a.triangles.size(); ++s) {
    for (std::uint32_t t = 0; t < b.triangles.size(); ++t) {
      improveByTriangles(triangleOf(a, s), Triangle(moved(cornersOf(b, t), X_AB)), best);
    }
  }
  return std::sqrt(best.squared);
}

double distanceFromSurface(const PreparedShape& shape, const Vector3d& p) {
  const PreparedMesh* mesh = static_cast<const Prepared&>(shape).mesh.get();
  return mesh == nullptr ? 0.0 : (closestOnMesh(*mesh, p) - p).norm();
}

/// Asks two shapes with each tolerance; `distance` is the truth.
class Question {
 public:
  Question(const Shape& a, const Shape& b) : A_(prepareShape(a)), B_(prepareShape(b)) {
    const bool has_cylinder =
        std::holds_alternative<Cylinder>(a) || std::holds_alternative<Cylinder>(b);
    if (has_cylinder) rounding_ = CYLINDER_ACCURACY;
  }

  PairDistance exact(const Isometry3d& X_AB) { return narrow_phase_.distance(*A_, *B_, X_AB, INF); }

  void expectWithin(const Isometry3d& X_AB, double distance, const Accuracy& accuracy) {
    const PairDistance found = narrow_phase_.distance(*A_, *B_, X_AB, INF, accuracy);
    ASSERT_EQ(found.distance <= accuracy.contact_distance, distance <= accuracy.contact_distance);
    if (found.certainty != Certainty::TOLERATED) {
      ASSERT_NEAR(found.distance, distance, rounding_);
      return;
    }
    ++nb_tolerated;
    ASSERT_LE(found.distance, distance + rounding_);
    ASSERT_GE(found.distance, distance - accuracy.tolerance - rounding_);
    // Two points of the surfaces, whose distance is the upper end of what is certain.
    ASSERT_LE((found.p_ACb - found.p_ACa).norm(), found.distance + accuracy.tolerance + rounding_);
    ASSERT_LE(distanceFromSurface(*A_, found.p_ACa), rounding_);
    ASSERT_LE(distanceFromSurface(*B_, X_AB.inverse() * found.p_ACb), rounding_);
    ASSERT_NEAR(found.nhat_AB_A.norm(), 1.0, rounding_);
  }

  void expectLimit(const Isometry3d& X_AB, double distance, double limit, double tolerance) {
    const PairDistance found = narrow_phase_.distance(*A_, *B_, X_AB, limit, {tolerance, 0.0});
    ASSERT_EQ(found.certainty == Certainty::BEYOND, found.distance > limit);
    if (distance <= limit) {
      ASSERT_LE(found.distance, distance + ROUNDING);
      ASSERT_GE(found.distance, distance - tolerance - ROUNDING);
    } else {
      ASSERT_LE(found.distance, distance + ROUNDING);
      ASSERT_GE(found.distance, limit - tolerance);
    }
  }

  int nb_tolerated = 0;

 private:
  std::shared_ptr<const PreparedShape> A_, B_;
  double rounding_ = ROUNDING;
  NarrowPhase narrow_phase_;
};

TEST(Tolerance, OfMeshesTheDistanceIsNoMoreThanTheTruthAndLessByNoMoreThanIt) {
  RandomInputs random;
  const TriangleMesh ball = bumpyBall(10, 0.2), l = LShape().mesh();
  for (const TriangleMesh& other : {l, joined(movedBy(l, {0.3, 0.0, 0.0}), bumpyBall(7, 0.1))}) {
    Question question(meshShape(ball), meshShape(other));
    int nb_contacts = 0;
    for (int i = 0; i < 150; ++i) {
      const Isometry3d X = random.pose(0.5);
      const PairDistance exact = question.exact(X);
      const double truth = distanceOfTriangles(ball, other, X);
      if (exact.touches()) {
        ++nb_contacts;
        continue;
      }
      ASSERT_NEAR(exact.distance, truth, ROUNDING);
      for (const double tolerance : TOLERANCES) {
        question.expectWithin(X, truth, {tolerance, 0.0});
        question.expectLimit(X, truth, random.uniform(0.5, 1.5) * truth, tolerance);
        if (HasFatalFailure()) FAIL() << "pose " << i << ", tolerance " << tolerance;
      }
    }
    EXPECT_GT(nb_contacts, 10);
    EXPECT_GT(question.nb_tolerated, 100);
  }
}

// An L is the union of two boxes: its distance is the smaller of theirs.
TEST(Tolerance, OfAMeshAndAConvexShapeLikewiseInEitherOrder) {
  RandomInputs random;
  const LShape l;
  for (const Shape& shape : {Shape(Box{{0.1, 0.2, 0.3}}), Shape(Sphere{0.1}),
                             Shape(Cylinder{0.1, 0.2}), Shape(Capsule{0.1, 0.2})}) {
    Question first(meshShape(l.mesh()), shape), second(shape, meshShape(l.mesh()));
    Question pieces[] = {{Box{2.0 * l.piece_halves[0]}, shape},
                         {Box{2.0 * l.piece_halves[1]}, shape}};
    for (int i = 0; i < 300; ++i) {
      const Isometry3d X = random.pose(0.5);
      double truth = INF;
      for (int k = 0; k < 2; ++k) {
        Isometry3d X_PB = X;
        X_PB.translation() -= l.piece_centers[k];
        truth = std::min(truth, pieces[k].exact(X_PB).distance);
      }
      if (truth <= 0.0) continue;
      for (const double tolerance : TOLERANCES) {
        first.expectWithin(X, truth, {tolerance, 0.0});
        second.expectWithin(X.inverse(), truth, {tolerance, 0.0});
        if (HasFatalFailure()) FAIL() << shapeName(shape) << ' ' << i << ' ' << tolerance;
      }
    }
    EXPECT_GT(first.nb_tolerated, 25) << shapeName(shape);
    EXPECT_GT(second.nb_tolerated, 25) << shapeName(shape);
  }
}

TEST(Tolerance, OnWhichSideOfAPaddingTheDistanceLiesIsCertain) {
  RandomInputs random;
  const TriangleMesh ball = bumpyBall(10, 0.2), l = LShape().mesh();
  Question question(meshShape(ball), meshShape(l));
  for (int i = 0; i < 150; ++i) {
    const Isometry3d X = random.pose(0.6);
    if (question.exact(X).touches()) continue;
    const double truth = distanceOfTriangles(ball, l, X);
    for (const double padding : {truth - 1e-5, truth - 1e-9, truth + 1e-9, truth + 1e-5}) {
      question.expectWithin(X, truth, {0.05, std::max(padding, 0.0)});
      if (HasFatalFailure()) FAIL() << "pose " << i << ", padding " << padding - truth;
    }
  }
  EXPECT_GT(question.nb_tolerated, 50);
}

using Names = std::pair<std::uint32_t, std::uint32_t>;

std::map<Names, const PairReport*> byModels(const CollisionReport& report) {
  std::map<Names, const PairReport*> pairs;
  for (const PairReport& pair : report.pairs) pairs[{pair.first, pair.second}] = &pair;
  return pairs;
}

/// The report of a scene with a tolerance beside the one without.
class Comparison {
 public:
  explicit Comparison(const std::shared_ptr<const CollisionScene>& scene)
      : exact_(scene), tolerant_(scene) {}

  void compare(const BodyPoses& poses, CheckSettings settings, double tolerance) {
    CheckSettings far = settings;
    far.alarm_distance += tolerance;
    const std::map<Names, const PairReport*> reached = byModels(exact_.detect(poses, far));
    const double min_distance = exact_.report().min_distance;
    settings.tolerance = tolerance;
    const CollisionReport& report = tolerant_.detect(poses, settings);
    ASSERT_EQ(report.tolerance, tolerance);
    ASSERT_EQ(report.verdict, exact_.report().verdict);
    const std::map<Names, const PairReport*> listed = byModels(report);
    for (const auto& [names, pair] : reached) {
      ASSERT_TRUE(listed.count(names) || pair->distance > settings.alarm_distance);
    }
    for (const auto& [names, pair] : listed) {
      const auto truth = reached.find(names);
      ASSERT_TRUE(truth != reached.end()) << "further than the alarm distance and the tolerance";
      expectPair(*pair, report, *truth->second, tolerance);
      if (testing::Test::HasFatalFailure()) return;
    }
    if (report.min_distance_is_bound) return;
    ASSERT_LE(report.min_distance, min_distance + ROUNDING);
    ASSERT_GE(report.min_distance, min_distance - tolerance - ROUNDING);
  }

  int nb_contacts = 0, nb_tolerated = 0;

 private:
  void expectPair(const PairReport& pair, const CollisionReport& report, const PairReport& truth,
                  double tolerance) {
    ASSERT_EQ(pair.state, truth.state);
    if (truth.state == PairState::CONTACT) {
      ++nb_contacts;
      ASSERT_EQ(pair.distance, truth.distance);
      ASSERT_EQ(pair.certainty, truth.certainty);
      const Contact& contact = *report.nearestContact(pair);
      const Contact& expected = *exact_.report().nearestContact(truth);
      ASSERT_LE((contact.p_WFirst - expected.p_WFirst).norm(), 1e-14);  // found in another way
      ASSERT_LE((contact.nhat_W - expected.nhat_W).norm(), 1e-14);
      return;
    }
    ASSERT_LE(pair.distance, truth.distance + ROUNDING);
    ASSERT_GE(pair.distance, truth.distance - tolerance - ROUNDING);
    if (pair.certainty == Certainty::TOLERATED) {
      ++nb_tolerated;
    } else {
      ASSERT_NEAR(pair.distance, truth.distance, ROUNDING);
    }
  }

  CollisionDetector exact_, tolerant_;
};

struct Check {
  std::shared_ptr<const CollisionScene> scene;
  CollisionDetector detector;
  BodyPoses poses;
};

Check mixedCheck() {
  const auto scene = CollisionScene::build(mixedRobot(1), std::nullopt, nullptr);
  BodyPoses poses;
  poses.resize(scene->bodies().size());
  return {scene, CollisionDetector(scene), poses};
}

class OfACheck : public testing::TestWithParam<CheckSettings> {};

TEST_P(OfACheck, ContactsStayAndNearPairsAreNoFurtherThanTheyAre) {
  RandomInputs random;
  SceneSettings padded;
  padded.pair_padding = {{"d", "*", 0.02}};
  for (const SceneSettings& scene_settings : {SceneSettings{}, padded}) {
    const auto scene = CollisionScene::build(mixedRobot(2), std::nullopt, nullptr, scene_settings);
    Comparison comparison(scene);
    BodyPoses poses;
    poses.resize(scene->bodies().size());
    for (int round = 0; round < 60; ++round) {
      throwAbout(random, random.uniform(0.5, 1.5), poses);
      for (const double tolerance : TOLERANCES) {
        comparison.compare(poses, GetParam(), tolerance);
        if (HasFatalFailure()) FAIL() << "round " << round << ", tolerance " << tolerance;
      }
    }
    EXPECT_GT(comparison.nb_contacts, 100);
    EXPECT_GT(comparison.nb_tolerated, 30);
  }
}

CheckSettings nearPairs(double time_budget, bool min_distance) {
  CheckSettings settings;
  settings.alarm_distance = 0.1;
  settings.time_budget = time_budget;
  settings.min_distance = min_distance;
  return settings;
}

INSTANTIATE_TEST_SUITE_P(PairByPair, OfACheck, testing::Values(nearPairs(0.0, false)));
INSTANTIATE_TEST_SUITE_P(WithTheSmallest, OfACheck, testing::Values(nearPairs(0.0, true)));
INSTANTIATE_TEST_SUITE_P(UnderABudget, OfACheck, testing::Values(nearPairs(1e6, true)));

TEST(Tolerance, OfTheSmallestDistanceHoldsBeyondTheAlarmDistance) {
  RandomInputs random;
  auto [scene, detector, poses] = mixedCheck();
  CheckSettings settings;
  settings.min_distance = true;
  settings.alarm_distance = 0.0;
  int nb_less = 0;
  for (int round = 0; round < 300; ++round) {
    throwAbout(random, 4.0, poses);
    settings.tolerance = 0.0;
    const double truth = detector.detect(poses, settings).min_distance;
    settings.tolerance = TOLERANCES[round % 5];
    const double found = detector.detect(poses, settings).min_distance;
    ASSERT_LE(found, truth + ROUNDING) << round;
    ASSERT_GE(found, truth - settings.tolerance - ROUNDING) << round;
    nb_less += found < truth - ROUNDING;
  }
  EXPECT_GT(nb_less, 3);
}

TEST(Tolerance, OfTheRobotsOfTheReferenceHoldsInAllStates) {
  if (benchmarkRobots().empty()) GTEST_SKIP() << "COLLISION_PAIRS_SHARED names no data";
  for (const BenchmarkRobot& robot : benchmarkRobots()) {
    const auto scene = CollisionScene::build(robot.robot, robot.srdf, robot.world, {});
    Comparison comparison(scene);
    BodyPoses poses;
    for (const auto& X_RB : robot.states) {
      scene->gatherPoses(X_RB, poses);
      for (const double tolerance : {1e-4, 1e-3, 5e-3, 2e-2}) {
        comparison.compare(poses, CheckSettings{}, tolerance);
        if (HasFatalFailure()) FAIL() << robot.name << ", tolerance " << tolerance;
      }
    }
    EXPECT_GT(comparison.nb_tolerated, 0) << robot.name;
  }
}

TEST(Tolerance, ThereIsNoGradientOfADistanceThatWasTolerated) {
  RandomInputs random;
  auto [scene, detector, poses] = mixedCheck();
  CheckSettings settings;
  settings.alarm_distance = 0.3;
  settings.tolerance = 0.01;
  const JointColumns joints({}, scene->robot());
  DistanceGradient gradient(*scene, joints);
  int nb_tolerated = 0;
  for (int round = 0; round < 60; ++round) {
    throwAbout(random, 1.0, poses);
    const CollisionReport& report = detector.detect(poses, settings);
    for (const PairReport& pair : report.pairs) {
      if (pair.certainty != Certainty::TOLERATED) continue;
      ++nb_tolerated;
      EXPECT_FALSE(gradient.compute(pair, report, poses.X_WB, nullptr));
    }
  }
  EXPECT_GT(nb_tolerated, 10);
}

TEST(Tolerance, ThatIsNoLengthIsRefused) {
  auto [scene, detector, poses] = mixedCheck();
  for (const double bad : {-1e-3, INF, std::numeric_limits<double>::quiet_NaN()}) {
    CheckSettings settings;
    settings.tolerance = bad;
    EXPECT_THROW(detector.detect(poses, settings), InputError) << bad;
  }
}

}  // namespace collision_pairs::test_tolerance
