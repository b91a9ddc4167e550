// The closest points of two cores, once the direction of their distance or depth is known: those of
// the parts that lie in the support planes perpendicular to it.
#pragma once

#include "gjk.h"

namespace collision_pairs {

/// The point nearest to p of a core without its outermost `rim` metres, in its frame. Not for
/// hulls.
inline Eigen::Vector3d nearestPoint(const ConvexCore& core, const Eigen::Vector3d& p, double rim) {
  const Eigen::Vector3d half = (core.half.array() - rim).cwiseMax(0.0);
  Eigen::Vector3d nearest = p.cwiseMax(-half).cwiseMin(half);
  if (core.kind != ConvexCore::Kind::CYLINDER) return nearest;
  const double across = p.head<2>().squaredNorm(), radius = half[0];
  nearest.head<2>() = p.head<2>();
  if (across > radius * radius) nearest.head<2>() *= radius / std::sqrt(across);
  return nearest;
}

// The part of a core that is furthest along a direction d, as a core of its own: a corner, an edge,
// a face; of a cylinder a cap or, of rim or side, a piece that is flat to within `flat` metres, as
// three points or lines. It may include what is at a small angle to it: including too much of the
// core does no harm.
template <class T>
struct SupportPart {
  static constexpr double PARALLEL = 1e-3, ON_AXIS = 1e-6;  // radians

  /// `point`: only one point of it.
  SupportPart(const ConvexCore& whole, const Vec3<T>& d, T flat, bool point) : core(whole) {
    using Kind = ConvexCore::Kind;
    if (point) {
      center = support<T>(whole, d);
      core.kind = Kind::POINT;
    } else if (whole.kind == Kind::POINTS) {
      takeCorners(d);
    } else if (whole.curved() && d[0] * d[0] + d[1] * d[1] > T(ON_AXIS * ON_AXIS)) {
      takeArc(d, flat);
    } else {
      center = support<T>(whole, d);
      for (int i = 0; i < 3; ++i) {
        using std::abs;
        if (abs(d[i]) <= T(PARALLEL))
          center[i] = T(0);
        else
          core.half[i] = 0.0;
      }
    }
  }
  SupportPart(const SupportPart&) = delete;  // the core may refer to the points
  SupportPart& operator=(const SupportPart&) = delete;

  ConvexCore core;
  Vec3<T> center = Vec3<T>::Zero();  ///< its position in the whole core's frame

 private:
  // A few points, or the whole hull.
  void takeCorners(const Vec3<T>& d) {
    const int tip = furthestPoint<T>(core, d);
    std::size_t size = 0;
    for (int i = 0; i < core.nb_points; ++i) {
      const Vec3<T> step = (core.points[tip] - core.points[i]).template cast<T>();
      if (!(step.dot(d) <= T(PARALLEL) * step.norm())) continue;
      if (size == points_.size()) return;
      points_[size++] = core.points[i];
    }
    setPoints(size);
  }

  void takeArc(const Vec3<T>& d, T flat) {
    using std::abs;
    const T radius = T(core.half[0]);
    const double angle = radius > flat ? std::sqrt(static_cast<double>(T(2) * flat / radius)) : 0.0;
    const Vec3<T> outwards = Vec3<T>(d[0], d[1], T(0)).normalized();
    const Vec3<T> across = Vec3<T>::UnitZ().cross(outwards);
    center = support<T>(core, d);
    const bool is_side = abs(d[2]) <= T(PARALLEL);
    if (is_side) center[2] = T(0);
    std::size_t size = 0;
    for (const double turn : {-angle, 0.0, angle}) {
      const double inwards = 2.0 * std::pow(std::sin(turn / 2.0), 2);
      const Vec3<T> step = radius * (T(std::sin(turn)) * across - T(inwards) * outwards);
      for (const double end : {-core.half[2], core.half[2]}) {
        points_[size] = step.template cast<double>();
        if (is_side) points_[size][2] = end;
        if (is_side || end >= 0.0) ++size;
      }
    }
    setPoints(size);
  }

