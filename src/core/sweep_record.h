// The small form of a box that is sorted and swept, and the map that makes it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

#include <Eigen/Core>

#include "collision_pairs/aabb.h"
#include "sweep_kernel.h"

namespace collision_pairs {

/// A box in single precision, relative to the cycle's origin and grown by half the reach.
struct Record {
  float lo[3];
  float hi[3];
  std::uint32_t tag;
  std::uint32_t model;
};

/// Narrows boxes to records. Each step (grow, subtract the origin, round to float) is a monotone
/// map, and both ends of all intervals go through the same ones. So b.min - reach <= a.max in
/// exact arithmetic leads to lo(b) <= hi(a) after all roundings: there is no rounding error to
/// add up, at any distance from the origin; a far one costs sharpness only. The other way round,
/// lo(b) < hi(a) says b.min - reach < a.max; for an alarm distance of 0, whose reach of 1e-160 m
/// is far below what float tells apart, it says b.min <= a.max.
class Narrower {
 public:
  /// Grows each box by `growth` metres to each side.
  Narrower(const Eigen::Vector3d& origin, double growth)
      : grow_{{-growth, -growth}, {-growth, growth}, {growth, growth}},
        origin_{{origin[0], origin[1]}, {origin[2], origin[0]}, {origin[1], origin[2]}} {}

  Record record(const Aabb& box, std::uint32_t tag, std::uint32_t model) const {
    static_assert(sizeof(Aabb) == 3 * sizeof(Doubles2) && offsetof(Record, hi) == 12,
                  "min and max, lo and hi follow one another");
    // Clamped, as the kernels count on finite sides; NaN (a refused box) stays NaN.
    const Doubles2 limit = {std::numeric_limits<float>::max(), std::numeric_limits<float>::max()};
    const char* from = reinterpret_cast<const char*>(&box);
    Record record;
    char* to = reinterpret_cast<char*>(&record);
    for (std::size_t i = 0; i < 3; ++i) {
      Doubles2 sides;
      std::memcpy(&sides, from + i * sizeof sides, sizeof sides);
      sides = (sides + grow_[i]) - origin_[i];
      sides = sides < -limit ? -limit : sides;
      sides = sides > limit ? limit : sides;
      const Floats2 narrow = __builtin_convertvector(sides, Floats2);
      std::memcpy(to + i * sizeof narrow, &narrow, sizeof narrow);
    }
    record.tag = tag;
    record.model = model;
    return record;
  }

 private:
  typedef double Doubles2 __attribute__((vector_size(16)));
  typedef float Floats2 __attribute__((vector_size(8)));
  Doubles2 grow_[3], origin_[3];
};

/// How far apart on one axis two boxes may be, metres, if squaredReach() may still accept them:
/// alarm_distance and a margin that covers every rounding of that test.
inline double axisReach(double alarm_distance) { return alarm_distance * (1.0 + 0x1p-40) + 1e-160; }

}  // namespace collision_pairs
