#include <gtest/gtest.h>

#include "collision_pairs/sweep_and_prune.h"
#include "random_inputs.h"

namespace collision_pairs {
namespace {

TEST(SweepAndPrune, FindsWhatBruteForceFinds) {
  RandomInputs random;
  for (int round = 0; round < 50; ++round) {
    std::vector<Aabb> boxes;
    for (int i = 0; i < random.integer(0, 120); ++i) {
      const Eigen::Vector3d corner = random.vector(-1.0, 1.0);
      boxes.push_back({corner, corner + random.vector(0.0, 0.4)});
    }
    const double alarm = random.uniform(0.0, 0.1);
    std::vector<BoxPair> expected;
    SweepAndPrune sweep;
    sweep.begin(alarm);
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
      sweep.add(boxes[i], i);
      for (std::uint32_t j = i + 1; j < boxes.size(); ++j) {
        if (squaredGap(boxes[i], boxes[j]) <= alarm * alarm) expected.push_back({i, j});
      }
    }
    EXPECT_EQ(sweep.end(), expected);
  }
}

}  // namespace
}  // namespace collision_pairs
