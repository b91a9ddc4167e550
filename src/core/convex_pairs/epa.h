// Penetration depth of two overlapping convex cores by EPA, with a certified interval.
//
// van den Bergen, "Proximity queries and penetration depth computation on 3D game objects" (2001):
// a polytope inside A - B is expanded at the face closest to the origin. Deviation: every support
// plane encountered is an upper bound of the depth and the closest face a lower bound; the result
// is the best plane, whatever happens to the polytope. So rounding, flat differences and the
// iteration limit widen the interval, but the result is never wrong.
#pragma once

#include "gjk.h"

namespace collision_pairs {

template <class T>
struct EpaResult {
  T upper = std::numeric_limits<T>::infinity();  ///< depth along `normal`, hence >= the depth
  T lower = T(0);                                ///< no translation shorter than this separates
  Vec3<T> normal = Vec3<T>::UnitZ();             ///< unit, A to B
  Vec3<T> a = Vec3<T>::Zero();                   ///< deepest point of A, in A's frame
  Vec3<T> b = Vec3<T>::Zero();                   ///< deepest point of B, in A's frame
};

/// The signed distance from the origin of the plane through p, q, r, along (q - p) x (r - p), is no
/// less wherever the three are that are off by `rounding` (metres), which is at least 20 times the
/// rounding of a coordinate.
///
/// A combination y = sum of lambda_i w_i with sum 1 stays on the plane, and moves by no more than
/// the sum of |lambda_i| roundings. With y = s n + t, t across n, and n off by the angle theta, the
/// plane is s cos(theta) - |t| sin(theta) from the origin at least. The lambdas are those of the
/// origin's projection, so that t is nothing but rounding. With edges d, e the normal d x e changes
/// by 2 (|d| + |e|) roundings, and by less than as much again for its own arithmetic; half of
/// `sine` is for what is left out.
template <class T>
T leastPlaneDistance(const Vec3<T>& p, const Vec3<T>& q, const Vec3<T>& r, T rounding) {
  using std::abs;
  const Vec3<T> d = q - p, e = r - p;
  const Vec3<T> area_normal = d.cross(e);
  const T area = area_normal.norm();
  const T sine = T(8) * rounding * (d.norm() + e.norm()) / area;
  if (!(sine < T(0.25))) return -std::numeric_limits<T>::infinity();
  const Vec3<T> n = area_normal / area;
  const T along_d = e.cross(p).dot(n) / area;
  const T along_e = p.cross(d).dot(n) / area;
  const Vec3<T> y = p + along_d * d + along_e * e;
  const T s = y.dot(n);
  const T across = (y - s * n).norm();
  const T moved = rounding * (T(2) + T(4) * (abs(along_d) + abs(along_e)));
  return s - moved - across * sine - abs(s) * sine * sine;
}

/// Expands a single polytope. Fixed storage, nothing on the heap.
/// Cost: about F support evaluations and F^2 plane tests for F faces; F is 10 to 40 for
/// polytopes, and up to MAX_VERTICES for curved cores, on which it converges geometrically.
template <class T>
class Epa {
 public:
  Epa(const Difference<T>& difference, const Simplex<T>& simplex, T magnitude)
      : difference_(difference), magnitude_(magnitude) {
    for (int i = 0; i < simplex.size; ++i) point_[nb_points_++] = simplex.vertex[i];
  }

  /// True if a ball around the origin is certainly inside what run() left: it is on the inner side
  /// of each face of a closed surface, wherever the vertices are that are off by `rounding`
  /// (metres), at least 20 times the rounding of a vertex.
  bool enclosesBall(T radius, T rounding) const {
    const auto holds_it = [&](const Face& face) {
      const T spare = face.distance - radius - T(3) * rounding;
      // None of the three vectors is longer than twice the largest vertex.
      if (spare * face.area > T(32) * rounding * magnitude_ * magnitude_) return true;
      const auto vertex = [&](int k) -> const Vec3<T>& { return point_[face.id[k]].w; };
      return leastPlaneDistance(vertex(0), vertex(1), vertex(2), rounding) > radius;
    };
    return is_closed_ && std::all_of(face_.begin(), face_.begin() + nb_faces_, holds_it);
  }

