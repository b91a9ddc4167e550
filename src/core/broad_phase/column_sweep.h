// Sorts and sweeps records, and cuts them into columns first where the sweep would be long.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "box_pairs.h"
#include "collision_pairs/sweep_and_prune.h"
#include "packed_records.h"
#include "sweep_grid.h"

namespace collision_pairs {

/// How the work is done. None of it changes the pairs, only the time.
struct SweepTuning {
  /// Up to this many pairs of boxes are tested in double right away.
  std::uint32_t direct_up_to = 60;
  /// Up to this many moving boxes each is tested against each, packed, with nothing sorted: for few
  /// boxes this is faster than sorting. None: the kernel's own limit.
  std::optional<std::uint32_t> packed_up_to;
  /// A sweep over more boxes than this is cut into columns first.
  std::uint32_t column_size = 2048;
  /// A sweep that would test a box against more than this many others on average is cut too.
  std::uint32_t tests_per_box = 48;
};

/// Sweeps the columns of one cycle, and keeps its memory. Pairs in no order.
class ColumnSweep {
 public:
  explicit ColumnSweep(const SweepKernel* kernel) : kernel_(kernel) {}

  void begin(const SweepTuning& tuning, const PairTest& test, std::uint32_t unsure);

  /// All pairs of the records, each once.
  void sweep(const Record* records, std::size_t count);

  std::vector<BoxPair>& pairs() { return pairs_; }

 private:
  /// Along `axis`; `depth`: how often they were split already.
  void sweep(const Record* records, std::size_t count, int axis, std::size_t depth);
  bool cut(const Record* records, std::size_t count, double tests_per_box, std::size_t depth);
  std::size_t sort(const Record* records, std::size_t count, int axis);

  const SweepKernel* kernel_;
  SweepTuning tuning_;
  PairTest test_;
  std::uint32_t unsure_ = 0;
  PackedStorage packed_;
  CandidateStorage candidates_;
  std::vector<std::uint32_t> bins_;
  std::vector<std::uint32_t> row_end_;
  std::vector<std::unique_ptr<GridLevel>> levels_;
  std::vector<BoxPair> pairs_;
};

}  // namespace collision_pairs
