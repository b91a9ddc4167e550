// The loop of furthestInBlocks(), for any width of the compiler's generic vectors. Includes nothing
// of the C++ library, so that a file compiled for newer processors leaves no code of theirs in a
// shared function.
#pragma once

#include "point_block.h"

namespace collision_pairs {

/// Index of the point furthest along `direction`; writes how far along it is. `count` >= 1.
using FurthestPointLoop = unsigned long (*)(const PointBlock* blocks, unsigned long count,
                                            const double* direction, double* height);

/// `Lanes` holds `WIDTH` doubles, 2 or 4; `Bits` as many integers of the same size.
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
  Bits found = {}, step = {};  // which of the steps gave `best`, and which one this is
  for (unsigned long i = 0; i < count; ++i) {
    for (int part = 0; part < PARTS; ++part) {
      const Lanes reach = along(blocks[i], part);
      found = reach > best ? step : found;
      best = reach > best ? reach : best;
      step += 1;
    }
  }
  int lane = 0;
  double most = best[0];
  for (int other = 1; other < WIDTH; ++other) {  // as selections: branches would be guessed wrong
    lane = best[other] > most ? other : lane;
    most = best[other] > most ? best[other] : most;
  }
  *height = most;
  return static_cast<unsigned long>(found[lane]) * WIDTH + static_cast<unsigned long>(lane);
}

}  // namespace collision_pairs
