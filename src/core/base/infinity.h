// What nothing is beyond: of distances, times and bounds.
#pragma once

#include <limits>

namespace collision_pairs {

constexpr double INF = std::numeric_limits<double>::infinity();

}  // namespace collision_pairs
