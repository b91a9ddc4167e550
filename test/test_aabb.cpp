#include <gtest/gtest.h>

#include "collision_pairs/aabb.h"
#include "random_inputs.h"

namespace collision_pairs::test_aabb {

using Eigen::Vector3d;

// The oracle: many points of the solid, moved one by one.
std::vector<Vector3d> cylinderRim(const Cylinder& c) {
  std::vector<Vector3d> points;
  for (int i = 0; i < 4096; ++i) {
    const double angle = 2.0 * M_PI * i / 4096;
    for (const double z : {-0.5 * c.length, 0.5 * c.length}) {
      points.emplace_back(c.radius * std::cos(angle), c.radius * std::sin(angle), z);
    }
  }
  return points;
}

TEST(Aabb, OfACylinderIsTightAtEveryRotation) {
  RandomInputs random;
  for (int i = 0; i < 200; ++i) {
    const Cylinder cylinder{random.uniform(0.01, 1.0), random.uniform(0.0, 2.0)};
    const Eigen::Isometry3d X_WE = random.pose(3.0);
    const Aabb box = computeAabb(cylinder, X_WE);
    Vector3d lower = Vector3d::Constant(1e9), upper = -lower;
    for (const Vector3d& p : cylinderRim(cylinder)) {
      lower = lower.cwiseMin(X_WE * p);
      upper = upper.cwiseMax(X_WE * p);
    }
    // 4096 points on a circle leave out at most r (1 - cos(pi / 4096)) = 3e-7 r.
    EXPECT_TRUE(((lower - box.min).array() >= 0.0).all()) << (lower - box.min).transpose();
    EXPECT_TRUE(((box.max - upper).array() >= 0.0).all()) << (box.max - upper).transpose();
    EXPECT_LT((lower - box.min).maxCoeff(), 1e-6);
    EXPECT_LT((box.max - upper).maxCoeff(), 1e-6);
  }
}

TEST(Aabb, OfABoxIsTheBoxOfItsCorners) {
  RandomInputs random;
  for (int i = 0; i < 200; ++i) {
    const Box shape{random.vector(0.0, 2.0)};
    const Eigen::Isometry3d X_WE = random.pose(3.0);
    const Aabb box = computeAabb(shape, X_WE);
    Vector3d lower = Vector3d::Constant(1e9), upper = -lower;
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3d sign(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5,
                          corner & 4 ? 0.5 : -0.5);
      lower = lower.cwiseMin(X_WE * shape.size.cwiseProduct(sign));
      upper = upper.cwiseMax(X_WE * shape.size.cwiseProduct(sign));
    }
    EXPECT_TRUE(((lower - box.min).array() >= 0.0).all());
    EXPECT_TRUE(((box.max - upper).array() >= 0.0).all());
    EXPECT_LT((lower - box.min).maxCoeff(), 1e-13);
    EXPECT_LT((box.max - upper).maxCoeff(), 1e-13);
  }
}

TEST(Aabb, OfAMeshIsTheBoxOfItsVertices) {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->vertices = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
  mesh->triangles = {{0, 1, 2}, {0, 1, 3}};
  Eigen::Isometry3d X_WE = Eigen::Isometry3d::Identity();
  X_WE.translation() = Vector3d(10, 20, 30);
  const Aabb box = computeAabb(Mesh{mesh}, X_WE);
  EXPECT_TRUE(box.min.isApprox(Vector3d(10, 20, 30), 2e-14));
  EXPECT_TRUE(box.max.isApprox(Vector3d(11, 22, 33), 1e-14));
}

// The oracle computes with more digits.
TEST(Aabb, OfTurnedVerticesHoldsThemInSpiteOfRoundingAndHardlyMore) {
  using Vector3l = Eigen::Matrix<long double, 3, 1>;
  RandomInputs random;
  for (int round = 0; round < 300; ++round) {
    auto mesh = std::make_shared<TriangleMesh>();
    for (int i = 0; i < 5; ++i) mesh->vertices.push_back(random.vector(-4.0, 4.0));
    mesh->triangles = {{0, 1, 2}, {2, 3, 4}};
    const Eigen::Isometry3d X_WE = random.pose(round % 2 == 0 ? 0.0 : 4.0);
    const Vector3l p_WE = X_WE.translation().cast<long double>();
    Vector3l lower = Vector3l::Constant(1e9L), upper = -lower;
    for (const Vector3d& p : mesh->vertices) {
      const Vector3l v = X_WE.linear().cast<long double>() * p.cast<long double>() + p_WE;
      lower = lower.cwiseMin(v);
      upper = upper.cwiseMax(v);
    }
    for (const Shape& shape : {Shape(Mesh{mesh}), Shape(Convex{mesh})}) {
      const Aabb box = computeAabb(shape, X_WE);
      const Vector3l below = lower - box.min.cast<long double>();
      const Vector3l above = box.max.cast<long double>() - upper;
      ASSERT_GE(std::min(below.minCoeff(), above.minCoeff()), 0.0L);
      ASSERT_LE(std::max(below.maxCoeff(), above.maxCoeff()), 1e-13L);
    }
  }
}

TEST(Aabb, OfAFloorEndsAtItsSurfaceAndOfACeilingBeginsThere) {
  Eigen::Isometry3d X_WE = Eigen::Isometry3d::Identity();
  X_WE.translation().z() = 2.0;
  const Aabb floor = computeAabb(HalfSpace{}, X_WE);
  X_WE.linear() = Vector3d(1.0, -1.0, -1.0).asDiagonal();
  const Aabb ceiling = computeAabb(HalfSpace{}, X_WE);
  EXPECT_NEAR(floor.max.z(), 2.0, 1e-14);
  EXPECT_LT(floor.min.z(), -1e300);
  EXPECT_NEAR(ceiling.min.z(), 2.0, 1e-14);
  EXPECT_GT(ceiling.max.z(), 1e300);
}

// However slightly it is tilted, far enough away it is higher than at its origin.
TEST(Aabb, OfATiltedFloorIsUnbounded) {
  Eigen::Isometry3d X_WE = Eigen::Isometry3d::Identity();
  X_WE.linear() = Eigen::AngleAxisd(1e-13, Vector3d::UnitX()).toRotationMatrix();
  EXPECT_GT(computeAabb(HalfSpace{}, X_WE).max.z(), 1e300);
}

TEST(Aabb, GapIsTheEuclideanDistanceOverAllAxes) {
  const Aabb a{{0, 0, 0}, {1, 1, 1}};
  EXPECT_EQ(squaredGap(a, {{4, 5, 0}, {5, 6, 1}}), 9.0 + 16.0);
  EXPECT_EQ(squaredGap({{4, 5, 0}, {5, 6, 1}}, a), 9.0 + 16.0);
  EXPECT_EQ(squaredGap(a, {{1, 1, 1}, {2, 2, 2}}), 0.0);
}

TEST(Aabb, WithANanOrInvertedIsNotValid) {
  EXPECT_TRUE((Aabb{{0, 0, 0}, {0, 0, 0}}.valid()));
  EXPECT_FALSE((Aabb{{0, 0, 0}, {-1, 0, 0}}.valid()));
  EXPECT_FALSE((Aabb{{0, 0, 0}, {1, std::nan(""), 1}}.valid()));
  EXPECT_FALSE((Aabb{{0, 0, 0}, {1, INFINITY, 1}}.valid()));
}

}  // namespace collision_pairs::test_aabb
