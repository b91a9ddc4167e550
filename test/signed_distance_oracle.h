// What the signed distance of two convex shapes truly is, found without FCL and without the code
// under test.
//
// Apart: weak duality, in 50-digit arithmetic. A unit normal n proves that the shapes are at least
// -height(n) apart; two points, one in each shape, prove that they are at most that far apart.
// Overlapping: the depth is the smallest height(n) over all directions n, found by trying every
// direction in which two polytopes can have it, every circle of directions on which the height of
// a round shape has a kink, and descent from the best of a sphere of directions.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>
#include <boost/multiprecision/cpp_bin_float.hpp>

#include "collision_pairs/narrow_phase.h"

namespace collision_pairs {

using Exact = boost::multiprecision::cpp_bin_float_50;
template <class T>
using V3 = std::array<T, 3>;

template <class T>
V3<T> cast(const Eigen::Vector3d& v) {
  return {T(v[0]), T(v[1]), T(v[2])};
}
template <class T>
T dot(const V3<T>& a, const V3<T>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class T>
T length(const V3<T>& a) {
  using std::sqrt;
  return sqrt(dot(a, a));
}

/// A convex shape with the directions that matter to its support function.
struct OracleBody {
  Shape shape;
  std::vector<Eigen::Vector3d> vertices;  ///< of a Convex
  std::vector<Eigen::Vector3d> normals;   ///< outward, of its flat faces
  std::vector<Eigen::Vector3d> edges;     ///< directions of its straight edges, and its axis
  bool round = false;
  std::vector<std::pair<std::size_t, std::size_t>> edge_ends;  ///< of a Convex: three of each face
};

/// Faces and edges of a hull by trying all triples of its (few) vertices.
inline void enumerateFaces(OracleBody& body) {
  const auto& v = body.vertices;
  double size = 0.0;
  for (const Eigen::Vector3d& p : v) size = std::max(size, (p - v[0]).norm());
  const double flat = 1e-13 * size;
  for (std::size_t i = 0; i < v.size(); ++i) {
    for (std::size_t j = i + 1; j < v.size(); ++j) {
      for (std::size_t k = j + 1; k < v.size(); ++k) {
        Eigen::Vector3d n = (v[j] - v[i]).cross(v[k] - v[i]);
        if (n.norm() < 1e-12 * size * size) continue;
        n.normalize();
        double low = 0.0, high = 0.0;
        for (const Eigen::Vector3d& p : v) {
          low = std::min(low, n.dot(p - v[i]));
          high = std::max(high, n.dot(p - v[i]));
        }
        if (high > flat && low < -flat) continue;
        body.normals.push_back(high > flat ? Eigen::Vector3d(-n) : n);
        for (const auto& [from, to] : {std::pair(i, j), std::pair(j, k), std::pair(k, i)}) {
          body.edges.push_back((v[to] - v[from]).normalized());
          body.edge_ends.emplace_back(from, to);
        }
      }
    }
  }
}

inline OracleBody oracleBody(const Shape& shape) {
  OracleBody body{shape, {}, {}, {}, false, {}};
  const Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  if (std::holds_alternative<Box>(shape)) {
    for (int i = 0; i < 3; ++i) {
      body.normals.push_back(axes.col(i));
      body.edges.push_back(axes.col(i));
    }
  } else if (const auto* convex = std::get_if<Convex>(&shape)) {
    body.vertices = convex->mesh->vertices;
    enumerateFaces(body);
  } else {
    body.round = true;
    body.edges.push_back(axes.col(2));
    body.normals.push_back(axes.col(2));
  }
  return body;
}

/// How far the shape reaches along n, in its own frame; n need not be of unit length.
template <class T>
T reach(const OracleBody& body, const V3<T>& n) {
  using std::abs;
  using std::sqrt;
  if (const auto* box = std::get_if<Box>(&body.shape)) {
    T sum(0);
    for (int i = 0; i < 3; ++i) sum += T(box->size[i]) / 2 * abs(n[i]);
    return sum;
  }
  if (const auto* sphere = std::get_if<Sphere>(&body.shape)) return T(sphere->radius) * length(n);
  if (const auto* c = std::get_if<Cylinder>(&body.shape)) {
    return T(c->radius) * sqrt(T(n[0] * n[0] + n[1] * n[1])) + T(c->length) / 2 * abs(n[2]);
  }
  if (const auto* c = std::get_if<Capsule>(&body.shape)) {
    return T(c->radius) * length(n) + T(c->length) / 2 * abs(n[2]);
  }
  T best = dot(cast<T>(body.vertices[0]), n);
  for (const Eigen::Vector3d& v : body.vertices) best = std::max(best, T(dot(cast<T>(v), n)));
  return best;
}

/// How far B must move along n to be apart from A, over the length of n; A's frame.
template <class T>
T height(const OracleBody& A, const OracleBody& B, const Eigen::Isometry3d& X_AB, const V3<T>& n) {
  V3<T> back;
  for (int i = 0; i < 3; ++i) back[i] = -dot(cast<T>(X_AB.linear().col(i)), n);
  const T sum = reach(A, n) + reach(B, back) - dot(cast<T>(X_AB.translation()), n);
  return sum / length(n);
}

/// How far outside the shape the point p is; own frame. At most that: for a Convex the largest
/// height over a face.
template <class T>
T outside(const OracleBody& body, const V3<T>& p) {
  using std::abs;
  using std::sqrt;
  const auto over = [](const T& x) { return x > T(0) ? x : T(0); };
  if (const auto* box = std::get_if<Box>(&body.shape)) {
    V3<T> beyond;
    for (int i = 0; i < 3; ++i) beyond[i] = over(T(abs(p[i]) - T(box->size[i]) / 2));
    return length(beyond);
  }
  if (const auto* sphere = std::get_if<Sphere>(&body.shape)) {
    return over(T(length(p) - T(sphere->radius)));
  }
  const T rho = sqrt(T(p[0] * p[0] + p[1] * p[1]));
  if (const auto* c = std::get_if<Cylinder>(&body.shape)) {
    return length(V3<T>{over(T(rho - T(c->radius))), over(T(abs(p[2]) - T(c->length) / 2)), T(0)});
  }
  if (const auto* c = std::get_if<Capsule>(&body.shape)) {
    const T z = over(T(abs(p[2]) - T(c->length) / 2));
    return over(T(length(V3<T>{rho, z, T(0)}) - T(c->radius)));
  }
  T worst(0);
  for (const Eigen::Vector3d& n : body.normals) {
    worst = std::max(worst, T(dot(cast<T>(n), p) - reach(body, cast<T>(n))));
  }
  return worst;
}

class DepthSearch {
 public:
  DepthSearch(const OracleBody& A, const OracleBody& B, const Eigen::Isometry3d& X_AB)
      : A_(A), B_(B), X_AB_(X_AB) {}

  /// The smallest height over all directions: the depth if positive, else minus a lower bound of
  /// the distance. In long double.
  long double run() {
    tryCorners();
    if (A_.round || B_.round) {
      tryCircles();
      descend();
    }
    return best_;
  }

 private:
  using L = long double;

  L at(const Eigen::Vector3d& n) {
    const L h = height<L>(A_, B_, X_AB_, cast<L>(n));
    if (h < best_) best_ = h;
    return h;
  }
  void tryBoth(const Eigen::Vector3d& n) {
    if (n.norm() < 1e-9) return;
    at(n.normalized());
    at(-n.normalized());
    corners_.push_back(n.normalized());
    corners_.push_back(-n.normalized());
  }
  void tryCorners() {
    for (const auto& n : A_.normals) tryBoth(n);
    for (const auto& n : B_.normals) tryBoth(X_AB_.linear() * n);
    for (const auto& a : A_.edges) {
      for (const auto& b : B_.edges) tryBoth(a.cross(X_AB_.linear() * b));
    }
    if (!X_AB_.translation().isZero(0.0)) tryBoth(X_AB_.translation().stableNormalized());
  }
  void tryCircles() {
    for (const auto& e : A_.edges) tryCircle(e);
    for (const auto& e : B_.edges) tryCircle(X_AB_.linear() * e);
  }
  // Golden section around each dip of 90 samples.
  void tryCircle(const Eigen::Vector3d& axis) {
    constexpr int SAMPLES = 90;
    const Eigen::Vector3d u = axis.unitOrthogonal(), v = axis.cross(u);
    const double step = 2.0 * M_PI / SAMPLES;
    const auto on = [&](double t) { return at(std::cos(t) * u + std::sin(t) * v); };
    std::array<L, SAMPLES> h;
    for (int i = 0; i < SAMPLES; ++i) h[i] = on(i * step);
    for (int i = 0; i < SAMPLES; ++i) {
      if (h[i] > h[(i + 1) % SAMPLES] || h[i] > h[(i + SAMPLES - 1) % SAMPLES]) continue;
      double low = (i - 1) * step, high = (i + 1) * step;
      for (int k = 0; k < 70; ++k) {
        const double s = low + 0.381966 * (high - low), t = high - 0.381966 * (high - low);
        (on(s) < on(t) ? high : low) = on(s) < on(t) ? t : s;
      }
    }
  }
  // Compass search on the sphere from the best starts.
  void descend() {
    std::vector<std::pair<L, Eigen::Vector3d>> starts;
    for (const auto& n : corners_) starts.emplace_back(at(n), n);
    constexpr int SPIRAL = 120;
    for (int i = 0; i < SPIRAL; ++i) {
      const double z = 1.0 - (2.0 * i + 1.0) / SPIRAL, t = 2.399963 * i, r = std::sqrt(1 - z * z);
      const Eigen::Vector3d n(r * std::cos(t), r * std::sin(t), z);
      starts.emplace_back(at(n), n);
    }
    const std::size_t kept = std::min<std::size_t>(10, starts.size());
    std::partial_sort(starts.begin(), starts.begin() + static_cast<std::ptrdiff_t>(kept),
                      starts.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
    for (std::size_t i = 0; i < kept; ++i) descendFrom(starts[i].second, starts[i].first);
  }
  // A gain counts from a hundredth of the step squared, in units of the bodies' size.
  void descendFrom(Eigen::Vector3d n, L h) {
    const L size = reach<L>(A_, {0.6L, 0.6L, 0.6L}) + reach<L>(B_, {0.6L, 0.6L, 0.6L});
    int moves_left = 300;
    for (double step = 0.2; step > 1e-8 && moves_left > 0;) {
      const Eigen::Vector3d u = n.unitOrthogonal(), v = n.cross(u);
      bool moved = false;
      for (int k = 0; k < 8 && !moved; ++k) {
        const double t = k * M_PI / 4.0 + 1e3 * step;  // turned each time: kinks have no axes
        const Eigen::Vector3d next = (n + step * (std::cos(t) * u + std::sin(t) * v)).normalized();
        const L found = at(next);
        if (found >= h - 1e-2L * step * step * size) continue;  // else it creeps along a kink
        h = found;
        n = next;
        moved = true;
        --moves_left;
      }
      if (!moved) step *= 0.5;
    }
  }

  const OracleBody& A_;
  const OracleBody& B_;
  const Eigen::Isometry3d& X_AB_;
  long double best_ = 1e300L;
  std::vector<Eigen::Vector3d> corners_;
};

/// How wrong an answer is, all lengths in metres. Upper bounds of the true errors.
struct AnswerError {
  bool wrong_verdict = false;  ///< and the truth is further than `band` from touching
  double distance = 0.0;       ///< of the signed distance
  double witness = 0.0;        ///< how far the points are off the shapes, or off `distance` apart
  double normal = 0.0;         ///< what the normal's own plane gives away against `distance`
};

/// The two points of an answer: how far each is outside its shape, and how far apart they are.
struct WitnessCheck {
  double off_a, off_b, apart;
  double error(double distance) const {
    return std::max({off_a, off_b, std::abs(apart - std::abs(distance))});
  }
};

inline WitnessCheck checkWitnesses(const OracleBody& A, const OracleBody& B,
                                   const Eigen::Isometry3d& X_AB, const PairDistance& result) {
  const V3<Exact> a = cast<Exact>(result.p_ACa), b = cast<Exact>(result.p_ACb),
                  p = cast<Exact>(X_AB.translation());
  V3<Exact> b_in_B, step;
  for (int i = 0; i < 3; ++i) {
    step[i] = b[i] - a[i];
    b_in_B[i] =
        dot(cast<Exact>(X_AB.linear().col(i)), V3<Exact>{b[0] - p[0], b[1] - p[1], b[2] - p[2]});
  }
  return {static_cast<double>(outside(A, a)), static_cast<double>(outside(B, b_in_B)),
          static_cast<double>(length(step))};
}

/// Judges result = distance(A, B, X_AB) without a limit on the distance.
inline AnswerError judge(const OracleBody& A, const OracleBody& B, const Eigen::Isometry3d& X_AB,
                         const PairDistance& result, double band) {
  const double lower = -static_cast<double>(height(A, B, X_AB, cast<Exact>(result.nhat_AB_A)));
  AnswerError error;
  error.normal = std::abs(result.distance - lower);
  const WitnessCheck witnesses = checkWitnesses(A, B, X_AB, result);
  error.witness = witnesses.error(result.distance);
  if (result.distance > 0.0) {
    const double upper = witnesses.apart + witnesses.off_a + witnesses.off_b;
    error.distance = std::max(result.distance - lower, upper - result.distance);
    // The normal's own plane proves that they are no deeper than this.
    error.wrong_verdict =
        lower < -band && -static_cast<double>(DepthSearch(A, B, X_AB).run()) < -band;
    return error;
  }
  double truth = -static_cast<double>(DepthSearch(A, B, X_AB).run());
  // A search may end beside the least: a plane that is lower by more than rounding is the better.
  constexpr double ROUNDING = 1e-14;
  if (lower > truth + ROUNDING) truth = lower;
  error.distance = std::abs(result.distance - truth);
  error.wrong_verdict = truth > band;
  return error;
}

}  // namespace collision_pairs
