// The loops of BatchKernel, for any width: `Set` defines the vector types. Uses nothing of the C++
// library, so that a file compiled for newer processors puts none of their instructions into a
// shared inline function. The result of a lane never depends on another lane, and all kernels round
// identically: the same operations in the same order, none fused.
#pragma once

#include "batch_kernel.h"

namespace collision_pairs {

template <class Set>
class BatchLoops {
  using Floats = typename Set::Floats;
  using Ints = typename Set::Ints;
  static constexpr int LANES = Set::LANES;

  static Floats load(const float* from) { return *reinterpret_cast<const Floats*>(from); }
  static void store(const Floats& lanes, float* to) { *reinterpret_cast<Floats*>(to) = lanes; }

  /// Sine and cosine, each with an error of at most 4 * 2^-24. The angle is reduced to -pi/4 ...
  /// pi/4 in double; polynomials as in Cephes (Moshier, 1992).
  static void sineAndCosine(const double* angle, Floats& sine, Floats& cosine) {
    constexpr double HALF_PI = 1.57079632679489661923, ROUNDER = 6755399441055744.0;  // 1.5 * 2^52
    alignas(64) float rest[LANES];
    alignas(64) int quarter[LANES];
    for (int l = 0; l < LANES; ++l) {
      const double turns = (angle[l] * (1.0 / HALF_PI) + ROUNDER) - ROUNDER;
      rest[l] = static_cast<float>(angle[l] - turns * HALF_PI);
      quarter[l] = static_cast<int>(turns);
    }
    const Floats x = load(rest), z = x * x;
    const Ints turned = *reinterpret_cast<const Ints*>(quarter);
    const Floats s =
        x + x * z * (-1.6666654611e-1f + z * (8.3321608736e-3f + z * -1.9515295891e-4f));
    const Floats c =
        1.0f - 0.5f * z +
        z * z * (4.166664568298827e-2f + z * (-1.388731625493765e-3f + z * 2.443315711809948e-5f));
    const Ints is_odd = (turned & 1) != 0;
    const Floats sine_size = is_odd ? c : s, cosine_size = is_odd ? s : c;
    sine = (turned & 2) != 0 ? -sine_size : sine_size;
    cosine = ((turned + 1) & 2) != 0 ? -cosine_size : cosine_size;
  }

  static void place(const BatchTables& tables, const BatchLanes& group) {
    for (int i = 0; i < tables.nb_bodies; ++i) placeBody(tables.bodies[i], i, group);
  }

  static void placeBody(const BatchBody& body, int index, const BatchLanes& group) {
    float* const pose = group.poses + index * 12 * LANES;
    Floats axes[3][3], p[3];  // axes[k]: the k-th column of R
    if (body.parent < 0) {
      for (int row = 0; row < 3; ++row) {
        for (int k = 0; k < 3; ++k) axes[k][row] = Floats{} + body.R[3 * row + k];
        p[row] = Floats{} + body.p[row];
      }
    } else {
      const float* const above = group.poses + body.parent * 12 * LANES;
      for (int row = 0; row < 3; ++row) {
        const Floats x = load(above + row * LANES), y = load(above + (3 + row) * LANES),
                     z = load(above + (6 + row) * LANES);
        for (int k = 0; k < 3; ++k) {
          axes[k][row] = x * body.R[k] + y * body.R[3 + k] + z * body.R[6 + k];
        }
        p[row] = x * body.p[0] + y * body.p[1] + z * body.p[2] + load(above + (9 + row) * LANES);
      }
    }
    if (body.kind == BatchBody::TURNS) {
      Floats sine, cosine;
      sineAndCosine(group.positions + body.column * LANES, sine, cosine);
      for (int row = 0; row < 3; ++row) {
        const Floats x = axes[0][row], y = axes[1][row];
        axes[0][row] = cosine * x + sine * y;
        axes[1][row] = cosine * y - sine * x;
      }
    } else if (body.kind == BatchBody::SLIDES) {
      alignas(64) float by[LANES];
      for (int l = 0; l < LANES; ++l) {
        by[l] = static_cast<float>(group.positions[body.column * LANES + l]);
      }
      for (int row = 0; row < 3; ++row) p[row] = p[row] + axes[2][row] * load(by);
    }
    for (int row = 0; row < 3; ++row) {
      for (int k = 0; k < 3; ++k) store(axes[k][row], pose + (3 * k + row) * LANES);
      store(p[row], pose + (9 + row) * LANES);
    }
  }

  static const float* centerOf(const BatchTables& tables, const BatchLanes& group, int sphere) {
    float* const center = group.centers + sphere * 3 * LANES;
    if (group.placed[sphere] == group.group) return center;
    group.placed[sphere] = group.group;
    const BatchSphere& of_sphere = tables.spheres[sphere];
    const float* const pose = group.poses + of_sphere.body * 12 * LANES;
    for (int row = 0; row < 3; ++row) {
      const float* const r = pose + row * LANES;
      store(load(r) * of_sphere.center[0] + load(r + 3 * LANES) * of_sphere.center[1] +
                load(r + 6 * LANES) * of_sphere.center[2] + load(r + 9 * LANES),
            center + row * LANES);
    }
    return center;
  }

