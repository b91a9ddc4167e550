// The loop of PackedPoints::extent, for any width of the compiler's generic vectors. Includes
// nothing of the C++ library, so that a file compiled for newer processors leaves no code of theirs
// in a shared function.
#pragma once

#include "point_block.h"

namespace collision_pairs {

/// R is column-major. `count` is at least 1.
using ExtentLoop = void (*)(const PointBlock* blocks, unsigned long count, const double* R,
                            double* lower, double* upper);

/// `Lanes` holds `WIDTH` doubles, 2, 4 or 8.
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
  for (int row = 0; row < 3; ++row) {  // as selections: branches would be guessed wrong
    double least = low[row][0], most = high[row][0];
    for (int lane = 1; lane < WIDTH; ++lane) {
      least = low[row][lane] < least ? low[row][lane] : least;
      most = high[row][lane] > most ? high[row][lane] : most;
    }
    lower[row] = least;
    upper[row] = most;
  }
}

}  // namespace collision_pairs
