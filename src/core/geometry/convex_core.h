// Convex solids as GJK and EPA see them: a core given by its support function, plus a radius.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "box_gap.h"
#include "cube_cells.h"
#include "packed_points.h"

namespace collision_pairs {

/// The hull's vertices and, for each, the vertices it shares an edge with: neighbours of vertex i
/// are neighbours[first_neighbour[i]] to neighbours[first_neighbour[i + 1] - 1]. Without neighbours
/// the support function compares all vertices.
struct ConvexPoints {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::uint32_t> first_neighbour;
  std::vector<std::uint32_t> neighbours;
  std::vector<std::uint32_t> start;  ///< by cubeCell(): the vertex furthest along its centre
  std::vector<PointBlock> blocks;    ///< instead of neighbours, for few vertices: the same points
};

/// All points within `radius` of a core. Rounding is kept apart from the core so that a sphere is
/// a point and a capsule a segment, for which GJK is exact after a few steps. Metres, in the
/// shape's own frame. Refers to its points, does not own them.
struct ConvexCore {
  enum class Kind { POINT, SEGMENT, BOX, CYLINDER, POINTS };

  Kind kind = Kind::POINT;
  Eigen::Vector3d half = Eigen::Vector3d::Zero();    ///< half extents along x, y, z
  double radius = 0.0;                               ///< rounding radius
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< a point inside
  double extent = 0.0;  ///< no point of the core is further from the centre
  const Eigen::Vector3d* points = nullptr;
  int nb_points = 0;
  const ConvexPoints* edges = nullptr;  ///< for walking along edges; may be null
  const PointBlock* blocks = nullptr;   ///< the same points, to compare all of them; may be null

