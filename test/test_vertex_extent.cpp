#include <gtest/gtest.h>

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
    PackedPoints(points).extent(R, found_lower, found_upper);
    // Fused and separate multiplications differ in the last place.
    EXPECT_LE((found_lower - lower).cwiseAbs().maxCoeff(), 5e-15);
    EXPECT_LE((found_upper - upper).cwiseAbs().maxCoeff(), 5e-15);
  }
}

}  // namespace
}  // namespace collision_pairs
