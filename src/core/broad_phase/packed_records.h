// Boxes converted to float records, and reused memory in the layouts that the kernels read and
// write.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "collision_pairs/aabb.h"
#include "sweep_kernel.h"

namespace collision_pairs {

/// The map from boxes to records relative to `origin`, enlarged by `growth` metres on each side.
NarrowMap makeNarrowMap(const Eigen::Vector3d& origin, double growth);

/// Converts boxes to records; box i gets the tag i. `out` has room for all of them.
void narrowBoxes(const SweepKernel& kernel, const NarrowMap& map, const std::vector<Aabb>& boxes,
                 const std::uint32_t* models, Record* out);

/// The median, axis by axis, of the centres of the first, the middle and the last box: amid the
/// scene even if one of them is a half-space or far away.
Eigen::Vector3d sceneOrigin(const std::vector<Aabb>& boxes);

/// How far apart on one axis two boxes may be, metres, if squaredReach() may still accept them:
/// alarm_distance and a margin that covers every rounding of that test.
inline double axisReach(double alarm_distance) { return alarm_distance * (1.0 + 0x1p-40) + 1e-160; }

/// Records as structure of arrays, with the kernels' padding. Keeps its memory.
class PackedStorage {
 public:
  /// Makes room for n records, whose contents are undefined, and pads behind them.
  void resize(std::size_t n) {
    if (n + PADDING > stride_) {
      stride_ = n + n / 2 + PADDING;
      floats_.resize(6 * stride_);
      ints_.resize(2 * stride_);
    }
    // Infinite lower sides and negated upper sides, so that the sum with any other is infinite.
    constexpr float INF = std::numeric_limits<float>::infinity();
    for (std::size_t k = 0; k < 6; ++k) std::fill_n(floats_.data() + k * stride_ + n, PADDING, INF);
  }
  /// Where to write the records. Keep a copy in a local, which is not reloaded after each store.
  struct Writer {
    float *lo0, *lo1, *lo2, *minus_hi0, *minus_hi1, *minus_hi2;
    std::uint32_t *tag, *model;
    void operator()(std::size_t i, const Record& record) const {
      lo0[i] = record.lo[0];
      lo1[i] = record.lo[1];
      lo2[i] = record.lo[2];
      minus_hi0[i] = -record.hi[0];
      minus_hi1[i] = -record.hi[1];
      minus_hi2[i] = -record.hi[2];
      tag[i] = record.tag;
      model[i] = record.model;
    }
  };
  Writer writer() {
    float* f = floats_.data();
    const std::size_t s = stride_;
    return {f, f + s, f + 2 * s, f + 3 * s, f + 4 * s, f + 5 * s, ints_.data(), ints_.data() + s};
  }
  /// Packs boxes without tags and models.
  void pack(const SweepKernel& kernel, const NarrowMap& map, const std::vector<Aabb>& boxes);
  PackedBoxes view() const {
    const float* f = floats_.data();
    const std::size_t s = stride_;
    return {
        {f, f + s, f + 2 * s}, {f + 3 * s, f + 4 * s, f + 5 * s}, ints_.data(), ints_.data() + s};
  }

 private:
  std::size_t stride_ = 0;
  std::vector<float> floats_;
  std::vector<std::uint32_t> ints_;
};

/// Owns a candidate list that kernels fill.
class CandidateStorage {
 public:
  Candidates* clear() {
    list_.count = 0;
    list_.first = ids_.data();
    list_.second = ids_.data() + list_.capacity;
    list_.owner = this;
    list_.grow = [](Candidates* self, std::size_t room) {
      static_cast<CandidateStorage*>(self->owner)->grow(room);
    };
    return &list_;
  }
  const Candidates& list() const { return list_; }

 private:
  void grow(std::size_t room) {
    const std::size_t capacity = 2 * list_.capacity + room + 256;
    std::vector<std::uint32_t> larger(2 * capacity);
    std::copy(list_.first, list_.first + list_.count, larger.begin());
    std::copy(list_.second, list_.second + list_.count,
              larger.begin() + static_cast<std::ptrdiff_t>(capacity));
    ids_.swap(larger);
    list_.capacity = capacity;
    list_.first = ids_.data();
    list_.second = ids_.data() + capacity;
  }

  std::vector<std::uint32_t> ids_;
  Candidates list_;
};

}  // namespace collision_pairs
