// Which points a cloud hides, by the depths that it saw in all directions.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "depth_map.h"

namespace collision_pairs::test_depth_map {

using Eigen::Vector3d;

// Cubes' faces of `n` by `n` bins, as many as the points are worth.
TEST(DepthMap, ABinWithoutRaysTakesThoseOfAllTheBinsAroundIt) {
  DepthMap map;
  for (const int n : {50, 200}) {
    const auto towards = [&](int axis, double sign, int u, int v) -> Vector3d {
      Vector3d p = Vector3d::Constant(sign);
      p[axis == 2 ? 0 : axis + 1] = (u + 0.5) * 2.0 / n - 1.0;
      p[axis == 0 ? 2 : axis - 1] = (v + 0.5) * 2.0 / n - 1.0;
      return p.normalized();
    };
    for (int i = 0; i < 6 * 9; ++i) {
      const int ends[] = {0, 1, n - 1};
      const int axis = i % 3, u = ends[i / 6 % 3], v = ends[i / 18];
      const double sign = i % 6 < 3 ? 1.0 : -1.0;
      for (int k = 0; k < 25; ++k) {
        const int du = k % 5 - 2, dv = k / 5 - 2;
        if (std::min(u + du, v + dv) < 0 || std::max(u + du, v + dv) >= n) continue;
        map.begin(n == 50 ? 19'999 : 20'000);
        map.add(towards(axis, sign, u + du, v + dv), 2.0);
        const bool is_beside = std::abs(du) <= 1 && std::abs(dv) <= 1;
        const Vector3d asked = towards(axis, sign, u, v);
        ASSERT_EQ(map.hides(2.01 * asked), is_beside) << u << ' ' << v << ' ' << du << ' ' << dv;
        ASSERT_FALSE(map.hides(1.99 * asked));
        map.add(asked, 1.0);
        ASSERT_TRUE(map.hides(1.01 * asked) || (du == 0 && dv == 0));
      }
    }
  }
}

}  // namespace collision_pairs::test_depth_map
