#include <gtest/gtest.h>

#include "random_inputs.h"
#include "solids.h"
#include "triangle_distance.h"

namespace collision_pairs::test_solids {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// A bumpy ball: not convex, closed, `n` by `n` quadrilaterals.
std::shared_ptr<TriangleMesh> bumpyBall(RandomInputs& random, int n) {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->vertices = {{0, 0, 1}, {0, 0, -1}};
  for (int i = 1; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double theta = M_PI * i / n, phi = 2.0 * M_PI * j / n, r = random.uniform(0.8, 1.0);
      mesh->vertices.emplace_back(r * std::sin(theta) * std::cos(phi),
                                  r * std::sin(theta) * std::sin(phi), r * std::cos(theta));
    }
  }
  const auto at = [n](int i, int j) { return static_cast<std::uint32_t>(2 + (i - 1) * n + j % n); };
  for (int j = 0; j < n; ++j) {
    mesh->triangles.push_back({0, at(1, j), at(1, j + 1)});
    mesh->triangles.push_back({1, at(n - 1, j + 1), at(n - 1, j)});
    for (int i = 1; i + 1 < n; ++i) {
      mesh->triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh->triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

const Prepared& asPrepared(const std::shared_ptr<const PreparedShape>& shape) {
  return static_cast<const Prepared&>(*shape);
}

Triangle triangleAt(const TriangleMesh& mesh, std::size_t i, const Isometry3d& X) {
  const auto& t = mesh.triangles[i];
  return {X * mesh.vertices[t[0]], X * mesh.vertices[t[1]], X * mesh.vertices[t[2]]};
}

/// Every triangle of one against every triangle of the other.
double distanceByAllTriangles(const TriangleMesh& A, const TriangleMesh& B,
                              const Isometry3d& X_AB) {
  ClosestPoints best{std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < A.triangles.size(); ++i) {
    for (std::size_t j = 0; j < B.triangles.size(); ++j) {
      improveByTriangles(triangleAt(A, i, Isometry3d::Identity()), triangleAt(B, j, X_AB), best);
    }
  }
  return std::sqrt(best.squared);
}

TEST(ClosestOnMesh, IsTheNearestOfTheNearestPointsOfAllTriangles) {
  RandomInputs random;
  const auto mesh = bumpyBall(random, 12);
  const auto shape = prepareShape(Mesh{mesh});
  ASSERT_TRUE(asPrepared(shape).mesh);
  for (int round = 0; round < 300; ++round) {
    const Vector3d point = random.vector(-2.0, 2.0);
    double expected = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < mesh->triangles.size(); ++i) {
      const Triangle t = triangleAt(*mesh, i, Isometry3d::Identity());
      expected = std::min(expected, (closestOnTriangle(t, point) - point).norm());
    }
    const Vector3d found = closestOnMesh(*asPrepared(shape).mesh, point);
    EXPECT_NEAR((found - point).norm(), expected, 1e-15);
    EXPECT_TRUE(closestOnPart(*asPrepared(shape).mesh, 0, found, 1e-14));
    EXPECT_FALSE(closestOnPart(*asPrepared(shape).mesh, 0, point, 0.5 * expected));
  }
}

TEST(HullBounds, HoldTheDistanceOfTheSurfacesBetweenThem) {
  RandomInputs random;
  const auto a = bumpyBall(random, 10), b = bumpyBall(random, 8);
  const auto A = prepareShape(Mesh{a}), B = prepareShape(Mesh{b});
  int settled = 0, open = 0;
  for (int round = 0; round < 200; ++round) {
    const Isometry3d X_AB = random.pose(2.0);
    const HullBounds bounds = boundsFromHulls(asPrepared(A), asPrepared(B), X_AB, 1.0, 0.0);
    const double exact = distanceByAllTriangles(*a, *b, X_AB);
    switch (bounds.outcome) {
      case HullBounds::Outcome::BEYOND:
        EXPECT_GT(exact, 1.0);
        EXPECT_LE(bounds.hulls.distance, exact + 1e-14);
        break;
      case HullBounds::Outcome::SETTLED:
        ++settled;
        EXPECT_NEAR(bounds.hulls.distance, exact, 1e-13);
        break;
      case HullBounds::Outcome::APART:
        EXPECT_LE(bounds.hulls.distance, exact + 1e-14);
        EXPECT_GE(bounds.upper, exact - 1e-14);
        break;
      case HullBounds::Outcome::OPEN:
        ++open;
    }
    EXPECT_TRUE(!hullsMiss(asPrepared(A), asPrepared(B), X_AB, 0.0) || exact > 0.0);
  }
  EXPECT_GT(settled, 10);
  EXPECT_GT(open, 10);
}

TEST(HullBounds, AHullMissesNoPointInItAndAllBeyondItsReach) {
  RandomInputs random;
  const auto mesh = bumpyBall(random, 10);
  const auto shape = prepareShape(Mesh{mesh});
  const auto anyVertex = [&] {
    return mesh->vertices[random.integer(0, static_cast<int>(mesh->vertices.size()) - 1)];
  };
  for (int i = 0; i < 2000; ++i) {
    const double s = random.uniform(0.0, 1.0), t = random.uniform(0.0, 1.0);
    const Vector3d inside =
        s * anyVertex() + (1.0 - s) * (t * anyVertex() + (1.0 - t) * anyVertex());
    ASSERT_FALSE(hullMisses(asPrepared(shape), inside));
    const Vector3d outside = random.uniform(1.001, 3.0) * random.vector(-1.0, 1.0).normalized();
    ASSERT_TRUE(hullMisses(asPrepared(shape), outside));
  }
}

TEST(HullBounds, NarrowPhaseOfBumpyBodiesIsThatOfAllTriangles) {
  RandomInputs random;
  const auto a = bumpyBall(random, 16), b = bumpyBall(random, 14);
  const auto A = prepareShape(Mesh{a}), B = prepareShape(Mesh{b});
  NarrowPhase narrow_phase;
  for (int round = 0; round < 60; ++round) {
    const Isometry3d X_AB = random.pose(2.5);
    const double exact = distanceByAllTriangles(*a, *b, X_AB);
    const PairDistance found = narrow_phase.distance(*A, *B, X_AB, 10.0);
    if (found.touches()) continue;  // then one may be inside the other, which triangles do not see
    EXPECT_NEAR(found.distance, exact, 1e-13);
    EXPECT_NEAR((found.p_ACb - found.p_ACa).norm(), exact, 1e-13);
    EXPECT_TRUE(found.nhat_AB_A.isApprox((found.p_ACb - found.p_ACa).normalized(), 1e-6));
  }
}

}  // namespace collision_pairs::test_solids
