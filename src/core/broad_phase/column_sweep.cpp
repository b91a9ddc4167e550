#include "column_sweep.h"

#include <algorithm>

namespace collision_pairs {
namespace {

// Clusters within clusters are split at most this often; what is still crowded is swept as it is.
constexpr std::size_t MAX_DEPTH = 6;
constexpr std::size_t SAMPLE = 256;

// A monotone map from a coordinate to one of `count` bins that hold about as many records each.
struct Bins {
  float base = 0.0f;
  float scale = 0.0f;
  std::uint32_t count = 1;

  std::uint32_t operator()(float x) const {
    return static_cast<std::uint32_t>(
        std::min(std::max(0.0f, (x - base) * scale), static_cast<float>(count - 1)));
  }
};

// The range of the middle of a small sample, slightly widened: one distant box must not push all
// others into one bin.
Bins chooseBins(const Record* records, std::size_t count, int axis) {
  constexpr std::size_t PROBES = 16;
  constexpr std::size_t TAIL = PROBES / 10;
  Bins bins;
  bins.count = static_cast<std::uint32_t>(count / 2 + 1);
  float probes[PROBES];
  for (std::size_t i = 0; i < PROBES; ++i) probes[i] = records[i * count / PROBES].lo[axis];
  std::sort(probes, probes + PROBES);
  const float low = probes[TAIL];
  const float high = probes[PROBES - 1 - TAIL];
  const float widen = 0.15f * (high - low);
  const float range = high - low + 2.0f * widen;
  if (!(range > 0.0f) || !(range < 1e30f)) return bins;
  const float scale = static_cast<float>(bins.count) / range;
  if (!(scale < 1e30f)) return bins;
  bins.base = low - widen;
  bins.scale = scale;
  return bins;
}

// Of some of the records, evenly spaced in their order.
Spread sampleSpread(const Record* records, std::size_t count) {
  const std::size_t used = std::min(count, SAMPLE);
  return measureSpread([&](std::size_t i) -> const Record& { return records[i * count / used]; },
                       used);
}

}  // namespace

void ColumnSweep::begin(const SweepTuning& tuning, const PairTest& test, std::uint32_t unsure) {
  tuning_ = tuning;
  test_ = test;
  unsure_ = unsure;
  pairs_.clear();
}

void ColumnSweep::sweep(const Record* records, std::size_t count) {
  sweep(records, count, sweepAxis(sampleSpread(records, count)), 0);
}

void ColumnSweep::sweep(const Record* records, std::size_t count, int axis, std::size_t depth) {
  if (count < 2) return;
  if (count > tuning_.column_size && cut(records, count, 0.0, depth)) return;
  const std::size_t tests = sort(records, count, axis);
  if (tests > count * tuning_.tests_per_box) {
    const double tests_per_box = static_cast<double>(tests) / static_cast<double>(count);
    if (cut(records, count, tests_per_box, depth)) return;
  }
  Candidates* candidates = candidates_.clear();
  kernel_->sweep(packed_.view(), row_end_.data(), static_cast<std::uint32_t>(count), unsure_,
                 candidates);
  appendMovingPairs(*candidates, test_, &pairs_);
}

// Splits into columns and sweeps each. False, with nothing done, if that would not help.
bool ColumnSweep::cut(const Record* records, std::size_t count, double tests_per_box,
                      std::size_t depth) {
  if (depth >= MAX_DEPTH) return false;
  const Spread spread = sampleSpread(records, count);
  const int axis = sweepAxis(spread);
  if (tests_per_box == 0.0) tests_per_box = static_cast<double>(count) * spread.crowd(axis);
  const SweepGrid grid = chooseGrid(spread, axis, count, tests_per_box, tuning_.column_size);
  while (levels_.size() <= depth) levels_.push_back(std::make_unique<GridLevel>(kernel_));
  GridLevel& level = *levels_[depth];
  if (!level.fill(grid, records, count)) return false;
  for (std::uint32_t cell = 0; cell < level.nbCells(); ++cell) {
    sweep(level.cellBegin(cell), level.cellSize(cell), axis, depth + 1);
  }
  return true;
}

// Counting sort into bins along the axis. The row of a box ends with the bin in which the box ends:
// whatever overlaps it and does not precede it lies in between. Returns the number of tests of the
// sweep.
std::size_t ColumnSweep::sort(const Record* records, std::size_t count, int axis) {
  const Bins bins = chooseBins(records, count, axis);
  bins_.assign(bins.count + 1, 0);
  std::uint32_t* const places = bins_.data();
  for (std::size_t i = 0; i < count; ++i) ++places[bins(records[i].lo[axis]) + 1];
  for (std::uint32_t b = 0; b < bins.count; ++b) places[b + 1] += places[b];

  packed_.resize(count);
  const PackedStorage::Writer write = packed_.writer();
  if (row_end_.size() < count) row_end_.resize(count + count / 2);
  std::uint32_t* const row_end = row_end_.data();
  // Writing the records moves each bin's entry from its begin to its end.
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t place = places[bins(records[i].lo[axis])]++;
    write(place, records[i]);
    row_end[place] = bins(records[i].hi[axis]);
  }
  std::size_t tests = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    row_end[i] = places[row_end[i]];
    tests += row_end[i] - i;
  }
  return tests;
}

}  // namespace collision_pairs
