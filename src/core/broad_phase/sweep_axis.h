// How a set of boxes is spread along each axis, and the axis to sweep along.
#pragma once

#include <cmath>
#include <cstddef>

#include "packed_records.h"

namespace collision_pairs {

/// Of the boxes' centres: mean and standard deviation; of the boxes: mean size. Metres, per axis,
/// relative to the origin of the records. Boxes that reach further than 1e15 m on an axis
/// (half-spaces) are left out of that axis.
struct Spread {
  double mean[3] = {0, 0, 0};
  double deviation[3] = {0, 0, 0};
  double size[3] = {0, 0, 0};

  /// The range of the centres if they are uniformly distributed: sqrt(12) deviations.
  double range(int axis) const { return 3.4641016151377544 * deviation[axis]; }
  /// Approximate share of the boxes that one box overlaps on this axis alone.
  double crowd(int axis) const {
    const double all = range(axis) + size[axis];
    return all > 0.0 ? size[axis] / all : 1.0;
  }
};

/// Two passes, to avoid cancellation far from the origin. `get(i)` gives the i-th record.
template <class Get>
Spread measureSpread(Get get, std::size_t count) {
  constexpr float FAR_AWAY = 1e15f;
  Spread spread;
  double used[3] = {0, 0, 0};
  const auto counts = [](const Record& r, int k) {
    return r.lo[k] > -FAR_AWAY && r.hi[k] < FAR_AWAY && r.lo[k] <= r.hi[k];
  };
  for (std::size_t i = 0; i < count; ++i) {
    const Record record = get(i);
    for (int k = 0; k < 3; ++k) {
      if (!counts(record, k)) continue;
      used[k] += 1.0;
      spread.mean[k] += 0.5 * (double{record.lo[k]} + record.hi[k]);
      spread.size[k] += double{record.hi[k]} - record.lo[k];
    }
  }
  for (int k = 0; k < 3; ++k) {
    if (used[k] == 0.0) continue;
    spread.mean[k] /= used[k];
    spread.size[k] /= used[k];
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Record record = get(i);
    for (int k = 0; k < 3; ++k) {
      if (!counts(record, k)) continue;
      const double off = 0.5 * (double{record.lo[k]} + record.hi[k]) - spread.mean[k];
      spread.deviation[k] += off * off;
    }
  }
  for (int k = 0; k < 3; ++k) {
    if (used[k] > 0.0) spread.deviation[k] = std::sqrt(spread.deviation[k] / used[k]);
  }
  return spread;
}

/// The axis of greatest variance, except where the boxes are so long on it that each overlaps a
/// third of the others (parallel rods) and another axis prunes three times better. Costs a few
/// comparisons.
inline int sweepAxis(const Spread& spread) {
  constexpr double CROWDED = 1.0 / 3.0;
  constexpr double WORTH_IT = 1.0 / 3.0;
  int widest = 0;
  int sparsest = 0;
  for (int k = 1; k < 3; ++k) {
    if (spread.deviation[k] > spread.deviation[widest]) widest = k;
    if (spread.crowd(k) < spread.crowd(sparsest)) sparsest = k;
  }
  const double crowd = spread.crowd(widest);
  const bool bad = crowd > CROWDED && spread.crowd(sparsest) < WORTH_IT * crowd;
  return bad ? sparsest : widest;
}

}  // namespace collision_pairs
