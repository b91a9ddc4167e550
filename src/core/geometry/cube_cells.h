// Directions classified by the cells of a cube's surface.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Core>

namespace collision_pairs {

/// Each face of a cube around the origin is divided into CUBE_CELLS squared cells; a direction
/// belongs to the cell that it passes through. Directions in one cell are at most 11 degrees apart.
constexpr int CUBE_CELLS = 16;
constexpr int NUM_CUBE_CELLS = 6 * CUBE_CELLS * CUBE_CELLS;

/// `d` need not be of unit length; for any d, NaN included, the result is a valid cell.
template <class T>
[[gnu::always_inline]] inline int cubeCell(const Eigen::Matrix<T, 3, 1>& d) {
  using std::abs;
  const T x = abs(d[0]), y = abs(d[1]), z = abs(d[2]);
  int axis = y > x ? 1 : 0;
  if (z > (y > x ? y : x)) axis = 2;
  constexpr std::array<int, 4> AFTER{1, 2, 0, 1};
  const T scale = T(0.5 * CUBE_CELLS) / abs(d[axis]);
  const auto slot = [&](int other) {
    // The order of arguments matters if it is NaN. A number of more digits that is less than a
    // border may be the border as a double.
    const auto along = static_cast<double>(d[other] * scale + T(0.5 * CUBE_CELLS));
    return static_cast<int>(std::min(std::max(0.0, along), CUBE_CELLS - 0.5));
  };
  const int face = 2 * axis + (d[axis] < T(0) ? 1 : 0);
  return (face * CUBE_CELLS + slot(AFTER[axis])) * CUBE_CELLS + slot(AFTER[axis + 1]);
}

/// The direction through the middle of a cell; not of unit length.
inline Eigen::Vector3d cubeCellCenter(int cell) {
  const int face = cell / (CUBE_CELLS * CUBE_CELLS);
  const auto middle = [](int slot) { return (slot + 0.5) / (0.5 * CUBE_CELLS) - 1.0; };
  Eigen::Vector3d d;
  d[face / 2] = face % 2 == 0 ? 1.0 : -1.0;
  d[(face / 2 + 1) % 3] = middle(cell / CUBE_CELLS % CUBE_CELLS);
  d[(face / 2 + 2) % 3] = middle(cell % CUBE_CELLS);
  return d;
}

}  // namespace collision_pairs
