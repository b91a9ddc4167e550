// The unit direction in which the support plane of A - B is nearest the origin, to rounding, where
// one or both cores are curved and a direction near it is known.
//
// With the height h(n) = max over w in A - B of w . n, the depth of two cores is the least height
// over all unit directions n, and their distance is minus that. GJK and EPA approximate a smooth
// surface by ever smaller facets, until rounding ends it; here the surface itself is used. A least
// height lies where h is smooth, on a kink of it (n across an edge or a cylinder's axis, where the
// support is a whole line) or where kinks meet (n the normal of a face or a cap). Newton's method
// finds the first two; the last are finitely many. Every result is a support plane: it bounds the
// depth from above and the distance from below.
#pragma once

#include <limits>

#include "convex_core.h"

namespace collision_pairs {

template <class T>
struct SupportPlane {
  Vec3<T> normal = Vec3<T>::UnitZ();              ///< unit, A to B
  T height = std::numeric_limits<T>::infinity();  ///< of A - B along it
};

template <class T>
class LeastHeight {
 public:
  explicit LeastHeight(const Difference<T>& difference)
      : difference_(difference),
        rounding_(T(8) * std::numeric_limits<T>::epsilon() * difference.magnitude()) {}

  /// The best so far, after a search from `near` with the edges that A and B have at their support
  /// points there. Cost: 20 to 100 support evaluations.
  SupportPlane<T> search(const Vec3<T>& near) {
    nb_edges_ = 0;
    noteEdges(difference_.A, Mat3<T>::Identity(), near);
    noteEdges(difference_.B, difference_.R_AB, -near);
    offerNormals();
    for (int i = 0; i < nb_edges_; ++i) descend(near, &edge_[i]);
    descend(near, nullptr);
    leaveKinks();
    return best_;
  }

  /// The same, starting from directions all around each of these edges, for cases in which a whole
  /// circle of directions is nearly as good.
  SupportPlane<T> searchAround() {
    for (int i = 0; i < nb_edges_; ++i) {
      const Vec3<T> u = edge_[i].unitOrthogonal(), v = edge_[i].cross(u);
      for (int k = 0; k < NUM_AROUND; ++k) {
        const double angle = 2.0 * M_PI * k / NUM_AROUND;
        descend(Vec3<T>(T(std::cos(angle)) * u + T(std::sin(angle)) * v), &edge_[i]);
      }
    }
    return best_;
  }

 private:
  static constexpr int MAX_EDGES = 10;
  static constexpr int EDGES_OF_POINTS = 6;
  static constexpr int MAX_STEPS = 16;
  static constexpr int NUM_AROUND = 12;
  static constexpr double FLAT = 0.1;  // radians: largest angle of an edge to the support plane
  static constexpr double LARGEST_STEP = 0.5;  // radians
  static constexpr double BESIDE = 1e-7;       // radians
  static constexpr double STILL = 8.0;         // units of rounding; the smallest step

  struct Surface {
    T height;
    Vec3<T> w;
    std::array<Vec3<T>, 2> along{};  // directions in which A and B are curved there, A's frame
    std::array<T, 2> radius{};       // their radii of curvature
  };

  void noteEdge(const Vec3<T>& e) {
    if (nb_edges_ < MAX_EDGES) edge_[nb_edges_++] = e;
  }

  void noteEdges(const ConvexCore& core, const Mat3<T>& R, const Vec3<T>& near) {
    using Kind = ConvexCore::Kind;
    if (core.kind == Kind::BOX) noteEdge(R.col(0)), noteEdge(R.col(1));
    if (core.kind == Kind::BOX || core.kind == Kind::SEGMENT || core.kind == Kind::CYLINDER) {
      noteEdge(R.col(2));
    }
    if (core.kind == Kind::POINTS) noteEdgesOfPoints(core, R, Vec3<T>(R.transpose() * near));
  }

  // From the support vertex to vertices that are hardly lower. Some may not be edges, which does no
  // harm.
  void noteEdgesOfPoints(const ConvexCore& core, const Mat3<T>& R, const Vec3<T>& near) {
    std::array<std::pair<T, Vec3<T>>, EDGES_OF_POINTS> flattest;
    int size = 0;
    const int tip = furthestPoint<T>(core, near);
    const auto offer = [&](int i) {
      const Vec3<T> step = (core.points[i] - core.points[tip]).template cast<T>();
      const T length = step.norm(), drop = -step.dot(near);
      if (!(length > T(0)) || drop > T(FLAT) * length) return;
      if (size == EDGES_OF_POINTS && drop >= flattest[size - 1].first * length) return;
      int place = size < EDGES_OF_POINTS ? size++ : size - 1;
      for (; place > 0 && flattest[place - 1].first * length > drop; --place) {
        flattest[place] = flattest[place - 1];
      }
      flattest[place] = {drop / length, step / length};
    };
    if (core.edges != nullptr && !core.edges->neighbours.empty()) {
      const auto& hull = *core.edges;
      for (auto k = hull.first_neighbour[tip]; k < hull.first_neighbour[tip + 1]; ++k) {
        offer(static_cast<int>(hull.neighbours[k]));
      }
    } else {
      for (int i = 0; i < core.nb_points; ++i) offer(i);
    }
    for (int i = 0; i < size; ++i) noteEdge(R * flattest[i].second);
  }

