// The loops of GeometryKernel, for any width of the compiler's generic vectors: `Lanes` holds
// `WIDTH` doubles, `Bits` as many integers of the same size. Uses nothing of the C++ library, so
// that a file compiled for newer processors puts none of their instructions into a shared inline
// function.
#pragma once

#include "geometry_kernel.h"

namespace collision_pairs {

template <class Lanes, class Bits, int WIDTH>
unsigned long furthestPointLoop(const PointBlock* blocks, unsigned long count,
                                const double* direction, double* height) {
  constexpr int PARTS = POINT_LANES / WIDTH;
  const auto along = [direction](const PointBlock& block, int part) {
    const auto load = [&](int axis) {
      return *reinterpret_cast<const Lanes*>(block.xyz[axis] + part * WIDTH);
    };
    return direction[0] * load(0) + direction[1] * load(1) + direction[2] * load(2);
  };
  Lanes best = along(blocks[0], 0);
  Bits found = {}, step = {};  // the step that gave `best`, and the current one
  for (unsigned long i = 0; i < count; ++i) {
    for (int part = 0; part < PARTS; ++part) {
      const Lanes reach = along(blocks[i], part);
      found = reach > best ? step : found;
      best = reach > best ? reach : best;
      step += 1;
    }
  }
  double most = best[0];
  long long first = found[0] * WIDTH;
  for (int lane = 1; lane < WIDTH; ++lane) {  // no branches: they would be mispredicted
    const long long index = found[lane] * WIDTH + lane;
    // The first of several equal points, for any number of lanes.
    first = best[lane] > most || (best[lane] == most && index < first) ? index : first;
    most = best[lane] > most ? best[lane] : most;
  }
  *height = most;
  return static_cast<unsigned long>(first);
}

template <class Lanes, int WIDTH>
void extentLoop(const PointBlock* blocks, unsigned long count, const double* R, double* lower,
                double* upper) {
  Lanes low[3], high[3];
  const auto along = [R](const PointBlock& block, int part, int row) {
    const auto load = [&](int axis) {
      return *reinterpret_cast<const Lanes*>(block.xyz[axis] + part * WIDTH);
    };
    return R[row] * load(0) + R[row + 3] * load(1) + R[row + 6] * load(2);
  };
  for (int row = 0; row < 3; ++row) low[row] = high[row] = along(blocks[0], 0, row);
  for (unsigned long i = 0; i < count; ++i) {
    for (int part = 0; part < POINT_LANES / WIDTH; ++part) {
      for (int row = 0; row < 3; ++row) {
        const Lanes reach = along(blocks[i], part, row);
        low[row] = reach < low[row] ? reach : low[row];
        high[row] = reach > high[row] ? reach : high[row];
      }
    }
  }
  for (int row = 0; row < 3; ++row) {  // no branches: they would be mispredicted
    double least = low[row][0], most = high[row][0];
    for (int lane = 1; lane < WIDTH; ++lane) {
      least = low[row][lane] < least ? low[row][lane] : least;
      most = high[row][lane] > most ? high[row][lane] : most;
    }
    lower[row] = least;
    upper[row] = most;
  }
}

template <class Lanes, class Bits, int WIDTH>
struct BoxGapLoop {
  static Lanes load(const double* lanes) { return *reinterpret_cast<const Lanes*>(lanes); }
  static Lanes absolute(Lanes x) {
    return reinterpret_cast<Lanes>(reinterpret_cast<Bits>(x) & 0x7fffffffffffffffLL);
  }
  static Lanes squaredExcess(Lanes apart, Lanes reach) {
    const Lanes excess = absolute(apart) - reach;
    const Lanes outside = excess > 0.0 ? excess : Lanes{};
    return outside * outside;
  }

  static void box(const BoxBlock& block, const double* R, const double* center, const double* half,
                  double* squared) {
    double columns[4][4];
    for (int j = 0; j < 4; ++j) {
      for (int i = 0; i < 3; ++i) columns[j][i] = j < 3 ? R[3 * j + i] : center[i];
    }
    boxOfColumns(block, columns, half, squared);
  }

  // columns: the box's three axes and its centre.
  static void boxOfColumns(const BoxBlock& block, const double (*columns)[4], const double* half,
                           double* squared) {
    for (int part = 0; part < BOX_LANES; part += WIDTH) {
      Lanes offset[3], along_b[3] = {}, reach_b[3] = {}, gap_a = {}, gap_b = {};
      for (int k = 0; k < 3; ++k) offset[k] = columns[3][k] - load(block.center[k] + part);
      for (int i = 0; i < 3; ++i) {  // axis i of the block's boxes
        const Lanes x = load(block.R[3 * i] + part), y = load(block.R[3 * i + 1] + part),
                    z = load(block.R[3 * i + 2] + part), half_a = load(block.half[i] + part);
        const Lanes t = x * offset[0] + y * offset[1] + z * offset[2];
        Lanes reach_a = half_a;
        for (int j = 0; j < 3; ++j) {  // axis j of the other
          const Lanes cosine = x * columns[j][0] + y * columns[j][1] + z * columns[j][2];
          reach_a += absolute(cosine) * half[j];
          reach_b[j] += absolute(cosine) * half_a;
          along_b[j] += cosine * t;
        }
        gap_a += squaredExcess(t, reach_a);
      }
      for (int j = 0; j < 3; ++j) gap_b += squaredExcess(along_b[j], reach_b[j] + half[j]);
      *reinterpret_cast<Lanes*>(squared + part) = gap_a > gap_b ? gap_a : gap_b;
    }
  }

  // X: 4 by 4, column by column. Moved here and not before the call, because here it takes a few
  // operations on four lanes.
  static void movedBox(const BoxBlock& block, const BoxBlock& other, int lane, const double* X,
                       double* squared) {
    double columns[4][4], half[3];  // the box's axes and its centre, moved
    for (int j = 0; j < 4; ++j) {
      const double(*column)[BOX_LANES] = j < 3 ? other.R + 3 * j : other.center;
      const double x = column[0][lane], y = column[1][lane], z = column[2][lane];
      for (int i = 0; i < 4; ++i) {
        columns[j][i] = X[i] * x + X[4 + i] * y + X[8 + i] * z + (j < 3 ? 0.0 : X[12 + i]);
      }
    }
    for (int i = 0; i < 3; ++i) half[i] = other.half[i][lane];
    boxOfColumns(block, columns, half, squared);
  }

  static void point(const BoxBlock& block, const double* point, double* squared) {
    for (int part = 0; part < BOX_LANES; part += WIDTH) {
      Lanes offset[3], gap = {};
      for (int k = 0; k < 3; ++k) offset[k] = point[k] - load(block.center[k] + part);
      for (int i = 0; i < 3; ++i) {
        const Lanes t = load(block.R[3 * i] + part) * offset[0] +
                        load(block.R[3 * i + 1] + part) * offset[1] +
                        load(block.R[3 * i + 2] + part) * offset[2];
        gap += squaredExcess(t, load(block.half[i] + part));
      }
      *reinterpret_cast<Lanes*>(squared + part) = gap;
    }
  }
};

/// A block has four boxes, so no loop over them is wider.
template <class Lanes, class Bits, int WIDTH>
constexpr GeometryKernel geometryKernel(const char* name) {
  using Boxes = BoxGapLoop<Lanes, Bits, WIDTH>;
  return {name,
          &furthestPointLoop<Lanes, Bits, WIDTH>,
          &extentLoop<Lanes, WIDTH>,
          &Boxes::box,
          &Boxes::movedBox,
          &Boxes::point};
}

}  // namespace collision_pairs
