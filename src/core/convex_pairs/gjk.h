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

/// When a search may end before its interval has closed to rounding.
template <class T>
struct GjkLimits {
  T stop_above = std::numeric_limits<T>::infinity();  ///< at a lower bound larger than this
  T enough = T(0);                                    ///< at a |v| of no more, if positive
  T share = T(0);   ///< below stop_above, at an interval of this share of |v|
  T narrow = T(0);  ///< at an interval of this, metres
};

/// Distance of the cores in `difference`, in its scalar type. Starts at result.v, with the simplex
/// where an earlier search has left one. Cost: a few support evaluations for polytopes, 10 to 40
/// for cylinders.
template <class T>
void advance(const Difference<T>& difference, const GjkLimits<T>& limits, GjkResult<T>& result) {
  constexpr int MAX_ITERATIONS = 128;
  const T epsilon = std::numeric_limits<T>::epsilon();
  Simplex<T>& simplex = result.simplex;
  Vec3<T> v = result.v;
  T length = v.norm();
  T norm = simplex.size > 0 ? length : std::numeric_limits<T>::infinity();
  if (!(length > T(0))) v = Vec3<T>::UnitX(), length = T(1);
  for (int i = 0; i < MAX_ITERATIONS; ++i) {
    const Vec3<T> direction = v / length;
    // Stored past the vertices of the simplex, which is unchanged if the search ends early.
    const int size = simplex.size + 1;
    DifferencePoint<T>& next = simplex.vertex[simplex.size];
    next = difference.furthest(Vec3<T>(-direction));
    const T bound = next.w.dot(direction);
    result.magnitude = std::max(result.magnitude, next.w.norm());
    if (size == 1 || bound > result.lower) result.normal = -direction;
    if (bound > result.lower) result.lower = bound;
    if (result.lower > limits.stop_above) return void(result.end = GjkEnd::BEYOND);
    const T interval = norm - result.lower;
    if (interval <= std::max(T(4) * epsilon * result.magnitude, limits.narrow) ||
        (norm < limits.stop_above && interval <= limits.share * norm)) {
      return void(result.end = GjkEnd::APART);
    }
    const std::array<T, 4> lambda = closestCoordinates(simplex.vertex, size);
    v.setZero();
    int nb_positive = 0;
    for (int k = 0; k < size; ++k) {
      if (!(lambda[k] > T(0))) continue;
      v += lambda[k] * simplex.vertex[k].w;
      ++nb_positive;
    }
    if (nb_positive == 0) return void(result.end = GjkEnd::STALLED);
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
      if (refuted) return void(result.end = GjkEnd::STALLED);
      reduceTo(lambda, size, simplex);
      result.v = v;
      return void(result.end = GjkEnd::OVERLAP);
    }
    if (!(length < norm)) return void(result.end = GjkEnd::STALLED);  // no further progress
    reduceTo(lambda, size, simplex);
    norm = length;
    result.v = v;
    if (length <= limits.enough) return void(result.end = GjkEnd::WITHIN);
  }
  result.end = GjkEnd::STALLED;
}

/// The same from v.
template <class T>
GjkResult<T> gjk(const Difference<T>& difference, const Vec3<T>& v,
                 const GjkLimits<T>& limits = {}) {
  GjkResult<T> result;
  result.v = v;
  advance(difference, limits, result);
  return result;
}

/// True if the origin is inside by more than rounding of the vertices can explain, judged by the
/// volumes of the four tetrahedra that it forms with the faces. With vertices no longer than L and
/// no further off than 7.2 u m, a volume w . (w x w) is off by 22 u m L^2 for the vertices and 12 u
/// L^3 for its own arithmetic. `rounding`: 20 u m.
template <class T>
bool isInside(const GjkResult<T>& found, T rounding) {
  if (found.simplex.size != 4) return false;
  using std::abs;
  const auto& v = found.simplex.vertex;
  const T volume = abs((v[1].w - v[0].w).dot((v[2].w - v[0].w).cross(v[3].w - v[0].w)));
  const auto& lambda = found.simplex.lambda;
  const T least = *std::min_element(lambda.begin(), lambda.end());
  return least * volume > T(4) * rounding * found.magnitude * found.magnitude;
}

}  // namespace collision_pairs
