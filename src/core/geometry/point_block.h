// Points as structure of arrays. Includes nothing of the C++ library: files that are compiled for
// newer processors include it.
#pragma once

namespace collision_pairs {

constexpr int POINT_LANES = 8;  // of the widest processors: a block fits all

struct alignas(POINT_LANES * sizeof(double)) PointBlock {
  double xyz[3][POINT_LANES];
};

}  // namespace collision_pairs
