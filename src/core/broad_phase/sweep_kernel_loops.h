// The loops of a kernel, written once over `Lanes`: the few vector operations of an instruction
// set. Include it from one file per instruction set, with Lanes in an unnamed namespace.
#pragma once

#include "sweep_kernel.h"

namespace collision_pairs {

/// Box i of the packed ones, on all lanes.
template <class Lanes>
struct OneBox {
  typename Lanes::Floats lo[3], minus_hi[3];
  typename Lanes::Ints later, model;

  OneBox(const PackedBoxes& boxes, std::size_t i)
      : later(Lanes::setInt(boxes.tag[i] & ~ID_MASK)), model(Lanes::setInt(boxes.model[i])) {
    for (int k = 0; k < 3; ++k) {
      lo[k] = Lanes::setFloat(boxes.lo[k][i]);
      minus_hi[k] = Lanes::setFloat(boxes.minus_hi[k][i]);
    }
  }

  /// The box around the first nb_boxes, of no model, for meetNode() only. It overlaps whatever one
  /// of them overlaps, because float addition is monotone.
  static OneBox around(const PackedBoxes& boxes, std::uint32_t nb_boxes) {
    OneBox all(boxes, 0);
    for (int k = 0; k < 3; ++k) {
      float lo = boxes.lo[k][0], minus_hi = boxes.minus_hi[k][0];
      for (std::uint32_t i = 1; i < nb_boxes; ++i) {
        lo = boxes.lo[k][i] < lo ? boxes.lo[k][i] : lo;
        minus_hi = boxes.minus_hi[k][i] < minus_hi ? boxes.minus_hi[k][i] : minus_hi;
      }
      all.lo[k] = Lanes::setFloat(lo);
      all.minus_hi[k] = Lanes::setFloat(minus_hi);
    }
    return all;
  }
};

/// Largest gap over the axes between `box` and those from j on; negative where they overlap.
template <class Lanes>
inline typename Lanes::Floats apart(const OneBox<Lanes>& box, const PackedBoxes& boxes,
                                    std::size_t j) {
  typename Lanes::Floats axis[3];
  for (int k = 0; k < 3; ++k) {
    axis[k] = Lanes::larger(Lanes::add(box.minus_hi[k], boxes.lo[k] + j),
                            Lanes::add(box.lo[k], boxes.minus_hi[k] + j));
  }
  return Lanes::larger(Lanes::larger(axis[0], axis[1]), axis[2]);
}

// The boxes are passed by value: vector stores may alias anything, but a local of this function
// need not be reloaded after each store.
template <class Lanes>
void sweepRows(PackedBoxes boxes, const std::uint32_t* row_end, std::uint32_t nb_rows,
               std::uint32_t unsure, Candidates* out) {
  for (std::uint32_t i = 0; i < nb_rows; ++i) {
    const std::uint32_t end = row_end[i];
    if (i + 1 >= end) continue;
    const std::size_t room = end - i + PADDING;
    if (out->capacity - out->count < room) out->grow(out, room);
    const OneBox<Lanes> box(boxes, i);
    const std::uint32_t id = boxes.tag[i] & ID_MASK;
    std::uint32_t* first = out->first + out->count;
    std::uint32_t* second = out->second + out->count;
    std::size_t found = 0;
    for (std::size_t j = i + 1; j < end; j += Lanes::COUNT) {
      const auto gap = apart(box, boxes, j);
      const auto fresh = Lanes::noCommonBits(box.later, boxes.tag + j);
      const auto strange = Lanes::differ(box.model, boxes.model + j);
      const auto hit = Lanes::both(Lanes::both(fresh, strange), Lanes::notPositive(gap));
      found += Lanes::append(hit, Lanes::negative(gap), id, boxes.tag + j, unsure, first + found,
                             second + found);
    }
    out->count += found;
  }
}

template <class Lanes>
void sweepAllowed(PackedBoxes boxes, const std::uint64_t* allowed, std::uint32_t words,
                  std::uint32_t nb_boxes, Candidates* out) {
  constexpr std::uint64_t ALL_LANES = (std::uint64_t{1} << Lanes::COUNT) - 1;
  for (std::uint32_t i = 0; i + 1 < nb_boxes; ++i) {
    if (out->capacity - out->count < nb_boxes) out->grow(out, nb_boxes);
    const OneBox<Lanes> box(boxes, i);
    const std::uint64_t* const row = allowed + std::size_t{i} * words;
    for (std::uint32_t j = (i + 1) - (i + 1) % Lanes::COUNT; j < nb_boxes; j += Lanes::COUNT) {
      std::uint64_t bits = row[j / 64] >> (j % 64) & ALL_LANES;
      if (bits == 0) continue;
      bits &= Lanes::bits(Lanes::notPositive(apart(box, boxes, j)));
      for (; bits != 0; bits &= bits - 1) {  // few overlap
        out->first[out->count] = i;
        out->second[out->count++] = j + static_cast<std::uint32_t>(__builtin_ctzll(bits));
      }
    }
  }
}

/// The 16 boxes of a node against one box, as bits.
template <class Lanes>
inline std::uint32_t meetNode(const OneBox<Lanes>& box, const PackedBoxes& level, std::size_t j) {
  std::uint32_t bits = 0;
  for (std::size_t k = 0; k < FAN_OUT; k += Lanes::COUNT) {
    bits |= Lanes::bits(Lanes::notPositive(apart(box, level, j + k))) << k;
  }
  return bits;
}

template <class Lanes>
inline void meetLeaf(const OneBox<Lanes>& box, std::uint32_t id, const PackedBoxes& boxes,
                     std::size_t j, std::uint32_t unsure, Candidates* out) {
  if (out->capacity - out->count < 2 * FAN_OUT) out->grow(out, 2 * FAN_OUT);
  for (std::size_t k = j; k < j + FAN_OUT; k += Lanes::COUNT) {
    const auto gap = apart(box, boxes, k);
    const auto hit =
        Lanes::both(Lanes::notPositive(gap), Lanes::differ(box.model, boxes.model + k));
    if (Lanes::bits(hit) == 0) continue;  // true for most leaves
    out->count += Lanes::append(hit, Lanes::negative(gap), id, boxes.tag + k, unsure,
                                out->first + out->count, out->second + out->count);
  }
}

/// Calls see(first box) for each leaf that may hold a box that overlaps this one, until it returns
/// false. True if it never did.
template <class Lanes, class See>
inline bool walkLeaves(const OneBox<Lanes>& box, const TreeView& tree, const See& see) {
  if (tree.nb_boxes <= SCAN_UP_TO) {
    for (std::uint32_t j = 0; j < tree.nb_boxes; j += FAN_OUT) {
      if (!see(j)) return false;
    }
    return true;
  }
  // Level and first box of the nodes still to be visited; each level pushes at most 16.
  struct Node {
    std::uint32_t level, begin;
  };
  Node stack[MAX_LEVELS * FAN_OUT];
  int nb_open = 0;
  stack[nb_open++] = {static_cast<std::uint32_t>(tree.nb_levels - 1), 0};
  while (nb_open > 0) {
    const Node node = stack[--nb_open];
    if (node.level == 0) {
      if (!see(node.begin)) return false;
      continue;
    }
    std::uint32_t bits = meetNode(box, tree.level[node.level], node.begin);
    for (; bits != 0; bits &= bits - 1) {
      const auto child = node.begin + static_cast<std::uint32_t>(__builtin_ctz(bits));
      stack[nb_open++] = {node.level - 1, child * FAN_OUT};
    }
  }
  return true;
}

/// The leaves that hold a box that overlaps the one around all query boxes, if they are few.
template <class Lanes>
struct CommonLeaves {
  std::uint32_t begin[SCAN_UP_TO / FAN_OUT];
  std::uint32_t count = 0;
  bool are_few = false;

