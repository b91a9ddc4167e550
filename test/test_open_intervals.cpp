// Open intervals of a motion beside a plain list of them.
#include <algorithm>

#include <gtest/gtest.h>

#include "open_intervals.h"
#include "random_inputs.h"

namespace collision_pairs::test_open_intervals {

/// What was put into an interval, by the ids of its pairs.
struct Plain {
  double begin = 2.0, end = -1.0, motion = 0.0;
  std::vector<std::uint32_t> pairs;
};

OpenPair randomPart(RandomInputs& random, std::uint32_t id) {
  OpenPair open;
  open.pair = {id, id + 1};
  open.begin = random.integer(0, 7) / 8.0;
  open.end = open.begin + random.integer(1, 4) / 8.0;
  open.speed = random.integer(0, 3) == 0 ? 0.0 : random.uniform(0.0, 9.0);
  if (random.integer(0, 2) == 0) open.speed = 1.0;  // as many move alike
  return open;
}

void expectSame(const Interval& found, const Plain& plain) {
  EXPECT_EQ(found.begin, plain.begin);
  EXPECT_EQ(found.end, plain.end);
  EXPECT_EQ(found.motion, plain.motion);
  EXPECT_EQ(found.isEmpty(), plain.pairs.empty());
}

/// Pushes an interval of some pairs, and notes it.
void pushOne(RandomInputs& random, std::uint32_t& next_id, OpenIntervals& intervals,
             std::vector<Plain>& plains) {
  Interval interval;
  Plain plain;
  for (int nb = random.integer(0, 5); nb > 0; --nb) {
    const OpenPair open = randomPart(random, next_id++);
    intervals.addPair(open, interval);
    plain.begin = std::min(plain.begin, open.begin);
    plain.end = std::max(plain.end, open.end);
    plain.motion = std::max(plain.motion, open.speed * (open.end - open.begin));
    plain.pairs.push_back(open.pair.first);
    expectSame(interval, plain);
  }
  intervals.push(interval);
  if (!plain.pairs.empty()) plains.push_back(plain);
}

TEST(OpenIntervals, ReturnTheOneWithMostMotionAndOfThoseTheFirstWithAllOfItsPairs) {
  RandomInputs random;
  OpenIntervals intervals;
  for (int round = 0; round < 100; ++round) {
    intervals.clear();
    EXPECT_TRUE(intervals.isEmpty());
    EXPECT_EQ(intervals.nbPairs(), 0u);
    std::vector<Plain> plains;
    std::uint32_t next_id = 0;
    std::size_t nb_open = 0, most_open = 0;
    for (int step = 0; step < 100; ++step) {
      ASSERT_EQ(intervals.isEmpty(), plains.empty());
      if (plains.empty() || random.integer(0, 1)) {
        const std::uint32_t before = next_id;
        pushOne(random, next_id, intervals, plains);
        nb_open += next_id - before;
        most_open = std::max(most_open, nb_open);
        ASSERT_EQ(intervals.nbPairs(), most_open) << "entries that are not in use are used again";
        continue;
      }
      Interval interval = intervals.pop();
      const auto worse = [](const Plain& a, const Plain& b) {
        return a.motion != b.motion ? a.motion < b.motion : a.begin > b.begin;
      };
      const Plain first = *std::max_element(plains.begin(), plains.end(), worse);
      EXPECT_EQ(interval.motion, first.motion);
      EXPECT_EQ(interval.begin, first.begin);
      std::vector<std::uint32_t> pairs;
      while (!interval.isEmpty()) pairs.push_back(intervals.popPair(interval).pair.first);
      std::sort(pairs.begin(), pairs.end());
      const auto same = std::find_if(plains.begin(), plains.end(),
                                     [&](const Plain& plain) { return plain.pairs == pairs; });
      ASSERT_TRUE(same != plains.end());
      EXPECT_EQ(same->motion, first.motion);
      EXPECT_EQ(same->begin, first.begin);
      EXPECT_EQ(same->end, interval.end);
      nb_open -= pairs.size();
      plains.erase(same);
    }
  }
}

}  // namespace collision_pairs::test_open_intervals
