// The distance of two convex shapes in 100 digits, without FCL and without the code under test.
//
// The point of A - B nearest the origin is found by Wolfe's method: of at most four points of A -
// B, every subset is tried for the one whose span is nearest. Every step leaves two proofs: |v| of
// a point v of A - B bounds the distance from above, the support plane across v from below.
// Polytopes end exactly, cylinders when the bounds have closed.
#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>

#include "signed_distance_oracle.h"

namespace collision_pairs {

using Digits = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<100>,
                                             boost::multiprecision::et_off>;

/// Of the signed distance if the two are apart. In contact upper <= 0, and |upper| is not the
/// depth.
struct DistanceInterval {
  Digits lower, upper;
  bool touches() const { return upper <= 0; }
};

class ExactDistance {
 public:
  using V = V3<Digits>;

  /// `tolerance` in metres: what the interval of curved shapes has to close to.
  static DistanceInterval of(const OracleBody& A, const OracleBody& B,
                             const Eigen::Isometry3d& X_AB, const Digits& tolerance) {
    return ExactDistance(A, B, X_AB, tolerance).run();
  }

 private:
  ExactDistance(const OracleBody& A, const OracleBody& B, const Eigen::Isometry3d& X_AB,
                const Digits& tolerance)
      : A_(A), B_(B), p_AB_(cast<Digits>(X_AB.translation())), tolerance_(tolerance) {
    for (int i = 0; i < 3; ++i) column_[i] = cast<Digits>(X_AB.linear().col(i));
  }

  DistanceInterval run() {
    const Digits radii = radiusOf(A_) + radiusOf(B_);
    Digits lower = 0, upper = 1e300;
    V v = p_AB_;
    if (length(v) == 0) v = {Digits(1), Digits(0), Digits(0)};
    std::vector<V> points;
    for (int i = 0; i < 500; ++i) {
      const Digits size = length(v);
      const V w = furthest({-v[0], -v[1], -v[2]});
      lower = std::max(lower, Digits(dot(w, v) / size));
      if (upper - lower <= tolerance_) break;
      points.push_back(w);
      reduce(points, v);
      const Digits found = length(v);
      // Four points that enclose the origin; or it lies on them, to 80 digits.
      if (points.size() == 4 || found <= Digits(1e-80) * length(w)) return {-radii, -radii};
      if (found >= upper) break;
      upper = found;
    }
    return {lower - radii, upper - radii};
  }

  static Digits radiusOf(const OracleBody& body) {
    if (const auto* sphere = std::get_if<Sphere>(&body.shape)) return sphere->radius;
    if (const auto* capsule = std::get_if<Capsule>(&body.shape)) return capsule->radius;
    return 0;
  }

  // A point furthest along n; own frame.
  static V support(const OracleBody& body, const V& n) {
    const auto signedHalf = [&](double size, int i) {
      return n[i] < 0 ? Digits(-Digits(size) / 2) : Digits(Digits(size) / 2);
    };
    if (const auto* box = std::get_if<Box>(&body.shape)) {
      return {signedHalf(box->size[0], 0), signedHalf(box->size[1], 1),
              signedHalf(box->size[2], 2)};
    }
    if (std::holds_alternative<Sphere>(body.shape)) return {Digits(0), Digits(0), Digits(0)};
    if (const auto* c = std::get_if<Capsule>(&body.shape)) {
      return {Digits(0), Digits(0), signedHalf(c->length, 2)};
    }
    if (const auto* c = std::get_if<Cylinder>(&body.shape)) {
      const Digits across = sqrt(Digits(n[0] * n[0] + n[1] * n[1]));
      const Digits scale = across > 0 ? Digits(c->radius / across) : Digits(0);
      return {scale * n[0], scale * n[1], signedHalf(c->length, 2)};
    }
    std::size_t best = 0;
    Digits highest = dot(cast<Digits>(body.vertices[0]), n);
    for (std::size_t i = 1; i < body.vertices.size(); ++i) {
      const Digits height = dot(cast<Digits>(body.vertices[i]), n);
      if (height > highest) highest = height, best = i;
    }
    return cast<Digits>(body.vertices[best]);
  }

  V furthest(const V& n) const {
    V back;
    for (int i = 0; i < 3; ++i) back[i] = -dot(column_[i], n);
    const V a = support(A_, n), b = support(B_, back);
    V w;
    for (int i = 0; i < 3; ++i) {
      w[i] = a[i] - p_AB_[i] - column_[0][i] * b[0] - column_[1][i] * b[1] - column_[2][i] * b[2];
    }
    return w;
  }

  // Of all subsets, the one whose span is nearest the origin at weights that are all positive.
  static void reduce(std::vector<V>& points, V& v) {
    const std::size_t size = points.size();
    Digits best = -1;
    std::vector<V> kept;
    for (unsigned mask = 1; mask < (1u << size); ++mask) {
      std::vector<V> subset;
      for (std::size_t i = 0; i < size; ++i) {
        if (mask & (1u << i)) subset.push_back(points[i]);
      }
      V nearest;
      if (!nearestOfSpan(subset, nearest)) continue;
      const Digits squared = dot(nearest, nearest);
      if (best < 0 || squared < best) best = squared, v = nearest, kept = subset;
    }
    points = kept;
  }

