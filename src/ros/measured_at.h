// When something that was received was measured.
#pragma once

#include <algorithm>

namespace collision_pairs {

/// Seconds, on the clock of the stamp. Nothing is measured after it has arrived: a stamp ahead of
/// the clock is that of a sender whose clock is ahead.
inline double measuredAt(double stamp, double arrival) { return std::min(stamp, arrival); }

}  // namespace collision_pairs