  /// Curved cores have no finite set of vertices on which GJK and EPA terminate.
  bool curved() const { return kind == Kind::CYLINDER; }
};

/// Bound of the error of coordinates of points of the two, in a frame near them: closest points of
/// hulls are no further than this from their surface, and vertices that Qhull leaves out no further
/// than this outside their hull.
inline double roundingOf(const ConvexCore& a, const ConvexCore& b) {
  constexpr double ROUNDING = 64.0 * std::numeric_limits<double>::epsilon();
  return ROUNDING * (a.extent + a.center.norm() + a.radius + b.extent + b.center.norm() + b.radius);
}

/// The lengths of all vectors that a vertex of A - B is computed from, and the radii; metres.
inline double magnitudeOf(const ConvexCore& A, const ConvexCore& B, const Eigen::Vector3d& p_AB) {
  return A.extent + A.radius + B.extent + B.radius + A.center.lpNorm<1>() + B.center.lpNorm<1>() +
         p_AB.lpNorm<1>();
}

/// Two are in contact if the gap between them is no larger than this, metres: it may be nothing but
/// the rounding of the numbers given, as when two faces coincide in decimals. With u = 2^-53 a
/// coordinate is off by u of itself, a point of B in A's frame by 3 sqrt(3) u for the product and u
/// for each of two sums, and the rotation, a product itself, by as much as one of them: 9 u or
/// 1e-15 of all lengths. `offset`: of the two from the origin of the poses that X_AB was computed
/// from.
inline double contactBand(const ConvexCore& A, const ConvexCore& B, const Eigen::Vector3d& p_AB,
                          double offset) {
  return 1e-15 * (magnitudeOf(A, B, p_AB) + offset);
}

/// The largest error of an EXACT distance: some roundings of the coordinates or, where that is
/// more, this share of the smaller body's size.
inline double largestError(const ConvexCore& A, const ConvexCore& B, double magnitude) {
  constexpr double OF_MAGNITUDE = 24.0 * std::numeric_limits<double>::epsilon();
  constexpr double OF_SMALLER = 1e-12;
  const double smaller = std::min(A.extent + A.radius, B.extent + B.radius);
  return std::max(OF_MAGNITUDE * magnitude, OF_SMALLER * smaller);
}

/// The box around it along its own axes, rounding included.
inline OrientedBox boxAround(const ConvexCore& core) {
  return {Eigen::Matrix3d::Identity(), core.center,
          core.half.array() + (core.radius + roundingOf(core, ConvexCore{}))};
}

template <class T>
using Vec3 = Eigen::Matrix<T, 3, 1>;
template <class T>
using Mat3 = Eigen::Matrix<T, 3, 3>;

/// Walks from vertex `best` along edges to the vertex furthest along d.
template <class T>
int climb(const ConvexPoints& hull, const Vec3<T>& d, int best) {
  const auto along = [&](int i) { return hull.vertices[i].template cast<T>().dot(d); };
  T best_dot = along(best);
  for (int from = -1; from != best;) {
    from = best;
    const std::uint32_t end = hull.first_neighbour[from + 1];
    for (std::uint32_t k = hull.first_neighbour[from]; k < end; ++k) {
      const int i = static_cast<int>(hull.neighbours[k]);
      const T dot = along(i);
      const bool further = dot > best_dot;  // no branch: it would be mispredicted
      best = further ? i : best;
      best_dot = further ? dot : best_dot;
    }
  }
  return best;
}

/// Index of the vertex furthest along d. Cost: with edges a few vertices, else all of them.
template <class T>
[[gnu::always_inline]] inline int furthestPoint(const ConvexCore& core, const Vec3<T>& d) {
  if (core.edges != nullptr && !core.edges->neighbours.empty()) {
    return climb<T>(*core.edges, d, static_cast<int>(core.edges->start[cubeCell<T>(d)]));
  }
  if constexpr (std::is_same_v<T, double>) {
    if (core.blocks != nullptr) {
      const auto nb_points = static_cast<std::size_t>(core.nb_points);
      const std::size_t nb_blocks = (nb_points + POINT_LANES - 1) / POINT_LANES;
      const std::size_t found = furthestInBlocks(core.blocks, nb_blocks, d).index;
      return static_cast<int>(std::min(found, nb_points - 1));
    }
  }
  const auto along = [&](int i) { return core.points[i].template cast<T>().dot(d); };
  int best = 0;
  T best_dot = along(best);
  for (int i = 1; i < core.nb_points; ++i) {
    const T dot = along(i);
    if (dot > best_dot) best = i, best_dot = dot;
  }
  return best;
}

/// A point of the core furthest along d, which need not be of unit length; in the core's frame.
/// `vertex`, if given, is set to its index if the core has POINTS.
template <class T>
[[gnu::always_inline]] inline Vec3<T> support(const ConvexCore& core, const Vec3<T>& d,
                                              int* vertex = nullptr) {
  using Kind = ConvexCore::Kind;
  const auto signedHalf = [&](int i) { return d[i] < T(0) ? T(-core.half[i]) : T(core.half[i]); };
  switch (core.kind) {
    case Kind::POINT:
      return Vec3<T>::Zero();
    case Kind::SEGMENT:
      return Vec3<T>(T(0), T(0), signedHalf(2));
    case Kind::BOX:
      return Vec3<T>(signedHalf(0), signedHalf(1), signedHalf(2));
    case Kind::CYLINDER: {
      using std::sqrt;
      const T length = sqrt(d[0] * d[0] + d[1] * d[1]);
      const T scale = length > T(0) ? T(core.half[0]) / length : T(0);
      return Vec3<T>(scale * d[0], scale * d[1], signedHalf(2));
    }
    case Kind::POINTS: {
      const int furthest = furthestPoint<T>(core, d);
      if (vertex != nullptr) *vertex = furthest;
      return core.points[furthest].template cast<T>();
    }
  }
  return Vec3<T>::Zero();
}

/// A vertex w = a - b of the Minkowski difference A - B, all in A's frame.
template <class T>
struct DifferencePoint {
  Vec3<T> w, a, b;
  int vertex_a, vertex_b;  ///< which ones a and b are, if they are vertices of hulls
};

/// The Minkowski difference of two cores, A's frame: it contains the origin if they overlap.
template <class T>
struct Difference {
  Difference(const ConvexCore& core_a, const ConvexCore& core_b, const Eigen::Isometry3d& X_AB)
      : A(core_a), B(core_b), R_AB(X_AB.linear().cast<T>()), p_AB(X_AB.translation().cast<T>()) {}
  Difference(const ConvexCore& core_a, const ConvexCore& core_b, const Mat3<T>& R, const Vec3<T>& p)
      : A(core_a), B(core_b), R_AB(R), p_AB(p) {}

  [[gnu::always_inline]] DifferencePoint<T> furthest(const Vec3<T>& d) const {
    DifferencePoint<T> point;
    point.vertex_a = point.vertex_b = 0;
    point.a = support<T>(A, d, &point.vertex_a);
    point.b = R_AB * support<T>(B, Vec3<T>(-(R_AB.transpose() * d)), &point.vertex_b) + p_AB;
    point.w = point.a - point.b;
    return point;
  }

  /// Bounds the distance of all points from the origin, and the coordinates they are computed from.
  T magnitude() const {
    return T(A.extent + A.center.norm() + B.extent + B.center.norm()) + p_AB.norm();
  }

  const ConvexCore& A;
  const ConvexCore& B;
  Mat3<T> R_AB;
  Vec3<T> p_AB;
};

}  // namespace collision_pairs
