#include <gtest/gtest.h>

#include "furthest_point.h"
#include "furthest_point_loop.h"
#include "random_inputs.h"

namespace collision_pairs {
namespace {

using Eigen::Vector3d;

typedef double TwoDoubles __attribute__((vector_size(16)));
typedef long long TwoIntegers __attribute__((vector_size(16)));

TEST(FurthestPoint, IsTheFurthestOfThePointsOneByOne) {
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
    double height;
    const std::size_t plain = furthestPointLoop<TwoDoubles, TwoIntegers, 2>(
        blocks.data(), blocks.size(), d.data(), &height);
    EXPECT_EQ(std::min(plain, points.size() - 1), expected);
    EXPECT_NEAR(height, d.dot(points[expected]), 1e-14);
  }
}

TEST(FurthestPoint, AlongNoDirectionIsStillAPoint) {
  std::vector<PointBlock> blocks;
  appendBlocks({Vector3d(1, 2, 3), Vector3d(4, 5, 6)}, blocks);
  const Vector3d nan = Vector3d::Constant(std::nan(""));
  EXPECT_LT(furthestInBlocks(blocks.data(), blocks.size(), nan).index, std::size_t{POINT_LANES});
  EXPECT_LT(furthestInBlocks(blocks.data(), blocks.size(), Vector3d::Zero()).index,
            std::size_t{POINT_LANES});
}

}  // namespace
}  // namespace collision_pairs
