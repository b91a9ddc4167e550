// Cylinders where it is hard: nearly coaxial, upon themselves, beside what is a million times
// larger or as thin, and yes or no of slivers. Errors are relative to the smaller body's size.
#include <gtest/gtest.h>

#include "benchmark/cylinder_rows.h"
#include "certified_depth.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
constexpr double INF = std::numeric_limits<double>::infinity();

PairDistance distanceOf(const Shape& a, const Shape& b, const Isometry3d& X_AB) {
  NarrowPhase narrow_phase;
  return narrow_phase.distance(*prepareShape(a), *prepareShape(b), X_AB, INF);
}

// Goals: distance 1e-12 of the smaller body's size or 64 roundings of the larger one; depth 1e-6 of
// the smaller, whether or not it is called a bound.
void holdRow(const CylinderRow& row, int poses, double witness_accuracy) {
  SCOPED_TRACE(row.name);
  RandomInputs random;
  for (int i = 0; i < poses; ++i) {
    const PosedPair pair = row.make(random, i);
    const double size = std::min(sizeOf(pair.a), sizeOf(pair.b));
    const PairDistance result = distanceOf(pair.a, pair.b, pair.X_AB);
    ASSERT_NE(result.certainty, Certainty::DEGRADED) << "pose " << i;
    const CylinderError error = judgeCylinder(pair, result, 5e-7 * size, 1500000);
    ASSERT_FALSE(error.wrong_verdict) << "pose " << i;
    const double rounding =
        64.0 * std::numeric_limits<double>::epsilon() * std::max(sizeOf(pair.a), sizeOf(pair.b));
    ASSERT_LE(error.distance, std::max(1e-12 * size, rounding)) << "pose " << i;
    ASSERT_LE(error.depth, 1e-6 * size) << "pose " << i;
    ASSERT_LE(error.witness, witness_accuracy * size) << "pose " << i;
  }
}

TEST(Cylinders, NearlyCoaxialOnesHaveTheLeastDepth) {
  for (const CylinderRow& row : coaxialRows()) holdRow(row, 12, 1e-9);
}

// Where a whole circle of directions is nearly as good no polytope comes near enough to the surface
// to prove the depth.
TEST(Cylinders, ADepthThatIsNotProvenIsCalledABound) {
  RandomInputs random;
  int nb_exact = 0;
  for (int i = 0; i < 20; ++i) {
    const Cylinder a{random.uniform(0.1, 0.2), 1.0}, b{random.uniform(0.1, 0.2), 1.0};
    Isometry3d X_AB = Isometry3d::Identity();
    X_AB.translation() = random.vector(-1e-8, 1e-8);
    EXPECT_EQ(distanceOf(a, b, X_AB).certainty, Certainty::BOUND) << i;
    nb_exact += distanceOf(a, b, random.pose(0.1)).certainty == Certainty::EXACT;
  }
  EXPECT_GT(nb_exact, 0);
}

TEST(Cylinders, OneUponItselfHasTheLeastDepth) {
  for (const CylinderRow& row : uponItselfRows()) holdRow(row, 12, 1e-9);
}

TEST(Cylinders, SizesThatDifferByAThousandAndAMillion) {
  for (const CylinderRow& row : mixedRows(1e3)) holdRow(row, 8, 1e-8);
  for (const CylinderRow& row : mixedRows(1e6)) holdRow(row, 4, 1e-4);
}

TEST(Cylinders, BesideWhatIsAMillionTimesThinner) {
  for (const CylinderRow& row : thinRows()) holdRow(row, 8, 1e-8);
}

// The difference of two parallel cylinders is a cylinder.
TEST(Cylinders, ParallelOnesHaveTheDepthOfTheFormula) {
  RandomInputs random;
  for (int i = 0; i < 2000; ++i) {
    const Cylinder a{random.uniform(0.03, 0.15), random.uniform(0.05, 0.3)};
    const Cylinder b = i % 2 ? a : Cylinder{random.uniform(0.03, 0.15), random.uniform(0.05, 0.3)};
    Isometry3d X_AB = Isometry3d::Identity();
    X_AB.translation() =
        std::pow(10.0, random.uniform(-16.0, -1.0)) * (random.rotation() * Vector3d::UnitX());
    if (i % 5 == 0) X_AB.translation().head<2>().setZero();
    const PairDistance result = distanceOf(a, b, X_AB);
    const Vector3d p = X_AB.translation();
    const double truth = std::min(a.radius + b.radius - std::hypot(p[0], p[1]),
                                  0.5 * (a.length + b.length) - std::abs(p[2]));
    ASSERT_NEAR(-result.distance, truth, 1e-14) << i;
    ASSERT_NE(result.certainty, Certainty::DEGRADED) << i;
  }
}

TEST(Cylinders, WitnessPointsNearTouchingAreAsFarApartAsTheDistance) {
  RandomInputs random;
  NarrowPhase narrow_phase;
  for (const std::string kind : {"box", "cylinder", "capsule", "convex"}) {
    for (int i = 0; i < 1000; ++i) {
      const Shape a = randomShape(random, "cylinder"), b = randomShape(random, kind);
      const Isometry3d X_AB = randomPose(random, narrow_phase, *prepareShape(a), *prepareShape(b),
                                         i % 2 ? Separation::NEAR : Separation::SLIGHT);
      const PairDistance result = distanceOf(a, b, X_AB);
      const WitnessCheck points = checkWitnesses(oracleBody(a), oracleBody(b), X_AB, result);
      ASSERT_LE(points.error(result.distance), 1e-10) << kind << " " << i;
    }
  }
}

// Yes or no takes a short cut that the distance does not take.
TEST(Cylinders, YesOrNoOfSliversIsTheSignOfTheDistance) {
  RandomInputs random;
  NarrowPhase narrow_phase;
  int touching = 0, apart = 0;
  for (int i = 0; i < 20000; ++i) {
    const PosedPair pair = sliverPair(random, narrow_phase, i);
    const auto A = prepareShape(pair.a), B = prepareShape(pair.b);
    const PairDistance result = narrow_phase.distance(*A, *B, pair.X_AB, INF);
    const double rounding = 1e-15 * (sizeOf(pair.a) + sizeOf(pair.b));
    if (std::abs(result.distance) <= rounding) continue;
    ASSERT_EQ(narrow_phase.touches(*A, *B, pair.X_AB), result.touches())
        << i << " " << result.distance;
    ++(result.touches() ? touching : apart);
  }
  EXPECT_GT(touching, 5000);
  EXPECT_GT(apart, 5000);
}

TEST(Cylinders, YesOrNoWithAMarginIsThatOfTheDistance) {
  RandomInputs random;
  NarrowPhase narrow_phase;
  const std::vector<std::string> kinds{"box", "sphere", "cylinder", "capsule", "convex"};
  for (int i = 0; i < 4000; ++i) {
    const auto A = prepareShape(randomShape(random, kinds[random.integer(0, 4)]));
    const auto B = prepareShape(randomShape(random, kinds[random.integer(0, 4)]));
    const Isometry3d X_AB = random.pose(0.4);
    const double distance = narrow_phase.distance(*A, *B, X_AB, INF).distance;
    for (const double margin : {0.0, 0.05, 0.2, distance - 1e-9, distance + 1e-9}) {
      if (margin < 0.0) continue;
      ASSERT_EQ(narrow_phase.touches(*A, *B, X_AB, margin), distance <= margin) << i;
    }
  }
}

}  // namespace
}  // namespace collision_pairs
