// Shapes with sizes and positions in steps of 25 mm and frames turned by quarters, as people build
// scenes: edges and axes that pass exactly through faces and through each other, common centres,
// sides without thickness and axes without length.
#include <gtest/gtest.h>

#include "random_inputs.h"
#include "signed_distance_oracle.h"
#include "test_shapes.h"

namespace collision_pairs::test_aligned_shapes {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double INF = std::numeric_limits<double>::infinity();
constexpr double STEP = 0.025;
constexpr double ROUNDING = 3e-13;  // metres: 1e-12 of the smaller body (docs/accuracy.md)

double steps(RandomInputs& random, int least, int most) {
  return STEP * random.integer(least, most);
}

Convex octahedron(double a) {
  auto corners = std::make_shared<TriangleMesh>();
  for (int k = 0; k < 6; ++k) corners->vertices.push_back((k < 3 ? a : -a) * Vector3d::Unit(k % 3));
  return Convex{corners};
}

// One side or length in eight is 0.
Shape someShape(RandomInputs& random) {
  const auto side = [&] { return random.integer(0, 7) == 0 ? 0.0 : steps(random, 1, 8); };
  const double radius = steps(random, 1, 6);
  switch (random.integer(0, 5)) {
    case 0:
      return Box{{steps(random, 1, 8), steps(random, 1, 8), side()}};
    case 1:
      return Sphere{radius};
    case 2:
      return Cylinder{radius, side()};
    case 3:
      return Capsule{radius, side()};
    case 4:
      return Convex{std::make_shared<TriangleMesh>(
          boxMesh({steps(random, 1, 4), steps(random, 1, 4), steps(random, 1, 4)}))};
    default:
      return octahedron(radius);
  }
}

Matrix3d quarterTurn(RandomInputs& random) {
  const int x = random.integer(0, 2), y = (x + random.integer(1, 2)) % 3;
  Matrix3d R;
  R.col(0) = (random.integer(0, 1) ? 1.0 : -1.0) * Vector3d::Unit(x);
  R.col(1) = (random.integer(0, 1) ? 1.0 : -1.0) * Vector3d::Unit(y);
  R.col(2) = R.col(0).cross(R.col(1));
  return R;
}

// On the grid, or off it along some axes.
Isometry3d somePose(RandomInputs& random) {
  Isometry3d X = Isometry3d::Identity();
  X.linear() = quarterTurn(random);
  for (int i = 0; i < 3; ++i) {  // Eigen 3.3 iterates over no block
    const int where = random.integer(0, 3);
    if (where < 3)
      X.translation()[i] = where == 0   ? 0.0
                           : where == 1 ? steps(random, -10, 10)
                                        : random.uniform(-0.3, 0.3);
  }
  return X;
}

struct Pair {
  explicit Pair(RandomInputs& random)
      : a(someShape(random)), b(someShape(random)), X_AB(somePose(random)) {}
  std::string name(int i) const {
    return "pair " + std::to_string(i) + ", kinds " + std::to_string(a.index()) + " and " +
           std::to_string(b.index());
  }

  Shape a, b;
  Isometry3d X_AB;
};

double heightOf(const OracleBody& A, const OracleBody& B, const Isometry3d& X_AB,
                const Vector3d& n) {
  return static_cast<double>(height<long double>(A, B, X_AB, cast<long double>(n)));
}

TEST(AlignedShapes, TheNormalIsAUnitVectorAlongWhichTheDistanceIsMeasured) {
  RandomInputs random;
  for (int i = 0; i < 40000; ++i) {
    const Pair pair(random);
    NarrowPhase narrow_phase;
    const auto A = prepareShape(pair.a), B = prepareShape(pair.b);
    const PairDistance found = narrow_phase.distance(*A, *B, pair.X_AB, INF);
    SCOPED_TRACE(pair.name(i));
    ASSERT_NE(found.certainty, Certainty::DEGRADED);
    ASSERT_NEAR(found.nhat_AB_A.norm(), 1.0, 1e-12);
    const OracleBody a = oracleBody(pair.a), b = oracleBody(pair.b);
    ASSERT_NEAR(-heightOf(a, b, pair.X_AB, found.nhat_AB_A), found.distance, ROUNDING);
    ASSERT_EQ(narrow_phase.touches(*A, *B, pair.X_AB), found.touches());
  }
}

TEST(AlignedShapes, WithFclToo) {
  constexpr double ACCURACY = 1e-6;
  RandomInputs random;
  for (int i = 0; i < 20000; ++i) {
    const Pair pair(random);
    NarrowPhase narrow_phase;
    const auto A = prepareShape(pair.a, NarrowPhaseMethod::FCL),
               B = prepareShape(pair.b, NarrowPhaseMethod::FCL);
    const PairDistance found = narrow_phase.distance(*A, *B, pair.X_AB, INF);
    SCOPED_TRACE(pair.name(i));
    ASSERT_NE(found.certainty, Certainty::DEGRADED);
    ASSERT_NEAR(found.nhat_AB_A.norm(), 1.0, 1e-12);
    const double along =
        -heightOf(oracleBody(pair.a), oracleBody(pair.b), pair.X_AB, found.nhat_AB_A);
    ASSERT_NEAR(along, found.distance, ACCURACY);
  }
}

// No direction is better; of a depth that is not proved, none of the natural ones.
TEST(AlignedShapes, TheDepthIsTheLeastAndTheDistanceThatOfTheWitnessPoints) {
  RandomInputs random;
  for (int i = 0; i < 10000; ++i) {
    const Pair pair(random);
    NarrowPhase narrow_phase;
    const PairDistance found =
        narrow_phase.distance(*prepareShape(pair.a), *prepareShape(pair.b), pair.X_AB, INF);
    const OracleBody a = oracleBody(pair.a), b = oracleBody(pair.b);
    SCOPED_TRACE(pair.name(i));
    if (found.distance > 0.0) {
      ASSERT_LE(checkWitnesses(a, b, pair.X_AB, found).error(found.distance), ROUNDING);
      continue;
    }
    for (int k = 0; k < 27; ++k) {
      const Vector3d n(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
      if (n.isZero()) continue;
      ASSERT_GE(heightOf(a, b, pair.X_AB, n), -found.distance - ROUNDING) << n;
    }
    for (int k = 0; k < 20; ++k) {
      const Vector3d n = random.rotation() * Vector3d::UnitX();
      ASSERT_GE(heightOf(a, b, pair.X_AB, n), -found.distance - ROUNDING) << n;
    }
  }
}

}  // namespace collision_pairs::test_aligned_shapes
