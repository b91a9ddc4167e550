// The depth of two overlapping convex shapes between two bounds that are close, found by branch and
// bound over all directions, without FCL and without the code under test.
//
// The depth is the least height h(n) = max over w in A - B of w . n over all unit directions n.
// Directions are divided into the cones of triangles with unit corners n_1, n_2, n_3. A support
// point w of any direction proves h(n) >= w . n, and so does every mixture of support points; on
// the flat triangle, where |n| <= 1, a mixture is least at a corner. So the best mixture's least
// corner bounds a whole cone from below, and any direction bounds the depth from above. A cone
// mixes the support points of its corners, of its middle and those of its parent's best mixture.
#pragma once

#include <queue>

#include "signed_distance_oracle.h"

namespace collision_pairs {

struct DepthInterval {
  long double lower, upper;
};

class CertifiedDepth {
 public:
  using L = long double;
  using Vector = Eigen::Matrix<L, 3, 1>;

  CertifiedDepth(const OracleBody& A, const OracleBody& B, const Eigen::Isometry3d& X_AB)
      : A_(A), B_(B), R_AB_(X_AB.linear().cast<L>()), p_AB_(X_AB.translation().cast<L>()) {}

  /// Until the bounds are `tolerance` (metres) apart, no closer, or so many cones were divided.
  /// `known` is a height that some direction is known to have, or more; it only saves time.
  DepthInterval run(L tolerance, int max_cones, L known = 1e300L) {
    upper_ = known;
    tolerance_ = tolerance;
    for (int i = 0; i < 8; ++i) {
      const L x = i & 1 ? -1 : 1, y = i & 2 ? -1 : 1, z = i & 4 ? -1 : 1;
      const Corner on_x = at({x, 0, 0});
      push({on_x, at({0, y, 0}), at({0, 0, z})}, {on_x.w, on_x.w, on_x.w});
    }
    for (int i = 0; i < max_cones && !cones_.empty(); ++i) {
      const Cone cone = cones_.top();
      if (cone.lower >= upper_ - tolerance) break;
      cones_.pop();
      const auto& [a, b, c] = cone.corner;
      const Corner ab = at(a.n + b.n), bc = at(b.n + c.n), ca = at(c.n + a.n);
      push({a, ab, ca}, cone.mixed);
      push({ab, b, bc}, cone.mixed);
      push({ca, bc, c}, cone.mixed);
      push({ab, bc, ca}, cone.mixed);
    }
    const L closed = upper_ - tolerance;  // what was not kept is no lower
    return {cones_.empty() ? closed : std::min(cones_.top().lower, closed), upper_};
  }

 private:
  static constexpr int NUM = 7;

  struct Corner {
    Vector n, w;
  };
  struct Cone {
    L lower;
    std::array<Corner, 3> corner;
    std::array<Vector, 3> mixed;  // support points of the mixture that gave `lower`
    bool operator<(const Cone& other) const { return lower > other.lower; }  // least on top
  };

  static Vector furthest(const OracleBody& body, const Vector& d) {
    const auto side = [](L x, double half) { return x < 0 ? -L(half) : L(half); };
    if (const auto* box = std::get_if<Box>(&body.shape)) {
      const Eigen::Vector3d h = 0.5 * box->size;
      return {side(d[0], h[0]), side(d[1], h[1]), side(d[2], h[2])};
    }
    if (const auto* c = std::get_if<Cylinder>(&body.shape)) {
      const L rho = std::sqrt(d[0] * d[0] + d[1] * d[1]), k = rho > 0 ? c->radius / rho : 0;
      return {k * d[0], k * d[1], side(d[2], 0.5 * c->length)};
    }
    if (const auto* c = std::get_if<Capsule>(&body.shape)) {
      return c->radius * d.normalized() + Vector(0, 0, side(d[2], 0.5 * c->length));
    }
    if (const auto* sphere = std::get_if<Sphere>(&body.shape)) {
      return sphere->radius * d.normalized();
    }
    const auto along = [&](const Eigen::Vector3d& p) { return p.cast<L>().dot(d); };
    return std::max_element(body.vertices.begin(), body.vertices.end(),
                            [&](const auto& p, const auto& q) { return along(p) < along(q); })
        ->template cast<L>();
  }

  Corner at(const Vector& direction) {
    Corner corner;
    corner.n = direction.normalized();
    const Vector back = -(R_AB_.transpose() * corner.n);
    corner.w = furthest(A_, corner.n) - p_AB_ - R_AB_ * furthest(B_, back);
    upper_ = std::min(upper_, corner.w.dot(corner.n));
    return corner;
  }

  void push(const std::array<Corner, 3>& corner, const std::array<Vector, 3>& inherited) {
    const Corner middle = at(corner[0].n + corner[1].n + corner[2].n);
    const std::array<Vector, NUM> w{corner[0].w,  corner[1].w,  corner[2].w, middle.w,
                                    inherited[0], inherited[1], inherited[2]};
    std::array<Vector, NUM> reach;  // of each support point along the three corners
    for (int k = 0; k < NUM; ++k) {
      for (int i = 0; i < 3; ++i) reach[k][i] = w[k].dot(corner[i].n);
    }
    Cone cone{-1e300L, corner, {}};
    mix(reach, [&](const Vector& mixture, int k, int m, int o) {
      if (mixture.minCoeff() <= cone.lower) return;
      cone.lower = mixture.minCoeff();
      cone.mixed = {w[k], w[m], w[o]};
    });
    if (cone.lower < upper_ - tolerance_) cones_.push(cone);
  }

  // Each, and of each two and each three the mixture in which two or three entries are equal.
  template <class Offer>
  static void mix(const std::array<Vector, NUM>& reach, const Offer& offer) {
    for (int k = 0; k < NUM; ++k) {
      offer(reach[k], k, k, k);
      for (int m = k + 1; m < NUM; ++m) {
        const Vector step = reach[m] - reach[k];
        for (int i = 0; i < 3; ++i) {
          for (int j = i + 1; j < 3; ++j) {
            const L t = (reach[k][j] - reach[k][i]) / (step[i] - step[j]);
            if (t > 0 && t < 1) offer(reach[k] + t * step, k, m, m);
          }
        }
        for (int o = m + 1; o < NUM; ++o) {
          // Where the weighted sums are all 1, by Cramer's rule.
          const Vector &a = reach[k], &b = reach[m], &c = reach[o], ones = Vector::Ones();
          const L all = a.dot(b.cross(c));
          Vector weights(ones.dot(b.cross(c)), a.dot(ones.cross(c)), a.dot(b.cross(ones)));
          if (all < 0) weights = -weights;
          const L sum = weights.sum();
          if (weights.minCoeff() > 0 && sum > 0) {
            offer((weights[0] * a + weights[1] * b + weights[2] * c) / sum, k, m, o);
          }
        }
      }
    }
  }

  const OracleBody& A_;
  const OracleBody& B_;
  Eigen::Matrix<L, 3, 3> R_AB_;
  Vector p_AB_;
  L upper_ = 1e300L, tolerance_ = 0;
  std::priority_queue<Cone> cones_;
};

}  // namespace collision_pairs
