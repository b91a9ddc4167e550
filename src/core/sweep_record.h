// The small form of a box that is sorted and swept, and the map that makes it.
#pragma once

#include <cstdint>
#include <limits>

#include <Eigen/Core>

#include "collision_pairs/aabb.h"
#include "sweep_kernel.h"

namespace collision_pairs {

/// A box in single precision, relative to the cycle's origin and grown by half the reach.
struct Record {
  float lo[3];
  std::uint32_t tag;
  float hi[3];
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
  Narrower(const Eigen::Vector3d& origin, double growth) : origin_(origin), growth_(growth) {}

  Record record(const Aabb& box, std::uint32_t tag, std::uint32_t model) const {
    return {{lo(box, 0), lo(box, 1), lo(box, 2)}, tag, {hi(box, 0), hi(box, 1), hi(box, 2)}, model};
  }

 private:
  float lo(const Aabb& box, int k) const { return narrow((box.min[k] - growth_) - origin_[k]); }
  float hi(const Aabb& box, int k) const { return narrow((box.max[k] + growth_) - origin_[k]); }
  // Clamped, as the kernels count on finite sides; NaN (a refused box) stays NaN.
  static float narrow(double x) {
    constexpr double LIMIT = std::numeric_limits<float>::max();
    x = x < -LIMIT ? -LIMIT : x;
    x = x > LIMIT ? LIMIT : x;
    return static_cast<float>(x);
  }

  Eigen::Vector3d origin_;
  double growth_;
};

/// How far apart on one axis two boxes may be, metres, if squaredReach() may still accept them:
/// alarm_distance and a margin that covers every rounding of that test.
inline double axisReach(double alarm_distance) { return alarm_distance * (1.0 + 0x1p-40) + 1e-160; }

}  // namespace collision_pairs
