// Positions of joints without limits, which may be reported within a turn.
#pragma once

#include <cmath>

namespace collision_pairs {

/// Whole turns in a jump of such a position, rad.
inline double wholeTurns(double jump) {
  constexpr double TURN = 2.0 * 3.14159265358979323846;
  return std::abs(jump) > 0.5 * TURN ? TURN * std::round(jump / TURN) : 0.0;
}

}  // namespace collision_pairs
