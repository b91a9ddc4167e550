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
    for (int l = 0; l < LANES; ++l)
      bits[l] = __atomic_load_n(grid.apart + index[l], __ATOMIC_RELAXED);
    const Floats left =
        (reinterpret_cast<Floats>(*reinterpret_cast<const Ints*>(bits)) - reach) * 0.999999f;
    return Set::bits(is_inside & (left > 0.0f) & (left * left > squared));
  }

  /// Of centres that were computed.
  static Floats squaredGap(const BatchLanes& group, int a, int b) {
    const float* const from = group.centers + a * 3 * LANES;
    const float* const to = group.centers + b * 3 * LANES;
    const Floats x = load(to) - load(from), y = load(to + LANES) - load(from + LANES),
                 z = load(to + 2 * LANES) - load(from + 2 * LANES);
    return x * x + y * y + z * z;
  }

  /// Of `lanes`, in which the roots may overlap, those in which leaves of both trees do. Spheres
  /// may overlap except where they certainly do not.
  static unsigned openLanes(const BatchTables& tables, const BatchLanes& group,
                            const BatchPair& pair, unsigned lanes) {
    struct Step {
      int a, b;
      unsigned lanes;
    };
    Step stack[64];  // the two paths to leaves leave at most one step per sphere
    int depth = 0;
    stack[depth++] = {pair.first_root, pair.second_root, lanes};
    unsigned open = 0;
    while (depth > 0) {
      Step step = stack[--depth];
      step.lanes &= ~open;
      if (step.lanes == 0) continue;
      const BatchSphere &a = tables.spheres[step.a], &b = tables.spheres[step.b];
      const bool divides_a = a.rank >= b.rank;
      const BatchSphere &divided = divides_a ? a : b, &kept = divides_a ? b : a;
      const int id = divides_a ? step.b : step.a;  // of the kept one
      if (divided.first_child == 0) {
        open |= step.lanes;
        continue;
      }
      for (int child = divided.first_child; child < divided.first_child + 2; ++child) {
        centerOf(tables, group, child);
        const float reach = tables.spheres[child].radius + kept.radius + pair.outer_padding;
        const unsigned near =
            step.lanes & ~Set::bits(squaredGap(group, id, child) > Floats{} + reach * reach);
        if (near == 0) continue;
        stack[depth++] = divides_a ? Step{child, id, near} : Step{id, child, near};
      }
    }
    return open;
  }

  /// The centres of inner spheres in W, in one lane of the group; rounded as by centerOf().
  static void placeInner(const BatchInner& inner, const BatchLanes& group, int lane,
                         float (*centers)[MOST_BATCH_LANES]) {
    const float* const pose = group.poses + inner.body * 12 * LANES + lane;
    for (int row = 0; row < 3; ++row) {
      const float* const r = pose + row * LANES;
      const float x = r[0], y = r[3 * LANES], z = r[6 * LANES], p = r[9 * LANES];
      for (int i = 0; i < inner.nb; i += LANES) {
        store(x * load(inner.center[0] + i) + y * load(inner.center[1] + i) +
                  z * load(inner.center[2] + i) + p,
              centers[row] + i);
      }
    }
  }

  /// True if inner spheres overlap in the given lane. Few lanes are open at once: the lanes of
  /// this loop are the spheres of the second tree.
  static bool innerMeet(const BatchTables& tables, const BatchLanes& group, const BatchPair& pair,
                        int lane) {
    const BatchInner &first = tables.inner[pair.first], &second = tables.inner[pair.second];
    alignas(64) float a[3][MOST_BATCH_LANES], b[3][MOST_BATCH_LANES];
    placeInner(first, group, lane, a);
    placeInner(second, group, lane, b);
    for (int i = 0; i < first.nb; ++i) {
      unsigned meet = 0;
      for (int j = 0; j < second.nb; j += LANES) {
        const Floats x = load(b[0] + j) - a[0][i], y = load(b[1] + j) - a[1][i],
                     z = load(b[2] + j) - a[2][i];
        const Floats reach = first.radius[i] + load(second.radius + j) + pair.inner_padding;
        const Floats positive = reach > 0.0f ? reach : Floats{};
        meet |= Set::bits(x * x + y * y + z * z < positive * positive);
      }
      if (meet != 0) return true;
    }
    return false;
  }

  /// Of `lanes`, those in which inner spheres overlap.
  static unsigned certainLanes(const BatchTables& tables, const BatchLanes& group,
                               const BatchPair& pair, unsigned lanes) {
    unsigned certain = 0;
    for (; lanes != 0; lanes &= lanes - 1) {
      if (innerMeet(tables, group, pair, __builtin_ctz(lanes))) certain |= lanes & -lanes;
    }
    return certain;
  }

  static int settle(const BatchTables& tables, const BatchLanes& group, unsigned lanes,
                    OpenBatchPair* open, int* contact) {
    for (int i = 0; i < tables.nb_trees; ++i) centerOf(tables, group, tables.trees[i].first_outer);
    int nb_open = 0;
    for (int i = 0; i < tables.nb_pairs && lanes != 0; ++i) {
      const BatchPair& pair = tables.pairs[i];
      unsigned near = lanes & ~Set::bits(squaredGap(group, pair.first_root, pair.second_root) >
                                         Floats{} + pair.squared_reach);
      if (near == 0) continue;
      unsigned certain = 0;
      if (pair.has_table) near = group.look_up(group.tables, i, near, &certain);
      unsigned unsettled = near & ~certain;
      if (unsettled != 0) unsettled = openLanes(tables, group, pair, unsettled);
      if (unsettled != 0) certain |= certainLanes(tables, group, pair, unsettled);
      for (unsigned left = certain; left != 0; left &= left - 1) contact[__builtin_ctz(left)] = i;
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
