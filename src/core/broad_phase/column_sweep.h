// Sorts and sweeps records, and cuts them into columns first where the sweep would be long.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "collision_pairs/sweep_and_prune.h"
#include "packed_storage.h"
#include "pair_sink.h"
#include "sweep_grid.h"

namespace collision_pairs {

/// One thread's sweeper, with its memory and its share of the pairs (in no order).
class ColumnSweep {
 public:
  explicit ColumnSweep(const SweepKernel* kernel) : kernel_(kernel) {}

  void begin(const SweepTuning& tuning, const PairRules& rules, std::uint32_t unsure);

  /// All pairs of the records along `axis`, each once. `depth`: how often they were cut already.
  void sweep(const Record* records, std::size_t count, int axis, std::size_t depth);

  std::vector<BoxPair>& pairs() { return pairs_; }

 private:
  bool cut(const Record* records, std::size_t count, double tests_per_box, std::size_t depth);
  std::size_t sort(const Record* records, std::size_t count, int axis);

  const SweepKernel* kernel_;
  SweepTuning tuning_;
  PairRules rules_;
  std::uint32_t unsure_ = 0;
  PackedStorage packed_;
  CandidateStorage candidates_;
  std::vector<std::uint32_t> bins_;
  std::vector<std::uint32_t> row_end_;
  std::vector<std::unique_ptr<GridLevel>> levels_;
  std::vector<BoxPair> pairs_;
};

/// The axis that the tuning asks for, or else the one that the spread of the boxes gives.
int chooseAxis(const SweepTuning& tuning, const Spread& spread);

/// The spread of at most `sample` of the records, taken evenly.
Spread sampleSpread(const Record* records, std::size_t count, std::size_t sample);

}  // namespace collision_pairs
