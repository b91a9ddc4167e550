// Distance between two convex cores by GJK, with a certified interval.
//
// Gilbert, Johnson, Keerthi, "A fast procedure for computing the distance between complex objects
// in three-dimensional space" (1988). Deviation: terminates on the duality gap between the
// simplex's distance (an upper bound) and the best supporting plane (a lower bound), relative to
// the size of the Minkowski difference; no absolute tolerance.
#pragma once

#include <algorithm>
#include <limits>

#include "simplex.h"

namespace collision_pairs {

enum class GjkEnd {
  APART,    ///< lower <= distance <= |v|, and the two agree to rounding
  OVERLAP,  ///< the origin is inside, or within rounding of, the simplex
  BEYOND,   ///< lower > the given limit
  WITHIN,   ///< |v| <= `enough`
  STALLED,  ///< apart or touching, but the interval did not close
};

template <class T>
struct GjkResult {
  GjkEnd end = GjkEnd::STALLED;
  Simplex<T> simplex;
  Vec3<T> v = Vec3<T>::Zero();       ///< closest point of A - B to the origin found so far
  Vec3<T> normal = Vec3<T>::Zero();  ///< unit, A to B: of the plane that gave `lower`
  T lower = T(0);                    ///< certified lower bound of the cores' distance
  T magnitude = T(0);                ///< largest |w| encountered; rounding errors scale with it
};

/// Distance of the cores in `difference`, in its scalar type. Stops as soon as the lower bound
/// exceeds `stop_above`, or |v| is `enough` (if that is positive), or, below stop_above, the
/// interval is this share of |v|. Starts at v. Cost: a few support evaluations for polytopes, 10 to
/// 40 for cylinders.
template <class T>
GjkResult<T> gjk(const Difference<T>& difference, T stop_above, Vec3<T> v, T enough,
                 T share = T(0)) {
  constexpr int MAX_ITERATIONS = 128;
  const T epsilon = std::numeric_limits<T>::epsilon();
  GjkResult<T> result;
  Simplex<T>& simplex = result.simplex;
  T length = v.norm();
  if (!(length > T(0))) v = Vec3<T>::UnitX(), length = T(1);
  T norm = std::numeric_limits<T>::infinity();
  for (int i = 0; i < MAX_ITERATIONS; ++i) {
    const Vec3<T> direction = v / length;
    // Stored past the vertices of the simplex, which is unchanged if the search ends early.
    const int size = simplex.size + 1;
    DifferencePoint<T>& next = simplex.vertex[simplex.size];
    next = difference.furthest(Vec3<T>(-direction));
    const T bound = next.w.dot(direction);
    result.magnitude = std::max(result.magnitude, next.w.norm());
    if (i == 0 || bound > result.lower) result.normal = -direction;
    if (bound > result.lower) result.lower = bound;
    if (result.lower > stop_above) return result.end = GjkEnd::BEYOND, result;
    const T interval = norm - result.lower;
    if (interval <= T(4) * epsilon * result.magnitude ||
        (norm < stop_above && interval <= share * norm)) {
      return result.end = GjkEnd::APART, result;
    }
    const std::array<T, 4> lambda = closestCoordinates(simplex.vertex, size);
    v.setZero();
    int nb_positive = 0;
    for (int k = 0; k < size; ++k) {
      if (!(lambda[k] > T(0))) continue;
      v += lambda[k] * simplex.vertex[k].w;
      ++nb_positive;
    }
    if (nb_positive == 0) return result;
    if constexpr (!std::is_same_v<T, double>) {
      // Of a thin triangle the plane is known better than the coordinates in it.
      Simplex<T> triangle = simplex;
      reduceTo(lambda, size, triangle);
      if (nb_positive == 3) v = pointOfPlane(triangle);
    }
    length = v.norm();
    if (nb_positive == 4 || length <= T(4) * epsilon * result.magnitude) {
      // A sliver tetrahedron may appear to contain an origin that a plane has proved to be outside.
      const bool refuted = result.lower > T(8) * epsilon * result.magnitude;
      if (refuted) return result;
      reduceTo(lambda, size, simplex);
      result.v = v;
      return result.end = GjkEnd::OVERLAP, result;
    }
    if (!(length < norm)) return result;  // rounding: no further progress
    reduceTo(lambda, size, simplex);
    norm = length;
    result.v = v;
    if (length <= enough) return result.end = GjkEnd::WITHIN, result;
  }
  return result;
}

}  // namespace collision_pairs
