// Counts every heap allocation of this program, and fails those that a test wants to fail.
#include <atomic>
#include <cstdlib>
#include <new>
#include <thread>

#include <gtest/gtest.h>

#include "broad_phase_oracle.h"
#include "failing_threads.h"
#include "random_inputs.h"

namespace {
std::atomic<std::size_t> nb_allocations{0};
std::atomic<bool> no_memory_for_other_threads{false};
const std::thread::id THE_TEST = std::this_thread::get_id();
}  // namespace

// Not inlined: GCC 12 takes the two for a mismatch where it sees into one of them only.
__attribute__((noinline)) void* operator new(std::size_t size) {
  ++nb_allocations;
  if (no_memory_for_other_threads && std::this_thread::get_id() != THE_TEST) throw std::bad_alloc();
  if (void* memory = std::malloc(size ? size : 1)) return memory;
  throw std::bad_alloc();
}
__attribute__((noinline)) void operator delete(void* memory) noexcept { std::free(memory); }
__attribute__((noinline)) void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace collision_pairs {
namespace {

TEST(SweepAllocations, AWarmSweepAllocatesNothing) {
  RandomInputs random;
  for (const std::size_t nb_boxes : {50u, 500u, 20000u}) {
    std::vector<Aabb> boxes;
    for (std::size_t i = 0; i < nb_boxes; ++i) {
      const Eigen::Vector3d corner = random.vector(0.0, 1.0);
      boxes.push_back({corner, corner + random.vector(0.0, 1.0 / std::cbrt(nb_boxes))});
    }
    const StaticBoxes fixed({boxes.begin(), boxes.begin() + 20}, std::vector<std::uint32_t>(20));
    SweepAndPrune sweep;
    std::size_t nb_pairs = 0;
    const auto cycle = [&] {
      sweep.begin(0.01, &fixed);
      for (std::uint32_t i = 20; i < boxes.size(); ++i) sweep.add(boxes[i], i);
      nb_pairs += sweep.end().size() + static_cast<std::size_t>(sweep.axis());
    };
    cycle();
    cycle();
    const std::size_t before = nb_allocations;
    for (int i = 0; i < 5; ++i) cycle();
    EXPECT_EQ(nb_allocations, before) << nb_boxes << " boxes";
    EXPECT_GT(nb_pairs, 0u);
  }
}

/// Enough boxes for every one of a few threads to have columns to sweep.
class ManyThreads : public testing::Test {
 protected:
  ManyThreads() {
    RandomInputs random;
    for (int i = 0; i < 20000; ++i) {
      const Eigen::Vector3d corner = random.vector(0.0, 1.0);
      boxes_.push_back({corner, corner + random.vector(0.0, 0.03)});
    }
  }

  std::vector<BoxPair> pairsBy(int threads) const {
    SweepTuning tuning;
    tuning.threads = threads;
    SweepAndPrune sweep(tuning);
    sweep.begin(0.0);
    for (std::uint32_t i = 0; i < boxes_.size(); ++i) sweep.add(boxes_[i], i);
    return sweep.end();
  }

  std::vector<Aabb> boxes_;
};

TEST_F(ManyThreads, FindTheSamePairsWhereSomeOrAllCannotBeStarted) {
  const std::vector<BoxPair> expected = pairsBy(1);
  for (const int can_be_started : {0, 2}) {
    threads_left = can_be_started;
    const std::vector<BoxPair> found = pairsBy(5);
    threads_left = -1;
    EXPECT_TRUE(found == expected) << can_be_started;
  }
}

// Which thread sweeps which column is not in anybody's hand, so this is tried until one that has
// no memory gets a turn.
TEST_F(ManyThreads, HandAFailureInOneOfThemToTheCaller) {
  bool failed = false;
  for (int i = 0; i < 100 && !failed; ++i) {
    no_memory_for_other_threads = true;
    try {
      pairsBy(5);
    } catch (const std::bad_alloc&) {
      failed = true;
    }
    no_memory_for_other_threads = false;
  }
  EXPECT_TRUE(failed);
}

}  // namespace
}  // namespace collision_pairs
