#include <set>

#include <gtest/gtest.h>

#include "collision_pairs/pair_filter.h"
#include "random_inputs.h"

namespace collision_pairs::test_pair_filter {

TEST(PairFilter, SaysWhatASetOfPairsSays) {
  RandomInputs random;
  const std::uint32_t n = 150;  // more than two words of bits
  PairFilter filter = PairFilter::allowAll(n);
  std::set<std::pair<std::uint32_t, std::uint32_t>> forbidden;
  for (int i = 0; i < 2000; ++i) {
    const auto a = static_cast<std::uint32_t>(random.integer(0, n - 1));
    const auto b = static_cast<std::uint32_t>(random.integer(0, n - 1));
    const bool allow = random.integer(0, 1) == 1;
    filter.setClassPair(a, b, allow);
    if (allow) forbidden.erase(std::minmax(a, b));
    if (!allow) forbidden.insert(std::minmax(a, b));
  }
  for (std::uint32_t a = 0; a < n; ++a) {
    for (std::uint32_t b = 0; b < n; ++b) {
      EXPECT_EQ(filter.allowed(a, b), a != b && forbidden.count(std::minmax(a, b)) == 0);
    }
  }
}

TEST(PairFilter, ModelsOfOneClassAreTreatedAlike) {
  PairFilter filter({0, 1, 1, 1});
  filter.setClassPair(1, 1, false);
  EXPECT_TRUE(filter.allowed(0, 3));
  EXPECT_FALSE(filter.allowed(1, 3));
  EXPECT_EQ(filter.nbClasses(), 2u);
}

}  // namespace collision_pairs::test_pair_filter
