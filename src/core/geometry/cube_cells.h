// Directions classified by the cells of a cube's surface.
#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

namespace collision_pairs {

/// Each face of a cube around the origin is divided into CUBE_CELLS squared cells; a direction
/// belongs to the cell that it passes through. Directions in one cell are at most 21 degrees apart.
constexpr int CUBE_CELLS = 8;
constexpr int NUM_CUBE_CELLS = 6 * CUBE_CELLS * CUBE_CELLS;

/// `d` need not be of unit length; for any d, NaN included, the result is a valid cell.
template <class T>
int cubeCell(const Eigen::Matrix<T, 3, 1>& d) {
  using std::abs;
  int axis = abs(d[1]) > abs(d[0]) ? 1 : 0;
  if (abs(d[2]) > abs(d[axis])) axis = 2;
  const T largest = abs(d[axis]);
  const auto slot = [&](int other) {
    const T along = (d[other] / largest + T(1)) * T(0.5 * CUBE_CELLS);
    if (!(along > T(0))) return 0;  // also if NaN
    if (!(along < T(CUBE_CELLS))) return CUBE_CELLS - 1;
    // A number of more digits that is less than a border may be the border as a double.
    return std::min(static_cast<int>(static_cast<double>(along)), CUBE_CELLS - 1);
  };
  const int face = 2 * axis + (d[axis] < T(0) ? 1 : 0);
  return (face * CUBE_CELLS + slot((axis + 1) % 3)) * CUBE_CELLS + slot((axis + 2) % 3);
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
