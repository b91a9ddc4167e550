#include "sweep_grid.h"

#include <cmath>

namespace collision_pairs {
namespace {

// Boxes tested by one SIMD instruction; a sweep that tests fewer wastes lanes.
constexpr double TESTS_IN_A_COLUMN = 16.0;
// With more cells than this, the write positions of the cells no longer fit the TLB.
constexpr double MOST_CELLS = 4096.0;
// Per axis: the range of a CellSpan.
constexpr double MOST_CELLS_ON_AN_AXIS = 1000.0;

CellMap makeCellMap(const SweepGrid& grid) {
  CellMap map{};
  for (int side = 0; side < 6; ++side) {
    map.base[side] = grid.base[side % 3];
    map.scale[side] = grid.scale[side % 3];
    map.last[side] = static_cast<float>(grid.cells[side % 3] - 1);
  }
  map.row = grid.cells[0];
  map.layer = grid.cells[0] * grid.cells[1];
  return map;
}

// Calls use(cell, later) for each cell of a span; `later` are the tag bits of a copy that is not
// the first.
template <class Use>
void forEachCell(const SweepGrid& grid, CellSpan span, Use use) {
  constexpr std::uint32_t MASK = 1023;
  for (std::uint32_t z = 0; z <= span.more >> 20; ++z) {
    for (std::uint32_t y = 0; y <= (span.more >> 10 & MASK); ++y) {
      const std::uint32_t row = span.first + (z * grid.cells[1] + y) * grid.cells[0];
      const std::uint32_t later = (z ? laterCopy(2) : 0) | (y ? laterCopy(1) : 0);
      for (std::uint32_t x = 0; x <= (span.more & MASK); ++x) {
        use(row + x, later | (x ? laterCopy(0) : 0));
      }
    }
  }
}

// Number of cells along an axis if none is narrower than three mean boxes.
double mostCells(const Spread& spread, int axis) {
  constexpr double NARROWEST = 3.0;
  const double narrowest = NARROWEST * spread.size[axis];
  if (spread.range(axis) <= narrowest) return 1.0;
  return narrowest > 0.0 ? std::min(spread.range(axis) / narrowest, MOST_CELLS_ON_AN_AXIS)
                         : MOST_CELLS_ON_AN_AXIS;
}

void setCells(SweepGrid* grid, const Spread& spread, int axis, double cells) {
  const double range = spread.range(axis);
  if (!(cells >= 2.0) || !(range > 0.0)) return;
  const double scale = std::floor(cells) / range;
  if (!(scale < 1e30)) return;
  grid->cells[axis] = static_cast<std::uint32_t>(cells);
  grid->scale[axis] = static_cast<float>(scale);
  grid->base[axis] = static_cast<float>(spread.mean[axis] - 0.5 * range);
}

}  // namespace

SweepGrid chooseGrid(const Spread& spread, int axis, std::size_t count, double tests_per_box,
                     std::uint32_t column_size) {
  const int u = (axis + 1) % 3;
  const int v = (axis + 2) % 3;
  const double most_u = mostCells(spread, u);
  const double most_v = mostCells(spread, v);
  const double wanted = std::min(tests_per_box / TESTS_IN_A_COLUMN, MOST_CELLS);
  // Along both axes the same number of mean boxes wide, unless one axis is too short for that.
  const double shrink = std::sqrt(std::min(1.0, wanted / (most_u * most_v)));
  double cells_u = std::max(1.0, most_u * shrink);
  double cells_v = std::max(1.0, most_v * shrink);
  if (most_u * shrink < 1.0) cells_v = std::min(most_v, wanted);
  if (most_v * shrink < 1.0) cells_u = std::min(most_u, wanted);

  SweepGrid grid;
  setCells(&grid, spread, u, std::round(cells_u));
  setCells(&grid, spread, v, std::round(cells_v));
  const double columns = static_cast<double>(grid.nbCells());
  const double pieces = std::ceil(static_cast<double>(count) / columns / column_size);
  setCells(&grid, spread, axis,
           std::floor(std::min({pieces, mostCells(spread, axis), 2.0 * MOST_CELLS / columns})));
  return grid;
}

SweepGrid coarser(SweepGrid grid) {
  for (int k = 0; k < 3; ++k) {
    if (grid.cells[k] == 1) continue;
    grid.cells[k] /= 2;
    grid.scale[k] *= 0.5f;
  }
  return grid;
}

bool GridLevel::fill(const SweepGrid& grid, const Record* records, std::size_t n) {
  constexpr std::size_t MOST_COPIES = 3;
  for (grid_ = grid; grid_.nbCells() > 1; grid_ = coarser(grid_)) {
    const std::size_t copies = count(records, n);
    if (copies > MOST_COPIES * n) continue;
    place(records, n, copies);
    return true;
  }
  return false;
}

std::size_t GridLevel::count(const Record* records, std::size_t n) {
  starts_.assign(grid_.nbCells() + 1, 0);
  if (spans_.size() < n) spans_.resize(n + n / 4);
  kernel_->span(makeCellMap(grid_), records, n, spans_.data());
  std::uint32_t* const counts = starts_.data();
  std::size_t copies = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const CellSpan span = spans_[i];
    ++counts[span.first];
    ++copies;
    if (span.more == 0) continue;
    --counts[span.first];
    --copies;
    forEachCell(grid_, span, [&](std::uint32_t cell, std::uint32_t) {
      ++counts[cell];
      ++copies;
    });
  }
  return copies;
}

void GridLevel::place(const Record* records, std::size_t n, std::size_t nb_copies) {
  std::uint32_t start = 0;
  for (std::uint32_t& entry : starts_) {
    const std::uint32_t count = entry;
    entry = start;
    start += count;
  }
  next_.assign(starts_.begin(), starts_.end() - 1);
  if (records_.size() < nb_copies) records_.resize(nb_copies + nb_copies / 4);
  std::uint32_t* const next = next_.data();
  Record* const copies = records_.data();
  for (std::size_t i = 0; i < n; ++i) {
    const CellSpan span = spans_[i];
    copies[next[span.first]++] = records[i];
    if (span.more == 0) continue;
    --next[span.first];
    forEachCell(grid_, span, [&](std::uint32_t cell, std::uint32_t later) {
      Record& copy = copies[next[cell]++];
      copy = records[i];
      copy.tag |= later;
    });
  }
}

}  // namespace collision_pairs
