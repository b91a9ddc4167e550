// Distance between two convex cores by GJK, with a certified interval.
//
// Gilbert, Johnson, Keerthi, "A fast procedure for computing the distance between complex objects
// in three-dimensional space" (1988). Deviation: ends on the duality gap between the simplex's
// distance (an upper bound) and the best supporting plane (a lower bound), relative to the size of
// the Minkowski difference; no absolute tolerance.
#pragma once

#include <algorithm>
#include <limits>

#include "simplex.h"

namespace collision_pairs {

enum class GjkEnd {
  APART,    ///< lower <= distance <= |v|, and the two agree to rounding
  OVERLAP,  ///< the origin is inside, or within rounding of, the simplex
  BEYOND,   ///< lower > the limit asked for
  STALLED,  ///< apart or touching, but the interval did not close
};

template <class T>
struct GjkResult {
  GjkEnd end = GjkEnd::STALLED;
  Simplex<T> simplex;
  Vec3<T> v = Vec3<T>::Zero();       ///< closest point of A - B to the origin found so far
  Vec3<T> normal = Vec3<T>::Zero();  ///< unit, A to B: of the plane that gave `lower`
  T lower = T(0);                    ///< certified lower bound of the cores' distance
  T magnitude = T(0);                ///< largest |w| seen: what rounding errors scale with
};

/// Distance of the cores in `difference`, in its scalar type. Stops as soon as the lower bound
/// exceeds stop_above. Cost: a few support evaluations for polytopes, 10 to 40 for cylinders.
template <class T>
GjkResult<T> gjk(Difference<T>& difference, T stop_above, Vec3<T> v) {
  constexpr int MAX_ITERATIONS = 128;
  const T epsilon = std::numeric_limits<T>::epsilon();
  GjkResult<T> result;
  Simplex<T>& simplex = result.simplex;
  if (!(v.squaredNorm() > T(0))) v = Vec3<T>::UnitX();
  T norm = std::numeric_limits<T>::infinity();
  for (int i = 0; i < MAX_ITERATIONS; ++i) {
    const Vec3<T> direction = v.normalized();
    const DifferencePoint<T> next = difference.furthest(Vec3<T>(-direction));
    const T bound = next.w.dot(direction);
    result.magnitude = std::max(result.magnitude, next.w.norm());
    if (i == 0 || bound > result.lower) result.normal = -direction;
    if (bound > result.lower) result.lower = bound;
    if (result.lower > stop_above) return result.end = GjkEnd::BEYOND, result;
    if (norm - result.lower <= T(4) * epsilon * result.magnitude) {
      return result.end = GjkEnd::APART, result;
    }
    const Simplex<T> before = simplex;
    simplex.vertex[simplex.size++] = next;
    reduceToClosest(simplex);
    if (simplex.size == 0) return simplex = before, result;
    v = simplex.closest();
    if (simplex.size == 4 || v.norm() <= T(4) * epsilon * result.magnitude) {
      // A sliver of a tetrahedron may seem to hold an origin that a plane has shown to be outside.
      const bool refuted = result.lower > T(8) * epsilon * result.magnitude;
      if (refuted) return simplex = before, result;
      result.v = v;
      return result.end = GjkEnd::OVERLAP, result;
    }
    if (!(v.norm() < norm)) return simplex = before, result;  // rounding: no progress left
    norm = v.norm();
    result.v = v;
  }
  return result;
}

}  // namespace collision_pairs
