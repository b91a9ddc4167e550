#include <gtest/gtest.h>

#include "mesh_bounds.h"
#include "random_inputs.h"

namespace collision_pairs::test_enclosure {

TriangleMesh randomPoints(RandomInputs& random, int count, const Eigen::Vector3d& scale) {
  TriangleMesh mesh;
  const Eigen::Isometry3d X = random.pose(2.0);
  for (int i = 0; i < count; ++i) {
    mesh.vertices.push_back(X * random.vector(-1.0, 1.0).cwiseProduct(scale));
  }
  return mesh;
}

TEST(Enclosure, BoxHoldsEveryVertexAndIsNoLargerThanTheAlignedBox) {
  RandomInputs random;
  for (int round = 0; round < 1000; ++round) {
    const Eigen::Vector3d scale(1.0, random.uniform(0.0, 1.0), random.integer(0, 3) ? 0.3 : 0.0);
    const TriangleMesh mesh = randomPoints(random, random.integer(1, 60), scale);
    const auto [box, X_EO] = enclosingBox(Convex{std::make_shared<TriangleMesh>(mesh)});
    Eigen::Vector3d lower = mesh.vertices[0], upper = lower;
    for (const Eigen::Vector3d& p_E : mesh.vertices) {
      const Eigen::Vector3d p_O = X_EO.inverse() * p_E;
      EXPECT_TRUE((p_O.cwiseAbs().array() <= 0.5 * box.size.array()).all()) << round;
      lower = lower.cwiseMin(p_E);
      upper = upper.cwiseMax(p_E);
    }
    EXPECT_LE(box.size.prod(), (upper - lower).prod() * (1.0 + 1e-9) + 1e-12);
  }
}

TEST(Enclosure, BoxOfATurnedBoxIsThatBox) {
  RandomInputs random;
  TriangleMesh mesh;
  const Eigen::Matrix3d R = random.rotation().toRotationMatrix();
  for (int corner = 0; corner < 8; ++corner) {
    mesh.vertices.push_back(
        R * Eigen::Vector3d(corner & 1 ? 1 : -1, corner & 2 ? 2 : -2, corner & 4 ? 4 : -4));
  }
  const auto [box, X_EO] = enclosingBox(Convex{std::make_shared<TriangleMesh>(mesh)});
  EXPECT_NEAR(box.size.prod(), 2.0 * 4.0 * 8.0, 1e-9);
}

TEST(Enclosure, BoxOfACapsuleHoldsBothOfItsCaps) {
  const auto [box, X_EO] = enclosingBox(Capsule{0.1, 1.0});
  EXPECT_TRUE(X_EO.isApprox(Eigen::Isometry3d::Identity()));
  EXPECT_GE(0.5 * box.size.z(), 0.5 * 1.0 + 0.1);
  EXPECT_GE(0.5 * box.size.x(), 0.1);
  EXPECT_GE(0.5 * box.size.y(), 0.1);
}

TEST(Enclosure, FewerPointsGrownByTheirMarginReachAsFar) {
  RandomInputs random;
  for (int round = 0; round < 30; ++round) {
    TriangleMesh ball;
    for (int i = 0; i < 400; ++i)
      ball.vertices.push_back(random.rotation() * Eigen::Vector3d(1, 0, 0));
    const double tolerance = random.uniform(1e-3, 1e-1);
    const FewerPoints fewer = fewerPoints(ball.vertices, tolerance);
    EXPECT_LE(fewer.margin, tolerance + 1e-12);
    EXPECT_LT(fewer.points.size(), tolerance > 0.05 ? 200u : 401u);
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector3d direction = random.rotation() * Eigen::Vector3d::UnitX();
      double all = -1e9, kept = -1e9;
      for (const auto& v : ball.vertices) all = std::max(all, direction.dot(v));
      for (const auto& v : fewer.points) kept = std::max(kept, direction.dot(v));
      EXPECT_LE(all, kept + fewer.margin);
    }
  }
}

