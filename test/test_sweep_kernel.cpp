#include <iostream>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "packed_storage.h"
#include "random_inputs.h"
#include "sweep_kernel.h"

namespace collision_pairs {
namespace {

using IdPairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

// Few distinct values, so that sides often coincide; some boxes without end.
Record randomRecord(RandomInputs* random, std::uint32_t id) {
  Record record;
  for (int k = 0; k < 3; ++k) {
    record.lo[k] = static_cast<float>(random->integer(0, 9));
    record.hi[k] = record.lo[k] + static_cast<float>(random->integer(0, 4));
  }
  if (random->integer(0, 20) == 0) record.hi[0] = std::numeric_limits<float>::max();
  record.tag = id;
  for (int k = 0; k < 3; ++k) {
    if (random->integer(0, 3) == 0) record.tag |= laterCopy(k);
  }
  record.model = static_cast<std::uint32_t>(random->integer(0, 5));
  return record;
}

IdPairs sweepBy(const SweepKernel& kernel, const PackedBoxes& boxes, std::uint32_t count,
                std::uint32_t unsure) {
  const std::vector<std::uint32_t> row_end(count, count);
  CandidateStorage storage;
  Candidates* found = storage.clear();
  kernel.sweep(boxes, row_end.data(), count, unsure, found);
  IdPairs pairs;
  for (std::size_t i = 0; i < found->count; ++i)
    pairs.push_back({found->first[i], found->second[i]});
  return pairs;
}

TEST(SweepKernel, EachInstructionSetFindsWhatTheDefinitionSays) {
  RandomInputs random;
  for (int round = 0; round < 100; ++round) {
    std::vector<Record> records;
    PackedStorage packed;
    const auto count = static_cast<std::uint32_t>(random.integer(0, 90));
    packed.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      records.push_back(randomRecord(&random, i));
      packed.writer()(i, records[i]);
    }
    IdPairs expected;
    for (std::uint32_t i = 0; i < count; ++i) {
      for (std::uint32_t j = i + 1; j < count; ++j) {
        const Record& a = records[i];
        const Record& b = records[j];
        bool closed = a.model != b.model && (a.tag & b.tag & ~ID_MASK) == 0;
        bool open = true;
        for (int k = 0; k < 3; ++k) {
          closed = closed && a.lo[k] <= b.hi[k] && b.lo[k] <= a.hi[k];
          open = open && a.lo[k] < b.hi[k] && b.lo[k] < a.hi[k];
        }
        if (closed) expected.push_back({i, open ? j : j | UNSURE});
      }
    }
    for (const SweepKernel* kernel : sweepKernels()) {
      EXPECT_EQ(sweepBy(*kernel, packed.view(), count, 0), expected) << kernel->name;
      for (const auto& pair : sweepBy(*kernel, packed.view(), count, UNSURE)) {
        EXPECT_TRUE(pair.second & UNSURE) << kernel->name;
      }
    }
  }
}

TEST(SweepKernel, ThisMachineCanRunAtLeastTheScalarOne) {
  std::cout << "kernels:";
  for (const SweepKernel* kernel : sweepKernels()) std::cout << " [" << kernel->name << "]";
  std::cout << "\n";
  EXPECT_STREQ(sweepKernels().back()->name, "scalar");
}

}  // namespace
}  // namespace collision_pairs