  void setPoints(std::size_t size) {
    core.kind = ConvexCore::Kind::POINTS;
    core.points = points_.data();
    core.nb_points = static_cast<int>(size);
    core.edges = nullptr;
    core.blocks = nullptr;
  }

  std::array<Eigen::Vector3d, 8> points_;
};

template <class T>
struct Witnesses {
  T apart() const { return (a - b).norm(); }

  Vec3<T> a, b;  // of A and of B, in A's frame
};

template <class T>
Witnesses<T> witnessesOf(const Simplex<T>& simplex) {
  return {simplex.combine(&DifferencePoint<T>::a), simplex.combine(&DifferencePoint<T>::b)};
}

/// The closest points of the parts in the support planes of A along n and of B along -n, computed
/// with B moved by `shift` along n. The returned points refer to B's actual pose. `flat`: an arc
/// that is no further from its chord, metres, counts as straight. `point_of_a`, `point_of_b`: use
/// only one point of its part.
template <class T>
Witnesses<T> closestOfParts(const Difference<T>& difference, const Vec3<T>& n, T shift, T flat,
                            bool point_of_a, bool point_of_b) {
  const SupportPart<T> a(difference.A, n, flat, point_of_a);
  const Vec3<T> back = -(difference.R_AB.transpose() * n);
  const SupportPart<T> b(difference.B, back, flat, point_of_b);
  const Vec3<T> p = difference.p_AB + difference.R_AB * b.center - a.center + shift * n;
  const Difference<T> parts(a.core, b.core, difference.R_AB, p);
  const GjkResult<T> found = gjk<T>(parts, -n);
  Witnesses<T> closest = witnessesOf(found.simplex);
  closest.a += a.center;
  closest.b += a.center - shift * n;
  return closest;
}

template <class T>
T residualOf(const Witnesses<T>& points, const Vec3<T>& n, T apart) {
  return (points.a - points.b + apart * n).norm();
}

/// Moves both by the same amount, so that b - a is exactly `apart` along n.
template <class T>
void setApart(const Vec3<T>& n, T apart, Witnesses<T>& points) {
  const Vec3<T> middle = (points.a + points.b) / T(2);
  const Vec3<T> half = n * (apart / T(2));
  points.a = middle - half;
  points.b = middle + half;
}

/// Witness points whose difference is not `apart` along n come from GJK, which does not notice a
/// tilt of the order of the square root of rounding, or from a polytope that is still coarse. The
/// parts in the support planes with normal n have the same closest points, which are found more
/// accurately with the planes moved onto each other, or near each other. Of a part that is nearly
/// parallel to its plane, only one point may belong to it.
template <class T>
void repairWitnesses(const Difference<T>& difference, const Vec3<T>& n, T apart, T largest_error,
                     Witnesses<T>& witnesses) {
  // The shapes are then this far apart; relative to the smaller body.
  constexpr double WITNESS_SHIFT = 0.01;
  constexpr double LONGER_ARC = 1e-11;
  const ConvexCore &A = difference.A, &B = difference.B;
  const T smaller = T(std::min(A.extent + A.radius, B.extent + B.radius));
  T best = residualOf(witnesses, n, apart);
  const auto tryParts = [&](T planes_apart, T flat, bool point_of_a, bool point_of_b) {
    if (best <= T(0.25) * largest_error) return;
    const Witnesses<T> found =
        closestOfParts(difference, n, planes_apart - apart, flat, point_of_a, point_of_b);
    const T residual = residualOf(found, n, apart);
    if (!(residual < best)) return;
    best = residual;
    witnesses = found;
  };
  // A longer arc is less accurate, and holds the point even if the normal is.
  for (const T flat : {T(512) * std::numeric_limits<T>::epsilon(), T(LONGER_ARC)}) {
    for (const T planes_apart : {T(0), T(WITNESS_SHIFT) * smaller}) {
      tryParts(planes_apart, flat * smaller, false, false);
      tryParts(planes_apart, flat * smaller, true, false);
      tryParts(planes_apart, flat * smaller, false, true);
    }
    if (!A.curved() && !B.curved()) return;
  }
}

}  // namespace collision_pairs