TEST(Enclosure, AtMostSoManyPointsGrownByTheirMarginReachAsFar) {
  RandomInputs random;
  for (const std::size_t count : {1u, 4u, 8u, 16u, 64u, 500u}) {
    std::vector<Eigen::Vector3d> ball;
    for (int i = 0; i < 300; ++i) ball.push_back(random.rotation() * Eigen::Vector3d(1, 0, 0));
    const FewerPoints fewer = atMostPoints(ball, count);
    EXPECT_LE(fewer.points.size(), count);
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector3d direction = random.rotation() * Eigen::Vector3d::UnitX();
      double all = -1e9, kept = -1e9;
      for (const auto& v : ball) all = std::max(all, direction.dot(v));
      for (const auto& v : fewer.points) kept = std::max(kept, direction.dot(v));
      EXPECT_LE(all, kept + fewer.margin);
    }
  }
}

TEST(Enclosure, BoxOfAMeshHoldsItAndIsTightToATenthOfAPerMille) {
  RandomInputs random;
  for (int round = 0; round < 1000; ++round) {
    const TriangleMesh mesh = randomPoints(random, random.integer(1, 300), {1.0, 0.5, 0.2});
    const MeshBounds bounds(hullVertices(mesh)->vertices, hullMargin(mesh));
    const Eigen::Isometry3d X_WE = random.pose(10.0);
    const Aabb box = bounds.boxAt(X_WE);
    Eigen::Vector3d lower = X_WE * mesh.vertices[0], upper = lower;
    for (const auto& v : mesh.vertices) {
      lower = lower.cwiseMin(X_WE * v);
      upper = upper.cwiseMax(X_WE * v);
    }
    EXPECT_TRUE((box.min.array() <= lower.array()).all() &&
                (box.max.array() >= upper.array()).all());
    const double slack = 1e-4 * 2.5 + 1e-12;  // the largest extent of a mesh here is below 2.5
    EXPECT_LE((lower - box.min).maxCoeff(), slack);
    EXPECT_LE((box.max - upper).maxCoeff(), slack);
  }
}

// Of so many vertices on a circle most are within the tolerance of the others' hull.
TEST(Enclosure, BoxOfAMeshHoldsTheVerticesThatItWasNotMadeOf) {
  TriangleMesh disc;
  for (int i = 0; i < 720; ++i) {
    const double angle = M_PI / 360.0 * i;
    disc.vertices.emplace_back(std::cos(angle), std::sin(angle), 0.1 * (i % 2));
  }
  const MeshBounds bounds(disc.vertices, 0.0);
  RandomInputs random;
  for (int round = 0; round < 1000; ++round) {
    const Eigen::Isometry3d X_WE = random.pose(10.0);
    const Aabb box = bounds.boxAt(X_WE);
    for (const Eigen::Vector3d& v : disc.vertices) {
      const Eigen::Vector3d p_W = X_WE * v;
      ASSERT_TRUE((box.min.array() <= p_W.array()).all() && (p_W.array() <= box.max.array()).all());
    }
  }
}

TEST(Enclosure, NoSmallerMarginDoesWithAsFewPoints) {
  RandomInputs random;
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 300; ++i) points.push_back(random.rotation() * Eigen::Vector3d::UnitX());
  for (const std::size_t most : {4u, 20u, 100u}) {
    const FewerPoints few = atMostPoints(points, most);
    EXPECT_LE(few.points.size(), most);
    EXPECT_GT(fewerPoints(points, 0.95 * few.margin).points.size(), most);
  }
  EXPECT_EQ(atMostPoints(points, 300).points.size(), 300u);
  EXPECT_EQ(atMostPoints(points, 300).margin, 0.0);
}

TEST(Enclosure, HullVerticesReachAsFarAsAllVerticesInEveryDirection) {
  RandomInputs random;
  for (int round = 0; round < 50; ++round) {
    const TriangleMesh mesh =
        randomPoints(random, random.integer(1, 200), {1.0, 1.0, random.integer(0, 2) * 0.5});
    const auto hull = hullVertices(mesh);
    EXPECT_LE(hull->vertices.size(), mesh.vertices.size());
    for (int i = 0; i < 100; ++i) {
      const Eigen::Vector3d direction = random.rotation() * Eigen::Vector3d::UnitX();
      double all = -1e9, kept = -1e9;
      for (const auto& v : mesh.vertices) all = std::max(all, direction.dot(v));
      for (const auto& v : hull->vertices) kept = std::max(kept, direction.dot(v));
      EXPECT_LE(all - kept, hullMargin(mesh));
    }
  }
}

}  // namespace collision_pairs::test_enclosure