  static void setCurvature(const ConvexCore& core, const Vec3<T>& d, const Mat3<T>& R,
                           Vec3<T>& along, T& radius) {
    using std::sqrt;
    const T across = sqrt(d[0] * d[0] + d[1] * d[1]);
    if (!core.curved() || !(across > T(0))) {
      along.setZero(), radius = T(0);
      return;
    }
    along = R * Vec3<T>(-d[1] / across, d[0] / across, T(0));
    radius = T(core.half[0]) / across;
  }

  Surface at(const Vec3<T>& n) const {
    Surface surface;
    surface.w = difference_.furthest(n).w;
    surface.height = surface.w.dot(n);
    return surface;
  }

  void setCurvatures(const Vec3<T>& n, Surface& surface) const {
    setCurvature(difference_.A, n, Mat3<T>::Identity(), surface.along[0], surface.radius[0]);
    const Vec3<T> n_B = difference_.R_AB.transpose() * n;
    setCurvature(difference_.B, n_B, difference_.R_AB, surface.along[1], surface.radius[1]);
  }

  // Kinks are tried first: a direction that is lower only by rounding does not replace them.
  void offer(const Vec3<T>& n, const Surface& surface) {
    if (surface.height < best_.height - rounding_) best_ = {n, surface.height};
  }

  // Intersections of kinks, on both sides; caps.
  void offerNormals() {
    const auto offerBoth = [&](const Vec3<T>& direction) {
      const T length = direction.norm();
      if (!(length > T(1e-9))) return;
      const Vec3<T> n = direction / length;
      offer(n, at(n));
      offer(-n, at(-n));
    };
    if (difference_.A.curved()) offerBoth(Vec3<T>::UnitZ());
    if (difference_.B.curved()) offerBoth(difference_.R_AB.col(2));
    for (int i = 0; i < nb_edges_; ++i) {
      for (int k = i + 1; k < nb_edges_; ++k) offerBoth(edge_[i].cross(edge_[k]));
    }
  }

  // A kink is where two smooth pieces meet, and a lower direction may lie just inside either.
  void leaveKinks() {
    const Vec3<T> kink = best_.normal;
    for (int i = 0; i < nb_edges_; ++i) {
      using std::abs;
      if (abs(edge_[i].dot(kink)) > T(BESIDE)) continue;
      descend(Vec3<T>(kink + T(BESIDE) * edge_[i]), nullptr);
      descend(Vec3<T>(kink - T(BESIDE) * edge_[i]), nullptr);
    }
  }

  // Newton's method on the unit sphere or, with an edge, on the circle across it.
  void descend(Vec3<T> n, const Vec3<T>* edge) {
    const auto ontoCircle = [&](const Vec3<T>& x) {
      return edge ? Vec3<T>(x - x.dot(*edge) * *edge).normalized() : x.normalized();
    };
    n = ontoCircle(n);
    if (!(n.squaredNorm() > T(0.5))) return;
    Surface here = at(n);
    for (int i = 0; i < MAX_STEPS; ++i) {
      setCurvatures(n, here);
      Vec3<T> step;
      if (!newtonStep(n, here, edge, step)) break;
      const T length = step.norm();
      if (length > T(LARGEST_STEP)) step *= T(LARGEST_STEP) / length;
      Vec3<T> next = ontoCircle(n + step);
      Surface there = at(next);
      for (int k = 0; k < 3 && !(there.height < here.height + rounding_); ++k) {
        step *= T(0.25);
        next = ontoCircle(n + step);
        there = at(next);
      }
      if (!(there.height < here.height + rounding_)) break;
      n = next;
      here = there;
      if (length < T(STILL) * std::numeric_limits<T>::epsilon()) break;
    }
    offer(n, here);
  }

  // False if the height has no minimum nearby.
  static bool newtonStep(const Vec3<T>& n, const Surface& s, const Vec3<T>* edge, Vec3<T>& step) {
    if (edge) {
      const Vec3<T> u = edge->cross(n);
      T curvature = -s.height;
      for (int k = 0; k < 2; ++k) curvature += s.radius[k] * s.along[k].dot(u) * s.along[k].dot(u);
      if (!(curvature > T(0))) return false;
      step = (-s.w.dot(u) / curvature) * u;
      return true;
    }
    const Vec3<T> u = s.radius[0] > T(0) ? s.along[0] : s.along[1], v = n.cross(u);
    const T other = s.radius[0] > T(0) ? s.radius[1] : T(0);
    const T first = s.radius[0] > T(0) ? s.radius[0] : s.radius[1];
    const T c = s.along[1].dot(u), d = s.along[1].dot(v);
    const T h = s.height;
    const T uu = first + other * c * c - h, uv = other * c * d, vv = other * d * d - h;
    const T determinant = first * other * d * d - h * (first + other) + h * h;
    if (!(uu + vv > T(0)) || !(determinant > T(0))) return false;
    const T gu = s.w.dot(u), gv = s.w.dot(v);
    step = (-(vv * gu - uv * gv) / determinant) * u + (-(uu * gv - uv * gu) / determinant) * v;
    return true;
  }

  const Difference<T>& difference_;
  const T rounding_;  // of a height
  std::array<Vec3<T>, MAX_EDGES> edge_;
  int nb_edges_ = 0;
  SupportPlane<T> best_;
};

}  // namespace collision_pairs