  /// Until upper - lower <= tolerance (metres), or no progress can be made.
  EpaResult<T> run(T tolerance) {
    if (!growToTetrahedron()) return best_;
    while (nb_points_ < MAX_VERTICES) {
      const int closest = closestFace();
      if (closest < 0) break;
      const Face face = face_[closest];
      best_.lower = std::max(T(0), face.distance);
      const DifferencePoint<T> next = difference_.furthest(face.normal);
      offerPlane(face.normal, next);
      // Near touching, the interval must shrink with the depth, or the sign could not be decided.
      using std::abs;
      const T wanted = std::min(tolerance, T(0.01) * abs(best_.upper));
      if (best_.upper - face.distance <= std::max(wanted, roundingError())) break;
      if (next.w.dot(face.normal) - face.distance <= roundingError()) break;
      if (!grow(closest, next)) {
        face_[0] = face;  // the rest is no polytope: the last valid face gives the witness points
        nb_faces_ = 1;
        is_closed_ = false;
        break;
      }
    }
    setWitnesses();
    return best_;
  }

 private:
  static constexpr int MAX_VERTICES = 160;
  static constexpr int MAX_FACES = 2 * MAX_VERTICES + 64;

  struct Face {
    int id[3];
    Vec3<T> normal;  // unit, outwards; zero if the face has no area
    T distance;      // of its plane from the origin
    T area;          // twice it
  };

  T roundingError() const { return T(8) * std::numeric_limits<T>::epsilon() * magnitude_; }

  // A support plane bounds the depth from above.
  void offerPlane(const Vec3<T>& normal, const DifferencePoint<T>& furthest) {
    const T height = furthest.w.dot(normal);
    if (!(height < best_.upper)) return;
    best_.upper = height;
    best_.normal = normal;
    best_.a = furthest.a;
    best_.b = furthest.b;
  }

  // The point of the polytope's surface closest to the origin: of several coplanar faces, the one
  // onto which the origin projects.
  void setWitnesses() {
    T closest = std::numeric_limits<T>::infinity();
    const T limit = best_.upper + roundingError();
    for (int i = 0; i < nb_faces_; ++i) {
      if (!(face_[i].distance <= limit)) continue;
      Simplex<T> simplex;
      simplex.size = 3;
      for (int k = 0; k < 3; ++k) simplex.vertex[k] = point_[face_[i].id[k]];
      reduceToClosest(simplex);
      const T squared = simplex.closest().squaredNorm();
      if (!(squared < closest)) continue;
      closest = squared;
      best_.a = simplex.combine(&DifferencePoint<T>::a);
      best_.b = simplex.combine(&DifferencePoint<T>::b);
    }
  }

  // Adds the furthest point along +-d if its distance from the first point exceeds rounding. If A -
  // B is flat along d, the depth is the smaller of its two support heights.
  bool addAlong(const Vec3<T>& d) {
    const Vec3<T> n = d.normalized();
    const DifferencePoint<T> up = difference_.furthest(n);
    const DifferencePoint<T> down = difference_.furthest(Vec3<T>(-n));
    magnitude_ = std::max({magnitude_, up.w.norm(), down.w.norm()});
    const T height_up = (up.w - point_[0].w).dot(n);
    const T height_down = (point_[0].w - down.w).dot(n);
    offerPlane(n, up);
    offerPlane(Vec3<T>(-n), down);
    if (std::max(height_up, height_down) <= roundingError()) return false;
    point_[nb_points_++] = height_up >= height_down ? up : down;
    return true;
  }

