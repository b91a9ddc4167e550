// What a simulation judges with: poses in the plane and distances of balls. Shares no code with
// what it judges.
#pragma once

#include <algorithm>
#include <cmath>

namespace simulation {

constexpr double ROUNDING = 1e-6;  // m, or s

/// Turned about z.
struct Pose {
  double x = 0.0, y = 0.0, z = 0.0, yaw = 0.0;
};

/// In a frame's parent, or in another one that is fixed to that.
struct Said : Pose {
  bool is_rehung = false;
};

inline Pose operator*(const Pose& a, const Pose& b) {
  const double c = std::cos(a.yaw), s = std::sin(a.yaw);
  return {a.x + c * b.x - s * b.y, a.y + s * b.x + c * b.y, a.z + b.z, a.yaw + b.yaw};
}

inline Pose inverse(const Pose& a) {
  const double c = std::cos(a.yaw), s = std::sin(a.yaw);
  return {-c * a.x - s * a.y, s * a.x - c * a.y, -a.z, -a.yaw};
}

/// On the straight line, turning the shorter way round.
inline Pose between(const Pose& a, const Pose& b, double share) {
  const double turn = std::remainder(b.yaw - a.yaw, 2.0 * M_PI);
  return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), a.z + share * (b.z - a.z),
          a.yaw + share * turn};
}

inline double metresOf(const Pose& a, const Pose& b) {
  return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}
inline double radiansOf(const Pose& a, const Pose& b) {
  return std::abs(std::remainder(b.yaw - a.yaw, 2.0 * M_PI));
}
/// Metres, or radians where these are more.
inline double distanceOf(const Pose& a, const Pose& b) {
  return std::max(metresOf(a, b), radiansOf(a, b));
}

/// A ball, or an upright box with half edges.
struct Solid {
  bool is_box = false;
  double radius = 0.0;
  double half[3] = {0.0, 0.0, 0.0};
};

/// Of two balls, or a ball and a box, each at its pose: not more than their distance where they
/// are apart, negative where they overlap.
inline double distance(const Solid& a, const Pose& at_a, const Solid& b, const Pose& at_b) {
  if (a.is_box) return distance(b, at_b, a, at_a);
  if (!b.is_box) {
    return std::hypot(at_a.x - at_b.x, at_a.y - at_b.y, at_a.z - at_b.z) - a.radius - b.radius;
  }
  const Pose center = inverse(at_b) * Pose{at_a.x, at_a.y, at_a.z, 0.0};
  const double out[] = {std::max(0.0, std::abs(center.x) - b.half[0]),
                        std::max(0.0, std::abs(center.y) - b.half[1]),
                        std::max(0.0, std::abs(center.z) - b.half[2])};
  return std::hypot(out[0], out[1], out[2]) - a.radius;
}

}  // namespace simulation