  // By the equations for the weights of the others relative to the last point: their Gram matrix.
  static bool nearestOfSpan(const std::vector<V>& p, V& nearest) {
    const std::size_t n = p.size() - 1;
    const V& last = p[n];
    std::vector<V> edge(n);
    std::vector<std::vector<Digits>> m(n, std::vector<Digits>(n + 1));
    for (std::size_t i = 0; i < n; ++i) {
      for (int k = 0; k < 3; ++k) edge[i][k] = p[i][k] - last[k];
    }
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) m[i][j] = dot(edge[i], edge[j]);
      m[i][n] = -dot(edge[i], last);
    }
    if (!solve(m)) return false;
    Digits rest = 1;
    nearest = last;
    for (std::size_t i = 0; i < n; ++i) {
      if (m[i][n] <= 0) return false;
      rest -= m[i][n];
      for (int k = 0; k < 3; ++k) nearest[k] += m[i][n] * edge[i][k];
    }
    return rest > 0 || n == 0;
  }

  // Gauss and Jordan with the largest pivot; false if singular to 60 digits.
  static bool solve(std::vector<std::vector<Digits>>& m) {
    const std::size_t n = m.size();
    Digits largest = 0;
    for (const auto& row : m) {
      for (std::size_t k = 0; k < n; ++k) largest = std::max(largest, Digits(abs(row[k])));
    }
    for (std::size_t c = 0; c < n; ++c) {
      std::size_t pivot = c;
      for (std::size_t r = c; r < n; ++r) {
        if (abs(m[r][c]) > abs(m[pivot][c])) pivot = r;
      }
      if (abs(m[pivot][c]) <= largest * Digits(1e-60)) return false;
      std::swap(m[c], m[pivot]);
      for (std::size_t r = 0; r < n; ++r) {
        if (r == c) continue;
        const Digits factor = m[r][c] / m[c][c];
        for (std::size_t k = c; k <= n; ++k) m[r][k] -= factor * m[c][k];
      }
    }
    for (std::size_t c = 0; c < n; ++c) m[c][n] /= m[c][c];
    return true;
  }

  const OracleBody& A_;
  const OracleBody& B_;
  std::array<V, 3> column_;
  V p_AB_;
  Digits tolerance_;
};

/// The depth of two overlapping polytopes: the smallest height over all directions in which it can
/// be, which are the normals of faces and those across an edge of each, from the vertices. In long
/// double first, then in all digits what is within 1e-9 of the smallest.
inline Digits exactDepth(const OracleBody& A, const OracleBody& B, const Eigen::Isometry3d& X_AB) {
  using V = V3<Digits>;
  const auto cross = [](const V& a, const V& b) {
    return V{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  const auto minus = [](const V& a, const V& b) {
    return V{a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  };
  std::array<V, 3> column;
  for (int i = 0; i < 3; ++i) column[i] = cast<Digits>(X_AB.linear().col(i));
  const auto inA = [&](const V& b) {
    V a;
    for (int i = 0; i < 3; ++i)
      a[i] = column[0][i] * b[0] + column[1][i] * b[1] + column[2][i] * b[2];
    return a;
  };
  std::vector<V> directions, edges[2];
  int side = 0;
  for (const OracleBody* body : {&A, &B}) {
    auto& own = edges[side];
    if (std::holds_alternative<Box>(body->shape)) {
      for (int i = 0; i < 3; ++i) own.push_back(cast<Digits>(Eigen::Vector3d::Unit(i)));
    }
    for (const auto& [i, j] : body->edge_ends) {
      own.push_back(minus(cast<Digits>(body->vertices[j]), cast<Digits>(body->vertices[i])));
    }
    if (side == 1) std::transform(own.begin(), own.end(), own.begin(), inA);
    for (std::size_t i = 0; i < own.size(); i += 3) {
      for (std::size_t k = 0; k < 3; ++k)
        directions.push_back(cross(own[i + k], own[i + (k + 1) % 3]));
    }
    ++side;
  }
  for (const V& a : edges[0]) {
    for (const V& b : edges[1]) directions.push_back(cross(a, b));
  }
  std::vector<std::pair<long double, V>> candidates;
  long double least = 1e300L, size = 0.0L;
  for (V n : directions) {
    const Digits norm = length(n);
    if (norm == 0) continue;
    for (Digits& x : n) x /= norm;
    for (int sign = 0; sign < 2; ++sign) {
      const V3<long double> rough{n[0].convert_to<long double>(), n[1].convert_to<long double>(),
                                  n[2].convert_to<long double>()};
      const long double h = height<long double>(A, B, X_AB, rough);
      least = std::min(least, h);
      size = std::max(size, h);
      candidates.emplace_back(h, n);
      for (Digits& x : n) x = -x;
    }
  }
  Digits depth = 1e300;
  for (const auto& [h, n] : candidates) {
    if (h > least + 1e-9L * (std::abs(least) + 1e-6L * size)) continue;
    depth = std::min(depth, height<Digits>(A, B, X_AB, n));
  }
  return depth;
}

}  // namespace collision_pairs