  // Four points that are not coplanar, from GJK's final simplex.
  bool growToTetrahedron() {
    if (nb_points_ == 4 && tetrahedronIsFlat()) nb_points_ = 3;
    if (nb_points_ == 3 && areaNormal().norm() <= roundingError() * magnitude_) nb_points_ = 2;
    if (nb_points_ == 2 && (point_[1].w - point_[0].w).norm() <= roundingError()) nb_points_ = 1;
    if (nb_points_ == 0) point_[nb_points_++] = difference_.furthest(Vec3<T>::UnitX());
    for (int axis = 0; nb_points_ == 1 && axis < 3; ++axis) addAlong(Vec3<T>::Unit(axis));
    if (nb_points_ == 2) {
      const Vec3<T> edge = (point_[1].w - point_[0].w).normalized();
      const Vec3<T> side = edge.unitOrthogonal();
      if (!addAlong(side)) addAlong(edge.cross(side));
    }
    if (nb_points_ == 3) addAlong(areaNormal());
    if (nb_points_ < 4) return false;
    makeTetrahedron();
    return true;
  }

  Vec3<T> areaNormal() const {
    return (point_[1].w - point_[0].w).cross(point_[2].w - point_[0].w);
  }

  bool tetrahedronIsFlat() const {
    const Vec3<T> n = areaNormal();
    using std::abs;
    return abs(n.dot(point_[3].w - point_[0].w)) <= T(16) * roundingError() * n.norm();
  }

  void makeTetrahedron() {
    const bool flip = areaNormal().dot(point_[3].w - point_[0].w) > T(0);
    const int faces[4][3] = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
    nb_faces_ = 0;
    is_closed_ = true;
    for (const auto& f : faces) addFace(f[0], flip ? f[2] : f[1], flip ? f[1] : f[2]);
  }

  void addFace(int i, int j, int k) {
    Face face{{i, j, k}, Vec3<T>::Zero(), std::numeric_limits<T>::infinity(), T(0)};
    const Vec3<T>& p = point_[i].w;
    const Vec3<T> normal = (point_[j].w - p).cross(point_[k].w - p);
    const T area = face.area = normal.norm();
    if (area > roundingError() * roundingError()) {
      face.normal = normal / area;
      face.distance = p.dot(face.normal);
    }
    face_[nb_faces_++] = face;
  }

  int closestFace() const {
    int closest = -1;
    T distance = std::numeric_limits<T>::infinity();
    for (int i = 0; i < nb_faces_; ++i) {
      if (face_[i].distance < distance) closest = i, distance = face_[i].distance;
    }
    return closest;
  }

  // Replaces the faces visible from `next` by a fan from it to their border. False if, due to
  // rounding, the visible part is not a disc.
  bool grow(int closest, const DifferencePoint<T>& next) {
    const int tip = nb_points_;
    point_[nb_points_++] = next;
    magnitude_ = std::max(magnitude_, next.w.norm());
    nb_border_ = 0;
    for (int i = nb_faces_ - 1; i >= 0; --i) {
      const Face& face = face_[i];
      const bool sees = i == closest || face.normal.dot(next.w) - face.distance > roundingError();
      if (!sees) continue;
      for (int k = 0; k < 3; ++k) {
        if (!toggleBorder(face.id[k], face.id[(k + 1) % 3])) return false;
      }
      face_[i] = face_[--nb_faces_];
    }
    if (nb_faces_ + nb_border_ > MAX_FACES) return false;
    for (int i = 0; i < nb_border_; ++i) addFace(border_[i][0], border_[i][1], tip);
    return nb_border_ >= 3;
  }

  // An edge that two visible faces share is not on the border.
  bool toggleBorder(int from, int to) {
    for (int i = 0; i < nb_border_; ++i) {
      if (border_[i][0] == to && border_[i][1] == from) {
        border_[i] = border_[--nb_border_];
        return true;
      }
      if (border_[i][0] == from && border_[i][1] == to) return false;
    }
    if (nb_border_ == MAX_FACES) return false;
    border_[nb_border_++] = {from, to};
    return true;
  }

  const Difference<T>& difference_;
  T magnitude_;
  EpaResult<T> best_;
  std::array<DifferencePoint<T>, MAX_VERTICES + 4> point_;
  std::array<Face, MAX_FACES> face_;
  std::array<std::array<int, 2>, MAX_FACES> border_;
  int nb_points_ = 0;
  int nb_faces_ = 0;
  int nb_border_ = 0;
  bool is_closed_ = false;  // the faces are those of a whole polytope
};

}  // namespace collision_pairs
