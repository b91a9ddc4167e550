#include "sweep_grid.h"

#include <cmath>
#include <cstring>

namespace collision_pairs {
namespace {

// Candidates that one SIMD load takes; a sweep that tests fewer wastes lanes.
constexpr double TESTS_IN_A_COLUMN = 16.0;
// More cells than this at once, and the places that records are written to no longer fit the
// caches of addresses.
constexpr double MOST_CELLS = 4096.0;
// On one axis: what a CellSpan can hold.
constexpr double MOST_CELLS_ON_AN_AXIS = 1000.0;

// Four lanes of the compiler's base target; the fourth holds whatever follows a corner and is
// not used.
typedef float Floats4 __attribute__((vector_size(16)));
typedef std::int32_t Ints4 __attribute__((vector_size(16)));

// The map from coordinates to cells, with the grid's numbers at hand.
class CellMap {
 public:
  explicit CellMap(const SweepGrid& grid)
      : base_{grid.base[0], grid.base[1], grid.base[2], 0.0f},
        scale_{grid.scale[0], grid.scale[1], grid.scale[2], 0.0f},
        last_{lastCell(grid, 0), lastCell(grid, 1), lastCell(grid, 2), 0.0f},
        row_(grid.cells[0]),
        layer_(grid.cells[0] * grid.cells[1]) {}

  CellSpan span(const Record& record) const {
    const Ints4 first = cells(record.lo);
    const Ints4 more = cells(record.hi) - first;
    return {unsign(first[0]) + unsign(first[1]) * row_ + unsign(first[2]) * layer_,
            unsign(more[0]) | unsign(more[1]) << 10 | unsign(more[2]) << 20};
  }

 private:
  static float lastCell(const SweepGrid& grid, int axis) {
    return static_cast<float>(grid.cells[axis] - 1);
  }
  static std::uint32_t unsign(std::int32_t x) { return static_cast<std::uint32_t>(x); }
  Ints4 cells(const float* corner) const {
    Floats4 x;
    std::memcpy(&x, corner, sizeof x);
    x = (x - base_) * scale_;
    x = x > 0.0f ? x : Floats4{};  // what is not a number, too
    x = x < last_ ? x : last_;
    return __builtin_convertvector(x, Ints4);
  }
  Floats4 base_, scale_, last_;
  std::uint32_t row_, layer_;
};

// Calls use(cell, later) with the number of each cell of a span, and the tag bits of a copy that
// is not the first.
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

// How many cells fit along an axis if none is narrower than three mean boxes.
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
  // Both ways the same number of mean boxes wide, unless one way has no room for that.
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
  const CellMap map(grid_);
  std::uint32_t* const counts = starts_.data();
  std::size_t copies = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const CellSpan span = map.span(records[i]);
    spans_[i] = span;
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
