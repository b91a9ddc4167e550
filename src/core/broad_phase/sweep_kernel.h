// The innermost loops, for each instruction set, and the choice among them at run time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace collision_pairs {

// A record's tag: the index of its box, and for each axis one bit that means "not the first copy":
// the box begins in an earlier cell.
constexpr std::uint32_t ID_BITS = 29;
constexpr std::uint32_t ID_MASK = (1u << ID_BITS) - 1u;
inline constexpr std::uint32_t laterCopy(int axis) { return 1u << (ID_BITS + axis); }

/// A box in single precision, relative to the cycle's origin and enlarged by half the reach.
struct Record {
  float lo[3];
  float hi[3];
  std::uint32_t tag;
  std::uint32_t model;
};

/// Converts boxes to records: min and max of a box, six doubles, plus `grow`, minus `origin`,
/// rounded to float. Each step (grow, subtract the origin, round to float) is a monotone
/// map, and both ends of all intervals go through the same ones. So b.min - reach <= a.max in exact
/// arithmetic leads to lo(b) <= hi(a) after all roundings: no rounding error accumulates, at any
/// distance from the origin; a large one only makes the test less selective. Conversely, lo(b) <
/// hi(a) implies b.min - reach < a.max; for an alarm distance of 0, whose reach of 1e-160 m is far
/// below the resolution of float, it implies b.min <= a.max.
/// Sides are clamped to what is finite in float. Lanes 6 and 7 are not used.
struct NarrowMap {
  double grow[8];
  double origin[8];
};

/// A monotone map from coordinates to cells: (x - base) * scale, clamped to 0 … last. Lanes as in a
/// record: the three lower sides and the three upper ones; 6 and 7 are not used.
struct CellMap {
  float base[8];
  float scale[8];
  float last[8];
  std::uint32_t row;    // cells along axis 0
  std::uint32_t layer;  // cells of axes 0 and 1
};

/// The cells that a box overlaps: the number of the first, and how many more per axis (10 bits
/// each, axis 0 lowest).
struct CellSpan {
  std::uint32_t first;
  std::uint32_t more;
};

/// Every packed array is readable this far past its end, and holds boxes there that overlap nothing
/// finite.
constexpr std::size_t PADDING = 16;

/// Bit of a candidate's second id: float could not decide, so the boxes are compared in double.
constexpr std::uint32_t UNSURE = 1u << 31;

/// Structure of arrays over n records. Upper sides are negated, so that a sum gives the gap of two
/// sides: they overlap if lo(a) + minus_hi(b) <= 0 and lo(b) + minus_hi(a) <= 0 on all axes.
/// Rounding never changes the sign of a sum of floats. If the processor flushes denormals to zero,
/// a pair may become one that just touches, which is tested again in double.
struct PackedBoxes {
  const float* lo[3];
  const float* minus_hi[3];
  const std::uint32_t* tag;
  const std::uint32_t* model;
};

/// A growing list of pairs of ids. `grow` makes room for at least `room` more; it is a pointer so
/// that no code of the C++ library is compiled for an instruction set that may be missing.
struct Candidates {
  std::uint32_t* first = nullptr;
  std::uint32_t* second = nullptr;
  std::size_t count = 0;
  std::size_t capacity = 0;
  void* owner = nullptr;
  void (*grow)(Candidates* self, std::size_t room) = nullptr;
};

/// Nodes of a tree over packed boxes: level 0 is the boxes, box i of level k + 1 encloses boxes
/// 16 i … 16 i + 15 of level k, and the last level has at most 16.
constexpr int MAX_LEVELS = 8;
constexpr std::uint32_t FAN_OUT = 16;
struct TreeView {
  PackedBoxes level[MAX_LEVELS];
  int nb_levels = 0;
  std::uint32_t nb_boxes = 0;
};
/// Up to this many boxes are all tested: descending a tree costs a mispredicted branch per node.
constexpr std::uint32_t SCAN_UP_TO = 512;

/// The time to sort a row grows with the square of its length; from here on a radix sort is faster.
constexpr std::uint32_t LONGEST_ROW = 256;

/// One instruction set's code.
struct SweepKernel {
  const char* name;

  /// Tests box i against boxes i + 1 … row_end[i] - 1 (and possibly a few beyond) on all three
  /// axes, closed intervals; writes (id i, id j) of those that overlap, belong to different models
  /// and are not reported by an earlier cell. `unsure` (0 or UNSURE) is set on every pair; if it is
  /// 0, UNSURE marks pairs that just touch.
  void (*sweep)(PackedBoxes boxes, const std::uint32_t* row_end, std::uint32_t nb_rows,
                std::uint32_t unsure, Candidates* out);

  /// Tests box i against the later boxes whose bits are set in its row of `allowed`, of `words`
  /// words; writes (i, j) of those that overlap, closed intervals. Tags and models are not used.
  void (*sweepAllowed)(PackedBoxes boxes, const std::uint64_t* allowed, std::uint32_t words,
                       std::uint32_t nb_boxes, Candidates* out);

  /// Tests each of the packed boxes against the tree and writes (id of the box, id in the tree).
  void (*query)(const TreeView& tree, PackedBoxes boxes, std::uint32_t nb_boxes,
                std::uint32_t unsure, Candidates* out);

  /// Converts boxes of six doubles each to records. Reads 16 bytes past the last box.
  void (*narrow)(const NarrowMap& map, const double* boxes, const std::uint32_t* models,
                 std::uint32_t first_tag, std::uint32_t nb_boxes, Record* out);

  /// The same to packed boxes: side k of box i, the upper ones negated, at sides[k * stride + i].
  void (*pack)(const NarrowMap& map, const double* boxes, std::uint32_t nb_boxes,
               std::size_t stride, float* sides);

  /// The cells of each record.
  void (*span)(const CellMap& map, const Record* records, std::size_t nb_records, CellSpan* out);

  /// Row i of `seconds` ends at ends[i], and the next one begins there; no number occurs in a row
  /// twice. Writes the pairs (i, number) of each row in the order of the numbers, leaving out rows
  /// longer than LONGEST_ROW. Reads PADDING past the last row, and writes one pair past it.
  void (*sortRows)(const std::uint32_t* seconds, const std::uint32_t* ends, std::size_t nb_rows,
                   std::uint32_t* pairs);

  /// Up to this many boxes, testing each against each is faster than sorting and sweeping
  /// (measured: docs/performance.md).
  std::uint32_t each_up_to;
};

/// The kernels that this machine can run, the fastest first.
const std::vector<const SweepKernel*>& sweepKernels();

}  // namespace collision_pairs