  void find(const OneBox<Lanes>& around_all, const TreeView& tree) {
    are_few = walkLeaves(around_all, tree, [&](std::uint32_t leaf) {
      if (meetNode(around_all, tree.level[0], leaf) == 0) return true;
      if (count == SCAN_UP_TO / FAN_OUT) return false;
      begin[count++] = leaf;
      return true;
    });
  }
};

// The boxes of a query are those of a robot. In a large world they are near few static boxes, which
// one descent for all of them finds.
template <class Lanes>
void queryTree(const TreeView& tree, PackedBoxes boxes, std::uint32_t nb_boxes,
               std::uint32_t unsure, Candidates* out) {
  constexpr std::uint32_t ONE_BY_ONE = 3;  // with so few boxes a common descent does not pay off
  CommonLeaves<Lanes> common;
  if (nb_boxes > ONE_BY_ONE) common.find(OneBox<Lanes>::around(boxes, nb_boxes), tree);
  if (common.are_few && common.count == 0) return;
  for (std::uint32_t i = 0; i < nb_boxes; ++i) {
    const OneBox<Lanes> box(boxes, i);
    const auto meet = [&, id = boxes.tag[i] & ID_MASK](std::uint32_t leaf) {
      meetLeaf(box, id, tree.level[0], leaf, unsure, out);
      return true;
    };
    if (common.are_few) {
      for (std::uint32_t l = 0; l < common.count; ++l) meet(common.begin[l]);
    } else {
      walkLeaves(box, tree, meet);
    }
  }
}

// Eight lanes as compiler vector types: one, two or four registers.
typedef double Doubles8 __attribute__((vector_size(64)));
typedef float Floats8 __attribute__((vector_size(32)));
typedef std::int32_t Ints8 __attribute__((vector_size(32)));

/// NarrowMap, ready for use.
struct Narrowing {
  Doubles8 grow, origin;

