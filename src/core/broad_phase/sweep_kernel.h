// The innermost loops, for each instruction set, and the choice among them at run time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace collision_pairs {

// A record's tag: the index of its box, and for each axis one bit that says "not the first copy":
// the box begins in a cell before this one.
constexpr std::uint32_t ID_BITS = 29;
constexpr std::uint32_t ID_MASK = (1u << ID_BITS) - 1u;
inline constexpr std::uint32_t laterCopy(int axis) { return 1u << (ID_BITS + axis); }

/// A box in single precision, relative to the cycle's origin and grown by half the reach.
struct Record {
  float lo[3];
  float hi[3];
  std::uint32_t tag;
  std::uint32_t model;
};

/// What narrows boxes to records: min and max of a box, six doubles, plus `grow`, minus `origin`,
/// rounded to float. Each step (grow, subtract the origin, round to float) is a monotone
/// map, and both ends of all intervals go through the same ones. So b.min - reach <= a.max in
/// exact arithmetic leads to lo(b) <= hi(a) after all roundings: there is no rounding error to
/// add up, at any distance from the origin; a far one costs sharpness only. The other way round,
/// lo(b) < hi(a) says b.min - reach < a.max; for an alarm distance of 0, whose reach of 1e-160 m
/// is far below what float tells apart, it says b.min <= a.max.
/// Sides are clamped to what is finite in float. Lanes 6 and 7 are not used.
struct NarrowMap {
  double grow[8];
  double origin[8];
};

/// A monotone map from coordinates to cells: (x - base) * scale, cut down to 0 … last. Lanes as
/// in a record: the three lower sides and the three upper ones; 6 and 7 are not used.
struct CellMap {
  float base[8];
  float scale[8];
  float last[8];
  std::uint32_t row;    // cells along axis 0
  std::uint32_t layer;  // cells of axes 0 and 1
};

/// The cells that a box reaches into: the number of the first, and how many more per axis (10
/// bits each, axis 0 lowest).
struct CellSpan {
  std::uint32_t first;
  std::uint32_t more;
};

/// Every packed array is readable this far behind its end, and holds boxes there that
/// overlap nothing finite.
constexpr std::size_t PADDING = 16;

/// On a candidate's second id: float could not decide, look at the true boxes.
constexpr std::uint32_t UNSURE = 1u << 31;

/// Structure of arrays over n records. Upper sides are negated, so that a sum tells how far apart
/// two sides are: lo(a) + minus_hi(b) <= 0 on all axes, both ways round, is overlap. The sign of
/// a sum of floats is right whatever is rounded, and if a processor is set to flush denormals to
/// zero a pair becomes one that just touches, which is looked at again in double.
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
/// Up to this many boxes are all looked at: walking a tree costs a mispredicted branch a node.
constexpr std::uint32_t SCAN_UP_TO = 512;

/// One instruction set's code.
struct SweepKernel {
  const char* name;

  /// Tests box i against boxes i + 1 … row_end[i] - 1 (a few beyond may be looked at) on all
  /// three axes, closed; writes (id i, id j) of those of two models that overlap and that no
  /// earlier cell reports. `unsure` (0 or UNSURE) is put on every pair; where it is 0, UNSURE
  /// marks those that just touch.
  void (*sweep)(PackedBoxes boxes, const std::uint32_t* row_end, std::uint32_t nb_rows,
                std::uint32_t unsure, Candidates* out);

  /// Tests each of the packed boxes against the tree and writes (id of the box, id in the tree).
  void (*query)(const TreeView& tree, PackedBoxes boxes, std::uint32_t nb_boxes,
                std::uint32_t unsure, Candidates* out);

  /// Narrows boxes of six doubles each. Reads 16 bytes behind the last box.
  void (*narrow)(const NarrowMap& map, const double* boxes, const std::uint32_t* models,
                 std::uint32_t first_tag, std::uint32_t nb_boxes, Record* out);

  /// The cells of each record.
  void (*span)(const CellMap& map, const Record* records, std::size_t nb_records, CellSpan* out);

  /// Up to this many boxes it tests each against each sooner than it sorts and sweeps them
  /// (measured: docs/broad_phase.md).
  std::uint32_t each_up_to;
};

/// What this machine can run, the best one first and the scalar one last.
const std::vector<const SweepKernel*>& sweepKernels();

}  // namespace collision_pairs
