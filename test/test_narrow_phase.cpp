#include <gtest/gtest.h>

#include "collision_pairs/narrow_phase.h"
#include "every_shape.h"
#include "pose_repair.h"
#include "random_inputs.h"
#include "test_shapes.h"

namespace collision_pairs::test_narrow_phase {

using Eigen::Isometry3d;
using Eigen::Vector3d;
constexpr double INF = std::numeric_limits<double>::infinity();

std::vector<Shape> everyShape() {
  const auto hull = std::make_shared<TriangleMesh>(bumpyBall(6, 0.15));
  return {Box{{0.1, 0.2, 0.3}}, Sphere{0.15}, Cylinder{0.1, 0.2},        Capsule{0.1, 0.2},
          HalfSpace{},          Convex{hull}, meshShape(LShape().mesh())};
}

bool bothHalfSpaces(const PreparedShape& A, const PreparedShape& B) {
  return std::holds_alternative<HalfSpace>(A.shape()) &&
         std::holds_alternative<HalfSpace>(B.shape());
}

TEST(PoseRepair, LeavesRotationsAsTheyAreAndRepairsEachEntryThatIsOff) {
  RandomInputs random;
  for (int round = 0; round < 100; ++round) {
    const Isometry3d exact = random.pose(1.0);
    EXPECT_TRUE(isSound(exact));
    for (int i = 0; i < 9; ++i) {
      for (const double off : {1e-11, 1e-5, -3e-4}) {
        Isometry3d X = exact;
        X.matrix()(i % 3, i / 3) += off;
        EXPECT_FALSE(isSound(X) && std::abs(exact.matrix()(i % 3, i / 3)) > 1e-2) << i;
        ASSERT_TRUE(repairPose(X)) << i;
        EXPECT_TRUE(isSound(X)) << i;
        EXPECT_LE((X.matrix() - exact.matrix()).norm(), 2.0 * std::abs(off));
      }
      Isometry3d none = exact;
      none.matrix()(i % 3, i / 3) += 0.1;
      EXPECT_FALSE(repairPose(none)) << i;
    }
    for (const double scale : {1.0 + 0.49e-3, 1.0 - 0.49e-3, 1.0 + 0.51e-3, 1.0 - 0.51e-3}) {
      Isometry3d scaled = exact;  // x . x is off by twice as much, of 1e-3
      scaled.linear().col(round % 3) *= scale;
      EXPECT_FALSE(isSound(scaled));
      EXPECT_EQ(repairPose(scaled), std::abs(scale - 1.0) < 0.5e-3) << scale;
    }
    Isometry3d mirrored = exact;
    mirrored.linear().col(round % 3) *= -1.0;
    EXPECT_FALSE(isSound(mirrored));
    EXPECT_FALSE(repairPose(mirrored));
    Isometry3d nowhere = exact;
    nowhere.translation()[round % 3] = round % 2 ? INF : std::nan("");
    EXPECT_FALSE(isSound(nowhere));
    EXPECT_FALSE(repairPose(nowhere));
  }
}

/// Whatever is asked of a pair, the answers agree.
void expectOneTruth(NarrowPhase& narrow_phase, const PreparedShape& A, const PreparedShape& B,
                    const Isometry3d& X_AB, double limit) {
  const PairDistance full = narrow_phase.distance(A, B, X_AB, INF);
  ASSERT_EQ(narrow_phase.touches(A, B, X_AB), full.touches());
  const PairDistance cut = narrow_phase.distance(A, B, X_AB, limit);
  if (full.distance > limit + 1e-9) {  // a lower bound
    ASSERT_EQ(cut.certainty, Certainty::BEYOND);
    ASSERT_LE(cut.distance, full.distance + 1e-12);
    ASSERT_GE(cut.distance, limit);
  }
  if (bothHalfSpaces(A, B)) return;
  if (full.distance < limit - 1e-9) {
    ASSERT_NE(cut.certainty, Certainty::BEYOND);
    ASSERT_NEAR(cut.distance, full.distance, 1e-9);
  }
  ASSERT_NEAR(narrow_phase.distance(B, A, X_AB.inverse(), INF).distance, full.distance, 1e-9);
  const Vector3d apart = full.p_ACb - full.p_ACa;
  ASSERT_NEAR(full.nhat_AB_A.norm(), 1.0, 1e-12);
  ASSERT_NEAR(apart.dot(full.nhat_AB_A), full.distance, 1e-6);
  ASSERT_NEAR(apart.norm(), std::abs(full.distance), 1e-6);
  ASSERT_TRUE(apart.allFinite());
  ASSERT_NE(full.certainty, Certainty::DEGRADED);
  if (!full.touches()) return;
  Isometry3d separated = X_AB;
  separated.translation() += (1e-8 - full.distance) * full.nhat_AB_A;
  ASSERT_FALSE(narrow_phase.touches(A, B, separated)) << full.distance;
}

TEST(NarrowPhase, VerdictDistanceNormalPointsAndLimitsAgreeInEitherOrderOfTheShapes) {
  RandomInputs random;
  NarrowPhase narrow_phase;
  for (const Shape& a : everyShape()) {
    for (const Shape& b : everyShape()) {
      SCOPED_TRACE(std::string(shapeName(a)) + "-" + shapeName(b));
      const auto A = prepareShape(a), B = prepareShape(b);
      for (int i = 0; i < 100; ++i) {
        const Isometry3d X_AB = random.pose(0.4);
        ASSERT_NO_FATAL_FAILURE(
            expectOneTruth(narrow_phase, *A, *B, X_AB, random.uniform(0.0, 0.4)));
      }
    }
  }
}

// The direction in which a pair is further apart than in any other says most, and may be another
// pair's.
TEST(NarrowPhase, ADirectionThatIsTriedFirstChangesNoAnswer) {
  RandomInputs random;
  NarrowPhase asked, fresh;
  std::size_t nb_told = 0;
  for (const std::string& a : EVERY_KIND) {
    for (const std::string& b : EVERY_KIND) {
      SCOPED_TRACE(a + "-" + b);
      const auto A = prepareShape(shapeOfKind(random, a, 0.3));
      const auto B = prepareShape(shapeOfKind(random, b, 0.3));
      Vector3d tried = Vector3d::Zero();
      for (int i = 0; i < 60; ++i) {
        const double margin = i % 3 == 0 ? 0.02 : 0.0;
        const double size = std::pow(10.0, random.uniform(-18.0, -1.0));
        const double gap = margin + (i % 2 == 0 ? size : -size);
        const Isometry3d X_AB = poseWithGap(random, fresh, *A, *B, 0.3, gap);
        const bool expected = fresh.touches(*A, *B, X_AB, margin);
        const Vector3d best = fresh.distance(*A, *B, X_AB, INF).nhat_AB_A;
        for (Vector3d along : {tried, best, Vector3d(-best), random.vector(-1, 1).normalized()}) {
          ASSERT_EQ(asked.touches(*A, *B, X_AB, margin, 0.0, &along), expected) << gap;
          ASSERT_TRUE(!expected || along.isZero(0.0)) << along;
          tried = along;
          nb_told += !along.isZero(0.0);
        }
      }
    }
  }
  EXPECT_EQ(asked.numDegraded(), 4 * fresh.numDegraded());
  EXPECT_GT(nb_told, 1000u);
}

/// By what `between` remembers.
void expectNoBitChanged(NarrowPhase& asked, const PreparedShape& A, const PreparedShape& B,
                        const Isometry3d& X_AB, double limit, ClosestVertices& between) {
  const PairDistance expected = NarrowPhase().distance(A, B, X_AB, limit);
  const PairDistance found = asked.distance(A, B, X_AB, limit, {}, 0.0, &between);
  ASSERT_EQ(found.distance, expected.distance);
  ASSERT_EQ(found.certainty, expected.certainty);
  ASSERT_EQ(found.p_ACa, expected.p_ACa);
  ASSERT_EQ(found.p_ACb, expected.p_ACb);
  ASSERT_EQ(found.nhat_AB_A, expected.nhat_AB_A);
}

// Along motions that pass one another, touch and lie on parallel faces; sometimes with what was
// found of another pair.
TEST(NarrowPhase, WhereTheClosestPointsWereChangesNoDistance) {
  RandomInputs random;
  NarrowPhase asked, fresh;
  const auto hullOfBox = [&]() -> Shape {
    return Convex{std::make_shared<TriangleMesh>(boxMesh(random.vector(0.05, 0.2)))};
  };
  ClosestVertices between;
  std::size_t nb_known = 0;
  for (int motion = 0; motion < 120; ++motion) {
    const std::string kind = EVERY_KIND[4 + motion % 4];
    const auto A = prepareShape(motion % 3 == 0 ? hullOfBox() : shapeOfKind(random, kind, 0.3));
    const auto B = prepareShape(motion % 5 == 0 ? hullOfBox() : shapeOfKind(random, "hull", 0.3));
    const bool is_parallel = motion % 15 == 0, is_near = motion % 2 == 0;
    Isometry3d X_AB = poseWithGap(random, fresh, *A, *B, 0.3, is_near ? 1e-3 : 0.1);
    if (is_parallel) X_AB.linear().setIdentity();
    const Vector3d step = random.vector(-2e-3, 2e-3), axis = random.vector(-1, 1).normalized();
    for (int i = 0; i < 100; ++i) {
      X_AB.translation() += step;
      if (!is_parallel) X_AB.rotate(Eigen::AngleAxisd(0.005, axis));
      const double limit = i % 10 == 9 ? 0.05 : INF;
      const bool is_known = between.a[0] >= 0;
      expectNoBitChanged(asked, *A, *B, X_AB, limit, between);
      ASSERT_FALSE(HasFatalFailure()) << motion << ' ' << i;
      nb_known += is_known && between.a[0] >= 0;
    }
  }
  EXPECT_GT(nb_known, 4000u);
}

/// A prism with so many sides that its hull is walked along its edges; as thin as a plate or not.
Shape prism(RandomInputs& random) {
  auto mesh = std::make_shared<TriangleMesh>();
  const int sides = 4 * random.integer(8, 16);
  const double height = random.integer(0, 1) ? 1e-3 : 0.3;
  for (int i = 0; i < sides; ++i) {
    const double angle = 2.0 * M_PI * i / sides;
    for (const double z : {-height, height})
      mesh->vertices.emplace_back(0.3 * std::cos(angle), 0.3 * std::sin(angle), z);
  }
  return Convex{mesh};
}

// Of faces and edges that are parallel or nearly so, many points are the closest.
TEST(NarrowPhase, WhereTheClosestPointsOfNearlyParallelBodiesWereChangesNoDistanceEither) {
  RandomInputs random;
  NarrowPhase asked;
  int nb_apart = 0;
  for (int round = 0; round < 150; ++round) {
    const auto A = prepareShape(prism(random)), B = prepareShape(prism(random));
    Isometry3d X_AB = Isometry3d::Identity();
    const Vector3d axis = Vector3d::Unit(random.integer(0, 2));
    X_AB.linear() = Eigen::AngleAxisd(0.5 * M_PI * random.integer(0, 3), axis).toRotationMatrix();
    X_AB.translation() = random.uniform(0.3, 0.8) * Vector3d::Unit(random.integer(0, 2));
    ClosestVertices between;
    for (int step = 0; step < 20; ++step) {
      const double tilt = random.integer(0, 2) ? std::pow(10.0, random.uniform(-16.0, -2.0)) : 0.0;
      X_AB.rotate(Eigen::AngleAxisd(tilt, random.rotation() * Vector3d::UnitX()));
      X_AB.translation() += tilt * random.vector(-1.0, 1.0);
      for (int i = 0; i < 2; ++i) expectNoBitChanged(asked, *A, *B, X_AB, INF, between);
      nb_apart += !asked.touches(*A, *B, X_AB);
    }
  }
  EXPECT_GT(nb_apart, 1000);
}

TEST(NarrowPhase, APoseThatIsNoPoseIsADegradedContact) {
  NarrowPhase narrow_phase;
  const auto A = prepareShape(Box{{0.1, 0.2, 0.3}});
  const auto B = prepareShape(meshShape(LShape().mesh()));
  Isometry3d X_AB = Isometry3d::Identity();
  X_AB.translation() = Vector3d(0.1 / 3.0, 2.0, std::nan(""));
  const PairDistance result = narrow_phase.distance(*A, *B, X_AB, 0.7);
  EXPECT_EQ(result.certainty, Certainty::DEGRADED);
  EXPECT_LT(result.distance, -0.5) << "they may be as deep in each other as they are large";
  EXPECT_TRUE(narrow_phase.touches(*A, *B, X_AB));
  EXPECT_EQ(narrow_phase.numDegraded(), 2U);
}

TEST(NarrowPhase, ARotationThatIsNoneIsADegradedContact) {
  NarrowPhase narrow_phase;
  Isometry3d X_AB = Isometry3d::Identity();
  X_AB.linear() *= 2.0;
  const auto A = prepareShape(Sphere{1.0});
  EXPECT_TRUE(narrow_phase.touches(*A, *A, X_AB));
  EXPECT_EQ(narrow_phase.numDegraded(), 1U);
  X_AB.linear() = Vector3d(-1.0, 1.0, 1.0).asDiagonal();  // a reflection
  X_AB.translation().x() = 9.0;
  EXPECT_EQ(narrow_phase.distance(*A, *A, X_AB, INF).certainty, Certainty::DEGRADED);
  EXPECT_TRUE(narrow_phase.touches(*A, *A, X_AB));
  EXPECT_EQ(narrow_phase.numDegraded(), 3U);
}

// A corner of a box above the inner face of an L, so near that the two points tell no direction.
TEST(NarrowPhase, SurfacesThatNearlyTouchHaveTheNormalOfTheFace) {
  RandomInputs random;
  NarrowPhase narrow_phase;
  const auto A = prepareShape(meshShape(LShape().mesh()));  // the face is z = 0.05
  const Vector3d half(0.02, 0.01, 0.015);
  const auto B = prepareShape(Box{2.0 * half});
  for (int i = 0; i < 100; ++i) {
    Isometry3d X_AB = random.pose(0.0);
    double lowest = 0.0;
    for (const Vector3d& p : boxMesh(half).vertices) lowest = std::min(lowest, (X_AB * p).z());
    X_AB.translation() = Vector3d(-0.05, 0.0, 0.05 - lowest + 1e-14);
    const PairDistance result = narrow_phase.distance(*A, *B, X_AB, 1.0);
    if (result.touches()) continue;  // by rounding
    EXPECT_TRUE(result.nhat_AB_A.isApprox(Vector3d::UnitZ(), 1e-6)) << result.nhat_AB_A.transpose();
  }
}

TEST(NarrowPhase, AQuaternionThatIsNotQuiteNormalisedIsMended) {
  RandomInputs random;
  NarrowPhase narrow_phase;
  const auto A = prepareShape(Box{{0.1, 0.2, 0.3}}), B = prepareShape(Cylinder{0.1, 0.2});
  for (int i = 0; i < 200; ++i) {
    const Isometry3d X_AB = random.pose(0.5);
    Isometry3d off = X_AB;
    off.linear() *= 1.0 + random.uniform(-1e-4, 1e-4);
    ASSERT_NEAR(narrow_phase.distance(*A, *B, off, INF).distance,
                narrow_phase.distance(*A, *B, X_AB, INF).distance, 1e-9);
  }
  EXPECT_EQ(narrow_phase.numDegraded(), 0U);
}

TEST(NarrowPhase, VerticesWithoutATriangleAreNoPartOfAMesh) {
  NarrowPhase narrow_phase;
  TriangleMesh mesh = boxMesh({0.5, 0.5, 0.5});
  mesh.vertices.emplace_back(9.0, 0.0, 0.0);
  const auto A = prepareShape(meshShape(mesh)), B = prepareShape(Sphere{0.5});
  Isometry3d X_AB = Isometry3d::Identity();
  X_AB.translation().x() = 5.0;
  EXPECT_DOUBLE_EQ(narrow_phase.distance(*A, *B, X_AB, INF).distance, 4.0);
}

TEST(NarrowPhase, DefectiveShapesAreRefusedByName) {
  EXPECT_THROW(prepareShape(Sphere{-1.0}), std::invalid_argument);
  EXPECT_THROW(prepareShape(Box{{1.0, std::nan(""), 1.0}}), std::invalid_argument);
  EXPECT_THROW(prepareShape(Mesh{std::make_shared<TriangleMesh>()}), std::invalid_argument);
}

}  // namespace collision_pairs::test_narrow_phase