  explicit Narrowing(const NarrowMap& map) {
    __builtin_memcpy(&grow, map.grow, sizeof grow);
    __builtin_memcpy(&origin, map.origin, sizeof origin);
  }
  // By reference: without AVX a vector can't be returned.
  void operator()(const double* box, Floats8& narrow) const {
    constexpr double MAX = 3.4028234663852886e38;  // the largest float
    const Doubles8 most = {MAX, MAX, MAX, MAX, MAX, MAX, MAX, MAX};
    Doubles8 sides;
    __builtin_memcpy(&sides, box, sizeof sides);
    sides = (sides + grow) - origin;
    sides = sides < -most ? -most : sides;
    sides = sides > most ? most : sides;
    narrow = __builtin_convertvector(sides, Floats8);
  }
};

template <class Lanes>
void narrowRows(const NarrowMap& map, const double* boxes, const std::uint32_t* models,
                std::uint32_t first_tag, std::uint32_t nb_boxes, Record* out) {
  const Narrowing narrowed(map);
  for (std::uint32_t i = 0; i < nb_boxes; ++i) {
    Floats8 sides;
    narrowed(boxes + 6 * std::size_t{i}, sides);
    __builtin_memcpy(static_cast<void*>(out + i), &sides, sizeof sides);
    out[i].tag = first_tag + i;
    out[i].model = models[i];
  }
}

template <class Lanes>
void packRows(const NarrowMap& map, const double* boxes, std::uint32_t nb_boxes, std::size_t stride,
              float* sides) {
  const Narrowing narrowed(map);
  for (std::uint32_t i = 0; i < nb_boxes; ++i) {
    Floats8 narrow;
    narrowed(boxes + 6 * std::size_t{i}, narrow);
    for (std::size_t k = 0; k < 3; ++k) {
      sides[k * stride + i] = narrow[k];
      sides[(k + 3) * stride + i] = -narrow[k + 3];
    }
  }
}

template <class Lanes>
void spanRows(const CellMap& map, const Record* records, std::size_t nb_records, CellSpan* out) {
  Floats8 base, scale, last;
  __builtin_memcpy(&base, map.base, sizeof base);
  __builtin_memcpy(&scale, map.scale, sizeof scale);
  __builtin_memcpy(&last, map.last, sizeof last);
  const std::uint32_t row = map.row;
  const std::uint32_t layer = map.layer;
  for (std::size_t i = 0; i < nb_records; ++i) {
    Floats8 x;
    __builtin_memcpy(&x, records + i, sizeof x);
    x = (x - base) * scale;
    x = x > 0.0f ? x : Floats8{};
    x = x < last ? x : last;
    const Ints8 signed_cell = __builtin_convertvector(x, Ints8);
    std::uint32_t cell[8];
    __builtin_memcpy(cell, &signed_cell, sizeof cell);
    out[i].first = cell[0] + cell[1] * row + cell[2] * layer;
    out[i].more = (cell[3] - cell[0]) | (cell[4] - cell[1]) << 10 | (cell[5] - cell[2]) << 20;
  }
}

// The place of a number in its row is that of those in it that are smaller. Lanes past the end of a
// row are not skipped, because a branch for them would be mispredicted.
template <class Lanes>
void sortRows(const std::uint32_t* seconds, const std::uint32_t* ends, std::size_t nb_rows,
              std::uint32_t* pairs) {
  constexpr std::int32_t MAX = 0x7fffffff;
  const Ints8 lane = {0, 1, 2, 3, 4, 5, 6, 7};
  std::uint32_t begin = 0;
  for (std::size_t row = 0; row < nb_rows; ++row) {
    const auto count = static_cast<std::int32_t>(ends[row] - begin);
    const std::uint32_t* const numbers = seconds + begin;
    std::uint32_t* const out = pairs + 2 * std::size_t{begin};
    begin = ends[row];
    if (count > static_cast<std::int32_t>(LONGEST_ROW)) continue;
    std::int32_t block = 0;
    do {
      Ints8 keys, others, place = {};
      __builtin_memcpy(&keys, numbers + block, sizeof keys);
      std::int32_t other_block = 0;
      do {
        __builtin_memcpy(&others, numbers + other_block, sizeof others);
        others = lane < count - other_block ? others : MAX - Ints8{};
        std::int32_t other[8];
        __builtin_memcpy(other, &others, sizeof other);
        for (int k = 0; k < 8; ++k) place -= other[k] < keys;
        other_block += 8;
      } while (other_block < count);
      // What is past the end goes where the next row will be.
      place = lane < count - block ? place : count - Ints8{};
      std::int32_t places[8];
      __builtin_memcpy(places, &place, sizeof places);
      for (int k = 0; k < 8; ++k) {
        out[2 * places[k]] = static_cast<std::uint32_t>(row);
        out[2 * places[k] + 1] = numbers[block + k];
      }
      block += 8;
    } while (block < count);
  }
}

template <class Lanes>
constexpr SweepKernel makeKernel(const char* name, std::uint32_t each_up_to) {
  return {name,
          sweepRows<Lanes>,
          sweepAllowed<Lanes>,
          queryTree<Lanes>,
          narrowRows<Lanes>,
          packRows<Lanes>,
          spanRows<Lanes>,
          sortRows<Lanes>,
          each_up_to};
}

}  // namespace collision_pairs
