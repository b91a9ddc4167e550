#include <gtest/gtest.h>

#include "packed_points.h"
#include "random_inputs.h"

namespace collision_pairs::test_packed_points {

using Eigen::Vector3d;

TEST(PackedPoints, FurthestIsTheFurthestOfThePointsOneByOne) {
  RandomInputs random;
  for (int round = 0; round < 2000; ++round) {
    std::vector<Vector3d> points(static_cast<std::size_t>(random.integer(1, 40)));
    for (Vector3d& p : points) p = random.vector(-5.0, 5.0);
    const Vector3d d = random.vector(-1.0, 1.0);
    std::size_t expected = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (d.dot(points[i]) > d.dot(points[expected])) expected = i;
    }
    std::vector<PointBlock> blocks;
    appendBlocks(points, blocks);
    const FurthestPoint best = furthestInBlocks(blocks.data(), blocks.size(), d);
    EXPECT_EQ(std::min(best.index, points.size() - 1), expected);
    EXPECT_NEAR(best.height, d.dot(points[expected]), 1e-14);
    for (const GeometryKernel& kernel : geometryKernels()) {
      double height;
      const std::size_t found =
          kernel.furthest_point(blocks.data(), blocks.size(), d.data(), &height);
      EXPECT_EQ(std::min(found, points.size() - 1), expected) << kernel.name;
      EXPECT_NEAR(height, d.dot(points[expected]), 1e-14) << kernel.name;
    }
  }
}

TEST(PackedPoints, FurthestAlongNoDirectionIsStillAPoint) {
  std::vector<PointBlock> blocks;
  appendBlocks({Vector3d(1, 2, 3), Vector3d(4, 5, 6)}, blocks);
  const Vector3d nan = Vector3d::Constant(std::nan(""));
  EXPECT_LT(furthestInBlocks(blocks.data(), blocks.size(), nan).index, std::size_t{POINT_LANES});
  EXPECT_LT(furthestInBlocks(blocks.data(), blocks.size(), Vector3d::Zero()).index,
            std::size_t{POINT_LANES});
}

TEST(PackedPoints, ExtentIsThatOfThePointsOneByOne) {
  RandomInputs random;
  for (int round = 0; round < 200; ++round) {
    std::vector<Vector3d> points(static_cast<std::size_t>(random.integer(1, 40)));
    for (auto& p : points) p = random.vector(-5.0, 5.0);
    const Eigen::Matrix3d R = random.rotation().toRotationMatrix();
    Vector3d lower = R * points[0], upper = lower, found_lower, found_upper;
    for (const auto& p : points) {
      lower = lower.cwiseMin(R * p);
      upper = upper.cwiseMax(R * p);
    }
    std::vector<PointBlock> blocks;
    appendBlocks(points, blocks);
    for (const GeometryKernel& kernel : geometryKernels()) {
      kernel.extent(blocks.data(), blocks.size(), R.data(), found_lower.data(), found_upper.data());
      // Fused and separate multiplications differ in the last place.
      EXPECT_LE((found_lower - lower).cwiseAbs().maxCoeff(), 5e-15);
      EXPECT_LE((found_upper - upper).cwiseAbs().maxCoeff(), 5e-15);
    }
    Vector3d packed_lower, packed_upper;
    PackedPoints(points).extent(R, packed_lower, packed_upper);
    EXPECT_LE((packed_lower - lower).cwiseAbs().maxCoeff(), 5e-15);
    EXPECT_LE((packed_upper - upper).cwiseAbs().maxCoeff(), 5e-15);
  }
}

}  // namespace collision_pairs::test_packed_points
