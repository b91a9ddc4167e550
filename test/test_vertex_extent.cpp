#include <gtest/gtest.h>

#include "furthest_point.h"
#include "random_inputs.h"
#include "vertex_extent.h"

namespace collision_pairs {
namespace {

TEST(VertexExtent, IsThatOfThePointsOneByOne) {
  RandomInputs random;
  for (int round = 0; round < 200; ++round) {
    std::vector<Eigen::Vector3d> points(static_cast<std::size_t>(random.integer(1, 40)));
    for (auto& p : points) p = random.vector(-5.0, 5.0);
    const Eigen::Matrix3d R = random.rotation().toRotationMatrix();
    Eigen::Vector3d lower = R * points[0], upper = lower, found_lower, found_upper;
    for (const auto& p : points) {
      lower = lower.cwiseMin(R * p);
      upper = upper.cwiseMax(R * p);
    }
    std::vector<PointBlock> blocks;
    appendBlocks(points, blocks);
    for (const ExtentLoop loop : extentLoops()) {
      loop(blocks.data(), blocks.size(), R.data(), found_lower.data(), found_upper.data());
      // Fused and separate multiplications differ in the last place.
      EXPECT_LE((found_lower - lower).cwiseAbs().maxCoeff(), 5e-15);
      EXPECT_LE((found_upper - upper).cwiseAbs().maxCoeff(), 5e-15);
    }
    Eigen::Vector3d packed_lower, packed_upper;
    PackedPoints(points).extent(R, packed_lower, packed_upper);
    EXPECT_LE((packed_lower - lower).cwiseAbs().maxCoeff(), 5e-15);
    EXPECT_LE((packed_upper - upper).cwiseAbs().maxCoeff(), 5e-15);
  }
}

}  // namespace
}  // namespace collision_pairs
