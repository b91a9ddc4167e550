// The closest points of two hulls, computed from nothing but the vertices that they lie between: so
// the numbers do not depend on how these were found, by GJK from the centres or from where the pair
// was last.
//
// Why no two ways give two answers: say areClosest() holds for vertices F, whose points have a
// point d away from the origin, its closest, more than INSIDE from the border of the face F. With
// lengths in units of m = magnitudeOf(), all other vertices of A - B are BEHIND or more beyond the
// support plane. Take any vertices with a point that is no further from the origin than d + g. Of
// its weights those that are not of F add up to no more than g / BEHIND: less than LEAST_WEIGHT, as
// g is at most largestError(), half of 1e-12. The point is off along the plane by no more than
// sqrt(2 d g) = 1e-6, and so is what F contributes, within 2e-6. It is then at least 8e-6 inside
// the face, of which no altitude is more than 2, so that each vertex of A and of B in F has a
// weight of 4e-6 or more. Therefore closestVertices() of every simplex whose distance is proved is
// F.
#pragma once

#include "collision_pairs/pair_distance.h"
#include "gjk.h"

namespace collision_pairs {
namespace closest_vertices_detail {

// See above.
constexpr double BEHIND = 1e-6, INSIDE = 1e-5, LEAST_WEIGHT = 2e-6;

/// A vertex, an edge or a triangle of a hull.
class Feature {
 public:
  Feature(const ConvexCore& core, const std::array<std::int32_t, 3>& vertices)
      : core_(core), vertices_(vertices) {
    while (size < 3 && vertices[size] >= 0) ++size;
  }

  bool isValid() const {
    return core_.kind == ConvexCore::Kind::POINTS && core_.edges != nullptr && size > 0 &&
           *std::max_element(vertices_.begin(), vertices_.end()) < core_.nb_points;
  }
  const Eigen::Vector3d& operator[](int i) const { return core_.points[vertices_[i]]; }

  /// True if all other vertices are further along n by more than `more`. It is enough to look at
  /// neighbours: a vertex that is none lies beyond their convex hull.
  bool isLowest(const Eigen::Vector3d& n, double more) const {
    const double least = (*this)[0].dot(n) + more;
    const auto isAbove = [&](int i) {
      return core_.points[i].dot(n) > least || i == vertices_[0] || i == vertices_[1] ||
             i == vertices_[2];
    };
    const ConvexPoints& hull = *core_.edges;
    if (hull.neighbours.empty()) {
      for (int i = 0; i < core_.nb_points; ++i) {
        if (!isAbove(i)) return false;
      }
      return true;
    }
    for (int k = 0; k < size; ++k) {
      const std::uint32_t end = hull.first_neighbour[vertices_[k] + 1];
      for (std::uint32_t i = hull.first_neighbour[vertices_[k]]; i < end; ++i) {
        if (!isAbove(static_cast<int>(hull.neighbours[i]))) return false;
      }
    }
    return true;
  }

  int size = 0;

