// What the features of rough GJK say of a cylinder and another body: if they said nothing, or
// something wrong, answers would stay right, and take ten times as long.
#include <gtest/gtest.h>

#include "cylinder_gap.h"
#include "every_shape.h"
#include "prepared_shape.h"
#include "signed_distance_oracle.h"

namespace collision_pairs::test_cylinder_gap {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double SIZE = 0.2;
constexpr double LEAST_DEPTH = 1e-9;
constexpr double ROUNDING = 1e-15;  // metres: of points of such bodies

struct Found {
  std::vector<PairDistance> gaps;
  std::vector<Vector3d> common;
};

Found featuresOf(const PreparedShape& a, const PreparedShape& b, const Isometry3d& X_AB) {
  const ConvexCore &A = static_cast<const Prepared&>(a).core,
                   &B = static_cast<const Prepared&>(b).core;
  const Difference<double> difference(A, B, X_AB);
  GjkLimits<double> limits;
  limits.narrow = 1e-4 * SIZE;
  const Vector3d start = A.center - X_AB * B.center;
  const GjkResult<double> near = gjk<double>(difference, start, limits);
  Found found;
  if (near.end != GjkEnd::APART) return found;
  CylinderGapSearch(difference, near, LEAST_DEPTH).offer([&](const CylinderGap& gap) {
    if (gap.is_common) {
      found.common.push_back(gap.points.a);
      return false;
    }
    PairDistance pair;
    pair.nhat_AB_A = gap.normal;
    pair.p_ACa = gap.points.a + A.radius * gap.normal;
    pair.p_ACb = gap.points.b - B.radius * gap.normal;
    pair.distance = gap.points.apart() - A.radius - B.radius;
    found.gaps.push_back(pair);
    return false;
  });
  return found;
}

struct Pair {
  Shape a, b;
  Isometry3d X_AB;
  Found found;
};

// A quarter each with a capsule, box, hull of few points and cylinder, in either order.
template <class Gap>
std::vector<Pair> somePairs(const Gap& gap) {
  RandomInputs random;
  NarrowPhase narrow_phase;
  std::vector<Pair> pairs;
  for (const std::string kind : {"capsule", "box", "convex", "cylinder"}) {
    for (int i = 0; i < 100; ++i) {
      Pair pair{shapeOfKind(random, "cylinder", SIZE), shapeOfKind(random, kind, SIZE), {}, {}};
      if (i % 2) std::swap(pair.a, pair.b);
      const auto A = prepareShape(pair.a), B = prepareShape(pair.b);
      pair.X_AB = poseWithGap(random, narrow_phase, *A, *B, SIZE, gap(random));
      pair.found = featuresOf(*A, *B, pair.X_AB);
      pairs.push_back(pair);
    }
  }
  return pairs;
}

TEST(CylinderGap, FeaturesOfRoughGjkGiveNearlyAllDistances) {
  for (const auto& [least, most] : {std::pair{-12.0, -8.0}, std::pair{-5.0, 0.0}}) {
    int right = 0;
    const auto pairs = somePairs([&, low = least, high = most](RandomInputs& random) {
      return std::pow(10.0, random.uniform(low, high));
    });
    for (const Pair& pair : pairs) {
      EXPECT_TRUE(pair.found.common.empty());
      right +=
          std::any_of(pair.found.gaps.begin(), pair.found.gaps.end(), [&](const PairDistance& gap) {
            const auto error = judge(oracleBody(pair.a), oracleBody(pair.b), pair.X_AB, gap, 0.0);
            return error.distance <= 1e-12 * SIZE && error.witness <= 1e-12 * SIZE;
          });
    }
    EXPECT_GE(right, 0.93 * static_cast<double>(pairs.size())) << "gaps from 10^" << least;
  }
}

Shape shrunk(const Shape& shape) {
  const Cylinder& cylinder = std::get<Cylinder>(shape);
  return Cylinder{cylinder.radius - LEAST_DEPTH, cylinder.length - 2.0 * LEAST_DEPTH};
}

TEST(CylinderGap, CommonPointsAreInBoth) {
  std::size_t nb_found = 0;
  const auto pairs =
      somePairs([](RandomInputs& random) { return -std::pow(10.0, random.uniform(-12.0, -4.0)); });
  for (Pair pair : pairs) {
    nb_found += !pair.found.common.empty();
    Shape& cylinder = std::holds_alternative<Cylinder>(pair.a) ? pair.a : pair.b;
    cylinder = shrunk(cylinder);
    for (const Vector3d& point : pair.found.common) {
      PairDistance both;
      both.p_ACa = both.p_ACb = point;
      const WitnessCheck check =
          checkWitnesses(oracleBody(pair.a), oracleBody(pair.b), pair.X_AB, both);
      EXPECT_LE(check.off_a, ROUNDING);
      EXPECT_LE(check.off_b, ROUNDING);
    }
  }
  EXPECT_GE(nb_found, pairs.size() / 4);
}

}  // namespace collision_pairs::test_cylinder_gap
