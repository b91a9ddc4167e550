// The point of a simplex that is closest to the origin.
//
// Montanari, Petrinic, Barbieri, "Improving the GJK algorithm for faster and more reliable distance
// queries between convex objects" (2017): barycentric coordinates from signed volumes of
// projections on the best conditioned axis or plane. Deviation: if a volume is zero, every face is
// tried. Of what is flat but for rounding the point may be another one; convex_query.h looks.
#pragma once

#include "convex_core.h"

namespace collision_pairs {

/// One to four vertices of A - B and the barycentric coordinates of the closest point.
template <class T>
struct Simplex {
  std::array<DifferencePoint<T>, 4> vertex;
  std::array<T, 4> lambda{};
  int size = 0;

  template <class Member>
  Vec3<T> combine(Member member) const {
    Vec3<T> sum = Vec3<T>::Zero();
    for (int i = 0; i < size; ++i) sum += lambda[i] * (vertex[i].*member);
    return sum;
  }
  Vec3<T> closest() const { return combine(&DifferencePoint<T>::w); }
};

namespace simplex_detail {

template <class T>
bool sameSign(T a, T b) {
  return (a > T(0) && b > T(0)) || (a < T(0) && b < T(0));
}

template <class T>
int largestAxis(const Vec3<T>& d) {
  using std::abs;
  const int axis = abs(d[1]) > abs(d[0]) ? 1 : 0;
  return abs(d[2]) > abs(d[axis]) ? 2 : axis;
}

/// Coordinates of the closest point of the segment w0 w1.
template <class T>
std::array<T, 4> closestOnSegment(const Vec3<T>& w0, const Vec3<T>& w1) {
  const Vec3<T> edge = w1 - w0;
  const T squared = edge.squaredNorm();
  if (!(squared > T(0))) return {T(1), T(0)};
  const T t = -w0.dot(edge) / squared;
  if (t <= T(0)) return {T(1), T(0)};
  if (t >= T(1)) return {T(0), T(1)};
  return {T(1) - t, t};
}

template <class T, std::size_t N>
Vec3<T> at(const std::array<T, 4>& lambda, const std::array<Vec3<T>, N>& w) {
  Vec3<T> sum = Vec3<T>::Zero();
  for (std::size_t i = 0; i < N; ++i) sum += lambda[i] * w[i];
  return sum;
}

template <class T>
std::array<T, 4> closestOnTriangle(const std::array<Vec3<T>, 3>& w) {
  // The longest two edges give the most accurate normal, and with it the projection.
  const Vec3<T> normal = (w[1] - w[0]).cross(w[2] - w[0]);
  const T squared = normal.squaredNorm();
  std::array<T, 3> area{};
  T total(0);
  if (squared > T(0)) {
    const Vec3<T> foot = normal * (w[0].dot(normal) / squared);
    const int drop = largestAxis(normal);
    const int x = (drop + 1) % 3, y = (drop + 2) % 3;
    for (int i = 0; i < 3; ++i) {
      const Vec3<T> p = w[(i + 1) % 3] - foot, q = w[(i + 2) % 3] - foot;
      area[i] = p[x] * q[y] - p[y] * q[x];
    }
    total = normal[drop];
    if (sameSign(total, area[0]) && sameSign(total, area[1]) && sameSign(total, area[2])) {
      const T sum = area[0] + area[1] + area[2];
      return {area[0] / sum, area[1] / sum, area[2] / sum};
    }
  }
  std::array<T, 4> best{};
  T best_squared(-1);
  for (int i = 0; i < 3; ++i) {
    if (sameSign(total, area[i])) continue;
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const std::array<T, 4> edge = closestOnSegment(w[j], w[k]);
    const T distance = (edge[0] * w[j] + edge[1] * w[k]).squaredNorm();
    if (best_squared < T(0) || distance < best_squared) {
      best_squared = distance;
      best = {};
      best[j] = edge[0];
      best[k] = edge[1];
    }
  }
  return best;
}

/// The corner of a triangle opposite its longest edge, and the edges from there in its sense of
/// rotation: what is computed from them loses the fewest digits, however thin it is.
template <class T>
struct Corner {
  Corner(const Vec3<T>& p, const Vec3<T>& q, const Vec3<T>& r) {
    const T pq = (q - p).squaredNorm(), qr = (r - q).squaredNorm(), rp = (p - r).squaredNorm();
    if (qr >= pq && qr >= rp) {
      at = p, normal = (q - p).cross(r - p);
    } else if (rp >= pq) {
      at = q, normal = (r - q).cross(p - q);
    } else {
      at = r, normal = (p - r).cross(q - r);
    }
  }
  Vec3<T> at, normal;  // not of unit length
};

/// p . (q x r). Double is to be quick, what has more digits is to use them.
template <class T>
[[gnu::always_inline]] inline T volumeOf(const Vec3<T>& p, const Vec3<T>& q, const Vec3<T>& r) {
  if constexpr (std::is_same_v<T, double>) return p.dot(q.cross(r));
  const Corner<T> corner(p, q, r);
  return corner.at.dot(corner.normal);
}

template <class T>
std::array<T, 4> closestOnTetrahedron(const std::array<Vec3<T>, 4>& w) {
  // volume[i]: of the tetrahedron in which the origin replaces vertex i.
  const std::array<T, 4> volume{volumeOf(w[1], w[2], w[3]), -volumeOf(w[0], w[2], w[3]),
                                volumeOf(w[0], w[1], w[3]), -volumeOf(w[0], w[1], w[2])};
  const T total = volume[0] + volume[1] + volume[2] + volume[3];
  bool inside = true;
  for (const T v : volume) inside = inside && sameSign(total, v);
  if (inside) {
    return {volume[0] / total, volume[1] / total, volume[2] / total, volume[3] / total};
  }
  std::array<T, 4> best{};
  T best_squared(-1);
  for (int i = 0; i < 4; ++i) {
    if (sameSign(total, volume[i])) continue;
    const std::array<int, 3> id{(i + 1) % 4, (i + 2) % 4, (i + 3) % 4};
    const std::array<Vec3<T>, 3> face{w[id[0]], w[id[1]], w[id[2]]};
    const std::array<T, 4> on_face = closestOnTriangle(face);
    const T distance = at(on_face, face).squaredNorm();
    if (best_squared < T(0) || distance < best_squared) {
      best_squared = distance;
      best = {};
      for (int k = 0; k < 3; ++k) best[id[k]] = on_face[k];
    }
  }
  return best;
}

}  // namespace simplex_detail

/// Barycentric coordinates of the point closest to the origin, of the first `size` vertices. Four
/// are positive only if the origin is inside; none if rounding allows no result.
template <class T>
[[gnu::always_inline]] inline std::array<T, 4> closestCoordinates(
    const std::array<DifferencePoint<T>, 4>& v, int size) {
  using namespace simplex_detail;
  if (size == 4) {
    return closestOnTetrahedron(std::array<Vec3<T>, 4>{v[0].w, v[1].w, v[2].w, v[3].w});
  }
  if (size == 3) return closestOnTriangle(std::array<Vec3<T>, 3>{v[0].w, v[1].w, v[2].w});
  if (size == 2) return closestOnSegment(v[0].w, v[1].w);
  return {T(1)};
}

/// Drops the vertices whose coordinate is not positive.
template <class T>
[[gnu::always_inline]] inline void reduceTo(const std::array<T, 4>& lambda, int size,
                                            Simplex<T>& simplex) {
  int kept = 0;
  for (int i = 0; i < size; ++i) {
    if (!(lambda[i] > T(0))) continue;
    if (kept != i) simplex.vertex[kept] = simplex.vertex[i];
    simplex.lambda[kept++] = lambda[i];
  }
  simplex.size = kept;
}

/// The point of the plane through three vertices that is nearest to the origin.
template <class T>
Vec3<T> pointOfPlane(const Simplex<T>& simplex) {
  const auto& v = simplex.vertex;
  const simplex_detail::Corner<T> corner(v[0].w, v[1].w, v[2].w);
  return corner.normal * (corner.at.dot(corner.normal) / corner.normal.squaredNorm());
}

/// Sets the coordinates of the point closest to the origin, and drops the vertices that it does
/// not need.
template <class T>
void reduceToClosest(Simplex<T>& simplex) {
  reduceTo(closestCoordinates(simplex.vertex, simplex.size), simplex.size, simplex);
}

/// The vertices of A - B with which GJK enclosed the origin, if it did.
struct CoreOverlap {
  Simplex<double> simplex;
  double magnitude = 0.0;  ///< largest |w| encountered, metres
  bool found() const { return simplex.size > 0; }
};

}  // namespace collision_pairs