  /// A bound changes by no more than the distance between two points. Its own rounding is that of
  /// less than 12 operations, a millionth of the margin that is left.
  static unsigned further(const BatchTables& tables, const BatchLanes& group, int sphere,
                          const BatchGrid& grid, float reach) {
    const float* const center = centerOf(tables, group, sphere);
    const float last = static_cast<float>(grid.side - 1);
    Ints cell{}, is_inside = ~Ints{};
    Floats squared{};
    for (int axis = 2; axis >= 0; --axis) {
      const Floats p = load(center + axis * LANES) - grid.origin[axis];
      Floats place = p * grid.cells_a_metre[axis];
      is_inside &= (place >= 0.0f) & (place < last + 1.0f);
      place = place > 0.0f ? place : Floats{};
      place = place < last ? place : Floats{} + last;
      const Ints along = __builtin_convertvector(place, Ints);
      const Floats beside = p - (__builtin_convertvector(along, Floats) + 0.5f) * grid.size[axis];
      squared = squared + beside * beside;
      cell = cell * grid.side + along;
    }
    alignas(64) int index[LANES], bits[LANES];
    *reinterpret_cast<Ints*>(index) = cell;
    for (int l = 0; l < LANES; ++l) bits[l] = __atomic_load_n(grid.apart + index[l], __ATOMIC_RELAXED);
    const Floats left = (reinterpret_cast<Floats>(*reinterpret_cast<const Ints*>(bits)) - reach) * 0.999999f;
    return Set::bits(is_inside & (left > 0.0f) & (left * left > squared));
  }

  struct Gap {
    Floats squared;
    float reach;  ///< sum of the two radii and the padding
  };

  static Gap gapOf(const BatchTables& tables, const BatchLanes& group, int a, int b,
                   float padding) {
    const float* const from = centerOf(tables, group, a);
    const float* const to = centerOf(tables, group, b);
    const Floats x = load(to) - load(from), y = load(to + LANES) - load(from + LANES),
                 z = load(to + 2 * LANES) - load(from + 2 * LANES);
    return {x * x + y * y + z * z, tables.spheres[a].radius + tables.spheres[b].radius + padding};
  }

  /// The lanes in which the two may overlap: all except those in which they certainly do not.
  static unsigned mayMeet(const Gap& gap) {
    return ~Set::bits(gap.squared > Floats{} + gap.reach * gap.reach);
  }

  /// Of `lanes`, those in which leaves of both trees overlap.
  static unsigned openLanes(const BatchTables& tables, const BatchLanes& group,
                            const BatchPair& pair, unsigned lanes) {
    struct Step {
      int a, b;
      unsigned lanes;
    };
    Step stack[64];  // the two paths to leaves leave at most one step per sphere
    int depth = 0;
    stack[depth++] = {tables.trees[pair.first].first_outer, tables.trees[pair.second].first_outer,
                      lanes};
    unsigned open = 0;
    while (depth > 0) {
      Step step = stack[--depth];
      step.lanes &= ~open;
      if (step.lanes == 0) continue;
      step.lanes &= mayMeet(gapOf(tables, group, step.a, step.b, pair.outer_padding));
      if (step.lanes == 0) continue;
      const int in_a = tables.spheres[step.a].first_child,
                in_b = tables.spheres[step.b].first_child;
      if (in_a == 0 && in_b == 0) {
        open |= step.lanes;
      } else if (in_b == 0 ||
                 (in_a != 0 && tables.spheres[step.a].rank >= tables.spheres[step.b].rank)) {
        stack[depth++] = {in_a, step.b, step.lanes};
        stack[depth++] = {in_a + 1, step.b, step.lanes};
      } else {
        stack[depth++] = {step.a, in_b, step.lanes};
        stack[depth++] = {step.a, in_b + 1, step.lanes};
      }
    }
    return open;
  }

  /// Of `lanes`, those in which inner spheres overlap.
  static unsigned certainLanes(const BatchTables& tables, const BatchLanes& group,
                               const BatchPair& pair, unsigned lanes) {
    const BatchTree &first = tables.trees[pair.first], &second = tables.trees[pair.second];
    unsigned certain = 0;
    for (int i = 0; i < first.nb_inner; ++i) {
      for (int j = 0; j < second.nb_inner; ++j) {
        const Gap gap =
            gapOf(tables, group, first.first_inner + i, second.first_inner + j, pair.inner_padding);
        if (gap.reach > 0.0f) certain |= Set::bits(gap.squared < Floats{} + gap.reach * gap.reach);
        if ((lanes & ~certain) == 0) return lanes;
      }
    }
    return certain & lanes;
  }

  static int settle(const BatchTables& tables, const BatchLanes& group, unsigned lanes,
                    OpenBatchPair* open, int* contact) {
    int nb_open = 0;
    for (int i = 0; i < tables.nb_pairs && lanes != 0; ++i) {
      const BatchPair& pair = tables.pairs[i];
      unsigned near =
          lanes & mayMeet(gapOf(tables, group, tables.trees[pair.first].first_outer,
                                tables.trees[pair.second].first_outer, pair.outer_padding));
      if (near == 0) continue;
      unsigned certain = 0;
      if (pair.has_table) near = group.look_up(group.tables, i, near, &certain);
      const unsigned unsettled = openLanes(tables, group, pair, near & ~certain);
      if (unsettled != 0) certain |= certainLanes(tables, group, pair, unsettled);
      for (int l = 0; l < LANES; ++l) {
        if (certain >> l & 1u) contact[l] = i;
      }
      lanes &= ~certain;
      if ((unsettled & ~certain) != 0) open[nb_open++] = {i, unsettled & ~certain};
    }
    return nb_open;
  }

 public:
  static constexpr BatchKernel kernel(const char* name) {
    return {name, LANES, &place, &settle, &further, &centerOf};
  }
};

}  // namespace collision_pairs
