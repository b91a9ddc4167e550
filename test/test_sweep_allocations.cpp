// Counts every heap allocation of this program.
#include <atomic>
#include <cstdlib>
#include <new>

#include <gtest/gtest.h>

#include "broad_phase_oracle.h"
#include "random_inputs.h"

namespace {
std::atomic<std::size_t> nb_allocations{0};
}  // namespace

// Not inlined: GCC 12 takes the two for a mismatch where it sees into one of them only.
__attribute__((noinline)) void* operator new(std::size_t size) {
  ++nb_allocations;
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
      nb_pairs += sweep.end().size();
    };
    cycle();
    cycle();
    const std::size_t before = nb_allocations;
    for (int i = 0; i < 5; ++i) cycle();
    EXPECT_EQ(nb_allocations, before) << nb_boxes << " boxes";
    EXPECT_GT(nb_pairs, 0u);
  }
}

}  // namespace
}  // namespace collision_pairs
