// A grid of cells over boxes: columns along the sweep axis, cut across where they are long.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "packed_records.h"
#include "sweep_axis.h"

namespace collision_pairs {

/// Cells are numbered with axis 0 fastest. The outermost ones reach to infinity. The map from a
/// coordinate to a cell is monotone, which is all that exactness needs.
struct SweepGrid {
  float base[3] = {0, 0, 0};
  float scale[3] = {0, 0, 0};  // cells per metre
  std::uint32_t cells[3] = {1, 1, 1};

  std::uint32_t nbCells() const { return cells[0] * cells[1] * cells[2]; }
};

/// Columns along `axis` so wide that a sweep in one of them tests a box against about one SIMD
/// register of others, given that a sweep without columns tests it against `tests_per_box`. Never
/// narrower than three mean boxes, since boxes on a border are copied to both sides. Columns are
/// split across the sweep axis where a piece would hold more than `column_size` of the `count`
/// boxes.
SweepGrid chooseGrid(const Spread& spread, int axis, std::size_t count, double tests_per_box,
                     std::uint32_t column_size);

/// Half as many cells along each axis.
SweepGrid coarser(SweepGrid grid);

/// Records sorted into the cells of a grid, copied where they reach into several. Keeps its
/// memory.
class GridLevel {
 public:
  explicit GridLevel(const SweepKernel* kernel) : kernel_(kernel) {}

  /// False if splitting does not pay off: one cell, or so many copies that the grid was made
  /// coarser until one cell was left. The records are then undefined.
  bool fill(const SweepGrid& grid, const Record* records, std::size_t n);

  std::uint32_t nbCells() const { return grid_.nbCells(); }
  const Record* cellBegin(std::uint32_t cell) const { return records_.data() + starts_[cell]; }
  std::size_t cellSize(std::uint32_t cell) const { return starts_[cell + 1] - starts_[cell]; }

 private:
  std::size_t count(const Record* records, std::size_t n);
  void place(const Record* records, std::size_t n, std::size_t nb_copies);

  const SweepKernel* kernel_;
  SweepGrid grid_;
  std::vector<std::uint32_t> starts_;  // counts first
  std::vector<std::uint32_t> next_;
  std::vector<CellSpan> spans_;
  std::vector<Record> records_;
};

}  // namespace collision_pairs
