// Bounds how long a plane separates two moving convex bodies.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "convex_core.h"
#include "motion_state.h"

namespace collision_pairs {

/// Two elements, A and B, relative to a frame, at one configuration of a motion; expressed in W.
struct MovingPair {
  Eigen::Vector3d p_AB_W;  ///< from the centre of A's sphere to that of B's
  Twist twist_a, twist_b;
  MotionBound bound;  ///< of both together, rounded up
  /// Metres: largest error of a distance due to rounding and deviations; each alone.
  double slack = 0.0, rounding = 0.0, deviation = 0.0;
  double padding = 0.0;  ///< metres
};

// Support functions: extent of a body along m, relative to the centre of its sphere.

struct BoxSupport {
  const Eigen::Matrix3d& R_WE;
  const Eigen::Vector3d& half;
  double operator()(const Eigen::Vector3d& m_W) const {
    return (R_WE.transpose() * m_W).cwiseAbs().dot(half);
  }
};

/// Of an element's hull, enlarged by `margin`.
struct HullSupport {
  const ConvexCore& core;
  const Eigen::Matrix3d& R_WE;
  const Eigen::Vector3d& center_E;
  double margin;
  double operator()(const Eigen::Vector3d& m_W) const {
    const Eigen::Vector3d m_E = R_WE.transpose() * m_W;
    return (support<double>(core, m_E) - center_E).dot(m_E) + (core.radius + margin) * m_W.norm();
  }
};

/// Of a half-space z <= 0 that does not rotate, along its own normal; its centre is its origin.
struct PlaneSupport {
  double operator()(const Eigen::Vector3d&) const { return 0.0; }
};

/// The gap of A and B along the unit normal n of a plane that is fixed in the frame: a lower
/// bound of their distance. When the fraction has changed by s, a point p of A is no further along
/// n than  n.p + s n.v(p) + s^2 / 2 * acceleration,  where
///   n.v(p) = n.v + (n x omega).(p - center)
/// is linear in p: its maximum over A is a value of the support function, along n + s n x omega. So
/// the bound is concave in s and lies above its chords: if both ends of a segment keep a distance,
/// the whole segment does.
template <class SupportA, class SupportB>
class PlaneBound {
 public:
  /// `slack`: metres, due to rounding and to deviations along n.
  PlaneBound(const MovingPair& pair, const SupportA& a, const SupportB& b, const Eigen::Vector3d& n,
             double slack)
      : pair_(pair),
        slack_(slack),
        a_(a),
        b_(b),
        n_(n),
        tilt_a_(n.cross(pair.twist_a.omega)),
        tilt_b_(n.cross(pair.twist_b.omega)),
        speed_(n.dot(pair.twist_b.v - pair.twist_a.v)) {}

  /// Metres, padding subtracted; |s| at most the half width of the pair's bounds.
  double operator()(double s) const {
    return n_.dot(pair_.p_AB_W) + s * speed_ - a_(n_ + s * tilt_a_) - b_(-n_ - s * tilt_b_) -
           0.5 * pair_.bound.acceleration * s * s - slack_ - pair_.padding;
  }

 private:
  const MovingPair& pair_;
  const double slack_;
  const SupportA& a_;
  const SupportB& b_;
  const Eigen::Vector3d n_, tilt_a_, tilt_b_;
  const double speed_;
};

/// How far from 0 towards `end`, of either sign, a concave gap stays at least `level`; `here` is
/// gap(0) >= level. Lowers `least` to a lower bound of the gap on that segment.
template <class Gap>
double lengthAbove(const Gap& gap, double here, double level, double end, double& least) {
  if (end == 0.0) return 0.0;
  const double there = gap(end);
  if (there >= level) {
    least = std::min({least, here, there});
    return std::abs(end);
  }
  least = std::min(least, level);
  double length = 0.0, above = here;
  for (int nb_chords = 0; above > level; above = gap(length)) {
    const double along_chord = (end - length) * ((above - level) / (above - there));
    if (!(std::abs(along_chord) > 0.0)) break;  // also NaN, if the gap is not finite
    length += along_chord;
    if (++nb_chords == 2) break;
  }
  return std::abs(length);
}

}  // namespace collision_pairs
