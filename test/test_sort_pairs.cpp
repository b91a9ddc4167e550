#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "box_pairs.h"
#include "collision_pairs/sweep_and_prune.h"
#include "random_inputs.h"

namespace collision_pairs::test_sort_pairs {

/// Distinct pairs in any order; crowded: most of them have one of few first ids.
std::vector<BoxPair> somePairs(RandomInputs& random, std::size_t nb_ids, std::size_t nb_pairs,
                               bool crowded) {
  std::set<BoxPair> pairs;
  while (pairs.size() < nb_pairs) {
    const double most = static_cast<double>(nb_ids - 1);
    const double share = random.uniform(0.0, 1.0);
    pairs.insert({static_cast<std::uint32_t>(most * (crowded ? std::pow(share, 9) : share)),
                  static_cast<std::uint32_t>(most * random.uniform(0.0, 1.0))});
  }
  std::vector<BoxPair> in_any_order(pairs.begin(), pairs.end());
  for (std::size_t i = nb_pairs; i > 1; --i) {
    const auto other = static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(i)));
    std::swap(in_any_order[i - 1], in_any_order[std::min(other, i - 1)]);
  }
  return in_any_order;
}

// Few; few for so many ids; rows of any length, of which the longest are sorted in another way.
TEST(SortPairs, PutsAnyNumberOfPairsInTheOrderOfTheirIds) {
  RandomInputs random;
  const std::size_t largest = (std::size_t{1} << 29) - 1;
  for (const SweepKernel* kernel : sweepKernels()) {
    PairSorter sorter;
    for (const std::size_t nb_ids :
         {std::size_t{100}, std::size_t{1000}, std::size_t{20000}, largest}) {
      for (const std::size_t nb_pairs : {10u, 1000u, 30000u}) {
        if (nb_pairs > nb_ids * nb_ids / 4) continue;
        std::vector<BoxPair> pairs = somePairs(random, nb_ids, nb_pairs, nb_pairs % 3 == 0);
        std::vector<BoxPair> expected = pairs;
        std::sort(expected.begin(), expected.end());
        sorter.sort(*kernel, nb_ids, &pairs);
        ASSERT_TRUE(pairs == expected)
            << nb_pairs << " pairs of " << nb_ids << " ids, " << kernel->name;
      }
    }
  }
}

TEST(SortPairs, RowsOfEveryLengthAreSorted) {
  RandomInputs random;
  for (const SweepKernel* kernel : sweepKernels()) {
    PairSorter sorter;
    std::vector<BoxPair> expected, pairs;
    constexpr std::uint32_t NB_IDS = 300;  // row i has 299 - i numbers
    for (std::uint32_t i = 0; i < NB_IDS; ++i) {
      for (std::uint32_t j = i + 1; j < NB_IDS; ++j) expected.push_back({i, j});
    }
    pairs.assign(expected.rbegin(), expected.rend());
    sorter.sort(*kernel, NB_IDS, &pairs);
    ASSERT_TRUE(pairs == expected) << kernel->name;
  }
}

}  // namespace collision_pairs::test_sort_pairs
