#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "instruction_set.h"
#include "packed_records.h"
#include "random_inputs.h"
#include "static_tree.h"
#include "sweep_kernel.h"

namespace collision_pairs::test_sweep_kernel {

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

IdPairs pairsOf(const Candidates& found) {
  IdPairs pairs;
  for (std::size_t i = 0; i < found.count; ++i) pairs.push_back({found.first[i], found.second[i]});
  return pairs;
}

IdPairs sweepBy(const SweepKernel& kernel, const PackedBoxes& boxes, std::uint32_t count,
                std::uint32_t unsure) {
  const std::vector<std::uint32_t> row_end(count, count);
  CandidateStorage storage;
  Candidates* found = storage.clear();
  kernel.sweep(boxes, row_end.data(), count, unsure, found);
  return pairsOf(*found);
}

// Tests of equal answers rely on it.
TEST(InstructionSet, IsNoBetterThanTheEnvironmentSays) {
  const char* const name = "COLLISION_PAIRS_INSTRUCTION_SET";
  ASSERT_EQ(std::getenv(name), nullptr);
  const InstructionSet best = instructionSet();
  setenv(name, "base", 1);
  EXPECT_EQ(instructionSet(), InstructionSet::BASE);
  setenv(name, "avx2", 1);
  EXPECT_EQ(instructionSet(), std::min(best, InstructionSet::AVX2));
  unsetenv(name);
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

TEST(SweepKernel, EachInstructionSetFindsAmongTheAllowedPairsWhatTheDefinitionSays) {
  RandomInputs random;
  for (int round = 0; round < 100; ++round) {
    const auto count = static_cast<std::uint32_t>(random.integer(1, 150));
    std::vector<Aabb> boxes;
    std::vector<std::uint64_t> allowed;
    const std::uint32_t words = (count + 63) / 64;
    for (std::uint32_t i = 0; i < count; ++i) {
      const Eigen::Vector3d corner = random.vector(-8.0, 8.0).array().round();
      boxes.push_back({corner, corner + Eigen::Vector3d(random.integer(0, 3), random.integer(0, 3),
                                                        random.integer(0, 3))});
      if (random.integer(0, 30) == 0) boxes.back().max.x() = 1e300;
      for (std::uint32_t word = 0; word < words; ++word) {
        std::uint64_t bits = 0;
        for (std::uint32_t j = 64 * word; j < std::min(count, 64 * word + 64); ++j) {
          bits |= std::uint64_t{j > i && random.integer(0, 1) == 0} << j % 64;
        }
        allowed.push_back(random.integer(0, 3) == 0 ? 0 : bits);
      }
    }
    IdPairs expected;
    for (std::uint32_t i = 0; i < count; ++i) {
      for (std::uint32_t j = i + 1; j < count; ++j) {
        const bool is_allowed = (allowed[i * words + j / 64] >> j % 64 & 1) != 0;
        if (is_allowed && squaredGap(boxes[i], boxes[j]) == 0.0) expected.push_back({i, j});
      }
    }
    const NarrowMap map = makeNarrowMap(Eigen::Vector3d(1.0, 2.0, 3.0), 0.0);
    for (const SweepKernel* kernel : sweepKernels()) {
      PackedStorage packed;
      packed.pack(*kernel, map, boxes);
      CandidateStorage storage;
      Candidates* found = storage.clear();
      kernel->sweepAllowed(packed.view(), allowed.data(), words, count, found);
      EXPECT_EQ(pairsOf(*found), expected) << kernel->name;
    }
  }
}

/// Boxes with corners at whole numbers, so that sides often coincide, and every hundredth without
/// end on one side.
struct WholeBoxes {
  std::vector<Aabb> boxes;
  std::vector<std::uint32_t> models;

  void add(const Eigen::Vector3d& around, double spread, RandomInputs* random) {
    const Eigen::Vector3d corner = (around + random->vector(-spread, spread)).array().round();
    boxes.push_back({corner, corner + Eigen::Vector3d::Constant(random->integer(0, 3))});
    if (random->integer(0, 99) == 0) boxes.back().max.z() = 1e300;
    models.push_back(static_cast<std::uint32_t>(random->integer(0, 5)));
  }

  std::vector<Record> narrow(const Eigen::Vector3d& origin) const {
    std::vector<Record> records(boxes.size());
    narrowBoxes(*sweepKernels().back(), makeNarrowMap(origin, 0.0), boxes, models.data(),
                records.data());
    return records;
  }
};

IdPairs queryBy(const SweepKernel& kernel, const StaticTree& tree,
                const std::vector<Record>& asked) {
  PackedStorage packed;
  packed.resize(asked.size());
  for (std::size_t i = 0; i < asked.size(); ++i) packed.writer()(i, asked[i]);
  CandidateStorage storage;
  Candidates* found = storage.clear();
  kernel.query(tree.view(), packed.view(), static_cast<std::uint32_t>(asked.size()), 0, found);
  IdPairs pairs = pairsOf(*found);
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

IdPairs bruteForce(const std::vector<Record>& asked, const std::vector<Record>& standing) {
  IdPairs pairs;
  for (const Record& a : asked) {
    for (const Record& b : standing) {
      bool closed = a.model != b.model, open = true;
      for (int k = 0; k < 3; ++k) {
        closed = closed && a.lo[k] <= b.hi[k] && b.lo[k] <= a.hi[k];
        open = open && a.lo[k] < b.hi[k] && b.lo[k] < a.hi[k];
      }
      if (closed) pairs.push_back({a.tag, open ? b.tag : b.tag | UNSURE});
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

// Places of all sizes: together the boxes meet no leaf of the tree, few or most.
std::size_t compareQueries(int nb_standing, RandomInputs* random) {
  WholeBoxes standing;
  for (int i = 0; i < nb_standing; ++i) standing.add(Eigen::Vector3d::Zero(), 20.0, random);
  const StaticTree tree(standing.boxes, standing.models);
  const std::vector<Record> records = standing.narrow(tree.origin());
  std::size_t nb_pairs = 0;
  for (const int nb_asked : {0, 1, 3, 4, 50}) {
    for (const double spread : {1.0, 5.0, 30.0}) {
      WholeBoxes asked;
      const Eigen::Vector3d around = random->vector(-25.0, 25.0);
      for (int i = 0; i < nb_asked; ++i) asked.add(around, spread, random);
      const std::vector<Record> moving = asked.narrow(tree.origin());
      const IdPairs expected = bruteForce(moving, records);
      nb_pairs += expected.size();
      for (const SweepKernel* kernel : sweepKernels()) {
        EXPECT_EQ(queryBy(*kernel, tree, moving), expected)
            << kernel->name << ", " << nb_asked << " boxes within " << spread << " among "
            << nb_standing;
      }
    }
  }
  return nb_pairs;
}

TEST(SweepKernel, EachInstructionSetFindsInATreeWhatTheDefinitionSays) {
  RandomInputs random;
  std::size_t nb_pairs = 0;
  for (int round = 0; round < 20; ++round) {
    for (const int count : {1, 40, 600, 5000}) nb_pairs += compareQueries(count, &random);
  }
  EXPECT_GT(nb_pairs, 1000u);
}

TEST(SweepKernel, EachInstructionSetNarrowsAndFindsCellsAlike) {
  RandomInputs random;
  std::vector<Aabb> boxes;
  std::vector<std::uint32_t> models;
  for (std::uint32_t i = 0; i < 100; ++i) {
    const Eigen::Vector3d corner = random.vector(-1.0, 1.0) * std::pow(10.0, random.integer(-3, 3));
    boxes.push_back({corner, corner + random.vector(0.0, 10.0)});
    models.push_back(i % 7);
  }
  constexpr double LARGEST = std::numeric_limits<double>::max();
  boxes[50] = {Eigen::Vector3d::Constant(-LARGEST), Eigen::Vector3d::Constant(LARGEST)};
  const NarrowMap narrow = makeNarrowMap(Eigen::Vector3d(0.1, 0.2, 0.3), 0.01);
  const CellMap cells = {
      {-9, -9, -9, -9, -9, -9}, {1, 2, 3, 1, 2, 3}, {20, 30, 40, 20, 30, 40}, 21, 21 * 31};
  for (const SweepKernel* kernel : sweepKernels()) {
    std::vector<Record> records(boxes.size());
    narrowBoxes(*kernel, narrow, boxes, models.data(), records.data());
    std::vector<CellSpan> spans(boxes.size());
    kernel->span(cells, records.data(), records.size(), spans.data());
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
      EXPECT_EQ(records[i].tag, i);
      EXPECT_EQ(records[i].model, i % 7);
      std::uint32_t first[3], last[3];
      for (int k = 0; k < 3; ++k) {
        const float origin_shift[] = {0.1f, 0.2f, 0.3f};
        if (i != 50) {
          EXPECT_NEAR(records[i].lo[k], boxes[i].min[k] - 0.01 - origin_shift[k], 1e-3);
          EXPECT_NEAR(records[i].hi[k], boxes[i].max[k] + 0.01 - origin_shift[k], 1e-3);
        }
        const auto cell = [&](float x) {
          const float scaled = (x - cells.base[k]) * cells.scale[k];
          return static_cast<std::uint32_t>(std::clamp(scaled, 0.0f, cells.last[k]));
        };
        first[k] = cell(records[i].lo[k]);
        last[k] = cell(records[i].hi[k]);
      }
      EXPECT_EQ(spans[i].first, first[0] + 21 * first[1] + 21 * 31 * first[2]) << kernel->name;
      EXPECT_EQ(spans[i].more,
                (last[0] - first[0]) | (last[1] - first[1]) << 10 | (last[2] - first[2]) << 20)
          << kernel->name;
    }
  }
}

TEST(SweepKernel, ThisMachineCanRunAtLeastTheOneOfFourLanes) {
  std::cout << "kernels:";
  for (const SweepKernel* kernel : sweepKernels()) std::cout << " [" << kernel->name << "]";
  std::cout << "\n";
  EXPECT_STREQ(sweepKernels().back()->name, "four lanes");
}

}  // namespace collision_pairs::test_sweep_kernel