 private:
  const ConvexCore& core_;
  const std::array<std::int32_t, 3>& vertices_;
};

}  // namespace closest_vertices_detail

/// The vertices that make up more than rounding of the simplex's point; `is_whole`: that is all.
template <class T>
ClosestVertices closestVertices(const Simplex<T>& simplex, bool& is_whole) {
  using namespace closest_vertices_detail;
  ClosestVertices found;
  is_whole = simplex.size < 4;
  if (!is_whole) return found;
  const auto collect = [&](auto vertex, std::array<std::int32_t, 3>& ids) {
    std::array<T, 3> weights{};
    int size = 0;
    for (int i = 0; i < simplex.size; ++i) {
      const int id = simplex.vertex[i].*vertex;
      int at = 0;
      while (at < size && ids[at] < id) ++at;
      if (at < size && ids[at] == id) {
        weights[at] += simplex.lambda[i];
        continue;
      }
      for (int k = size++; k > at; --k) ids[k] = ids[k - 1], weights[k] = weights[k - 1];
      ids[at] = id;
      weights[at] = simplex.lambda[i];
    }
    int kept = 0;
    for (int i = 0; i < size; ++i) {
      if (weights[i] > T(LEAST_WEIGHT)) ids[kept++] = ids[i];
    }
    is_whole = is_whole && kept == size;
    std::fill(ids.begin() + kept, ids.end(), -1);
  };
  collect(&DifferencePoint<T>::vertex_a, found.a);
  collect(&DifferencePoint<T>::vertex_b, found.b);
  return found;
}

/// Sets `found` to the point of A - B that is closest to the origin among those between the
/// vertices, with a lower bound of their distances, and GJK may go on from there. True if it is
/// clearly between them.
inline bool closestBetween(const Difference<double>& difference, const ClosestVertices& vertices,
                           double magnitude, GjkResult<double>& found) {
  using namespace closest_vertices_detail;
  using Eigen::Vector3d;
  const Feature A(difference.A, vertices.a), B(difference.B, vertices.b);
  if (!A.isValid() || !B.isValid() || A.size + B.size > 4) return false;
  Simplex<double>& simplex = found.simplex;
  auto& v = simplex.vertex;
  int size = 0;
  for (int k = 0; k < B.size; ++k) {
    const Vector3d b = difference.R_AB * B[k] + difference.p_AB;
    for (int i = 0; i < A.size; ++i) {
      v[size++] = {A[i] - b, A[i], b, vertices.a[i], vertices.b[k]};
    }
  }
  // The least of its coordinates, and the squares of twice the area and of the longest edge: the
  // point is least * area / longest or more inside. Of edges, all of their parallelogram.
  double least = -1.0, area = 1.0, longest = 1.0;
  if (size == 4) {
    const Vector3d along_a = v[1].a - v[0].a, along_b = v[2].b - v[0].b;
    const double aa = along_a.squaredNorm(), bb = along_b.squaredNorm();
    const double ab = along_a.dot(along_b), aw = along_a.dot(v[0].w), bw = along_b.dot(v[0].w);
    area = aa * bb - ab * ab;
    longest = std::max(aa, bb);
    const double s = (ab * bw - aw * bb) / area, t = (aa * bw - ab * aw) / area;
    least = std::min(std::min(s, 1.0 - s), std::min(t, 1.0 - t));
    simplex.lambda = {1.0 - s - t, s, t};
    if (s + t > 1.0) {
      std::swap(v[0], v[3]);
      simplex.lambda = {s + t - 1.0, 1.0 - t, 1.0 - s};
    }
  }
  simplex.size = std::min(size, 3);
  if (!(least > 0.0)) {
    simplex.lambda = closestCoordinates(v, simplex.size);
    if (size < 4) least = *std::min_element(simplex.lambda.begin(), simplex.lambda.begin() + size);
    if (size == 2) area = (v[1].w - v[0].w).squaredNorm();
    if (size == 3) {
      const Vector3d p = v[1].w - v[0].w, q = v[2].w - v[0].w;
      area = p.cross(q).squaredNorm();
      longest = std::max({p.squaredNorm(), q.squaredNorm(), (p - q).squaredNorm()});
    }
  }
  const double inside = INSIDE * magnitude;
  if (!(least > 0.0) || (size > 1 && !(least * least * area > inside * inside * longest))) {
    reduceTo(simplex.lambda, simplex.size, simplex);
    found.v = simplex.closest();
    return false;
  }
  found.v = simplex.closest();
  found.lower = std::numeric_limits<double>::infinity();
  for (int i = 0; i < size; ++i) found.lower = std::min(found.lower, v[i].w.dot(found.v));
  found.lower /= found.v.norm();
  found.magnitude = magnitude;
  return true;
}

/// True if no other vertex of A - B is as near along v, clearly so.
inline bool areClosest(const Difference<double>& difference, const ClosestVertices& vertices,
                       double magnitude, const Eigen::Vector3d& v) {
  using namespace closest_vertices_detail;
  const double behind = BEHIND * magnitude * v.norm();
  return Feature(difference.A, vertices.a).isLowest(v, behind) &&
         Feature(difference.B, vertices.b).isLowest(-(difference.R_AB.transpose() * v), behind);
}

}  // namespace collision_pairs
