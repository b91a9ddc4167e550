// The closest points of a cylinder and another core, once GJK has found roughly where they are.
//
// GJK approximates a rim by ever shorter chords. Here the features that its points lie on are taken
// as they are: the distance of a point from a cylinder has a closed form, and Newton's method finds
// the point of an edge or a rim where it is least; the normal of a face or a cap is known. That
// they are the right features is not proved here: a gap is a guess that its support plane has to
// confirm. A common point needs no proof.
#pragma once

#include <optional>

#include "support_part.h"

namespace collision_pairs {

/// In A's frame: a point of A and one of B, and the unit normal from A to B; or a point of both.
struct CylinderGap {
  Witnesses<double> points;
  Eigen::Vector3d normal;
  bool is_common = false;
};

/// C is A if that is a cylinder, else B; O is the other one. Points, unless named otherwise, are in
/// C's frame, and normals point from C to O.
class CylinderGapSearch {
 public:
  using Vector3d = Eigen::Vector3d;

  /// `near`: what GJK has found; its simplex is not empty. `least_depth`: metres below the surface
  /// of C, of a common point. Refers to the difference. Cost: no support evaluation.
  CylinderGapSearch(const Difference<double>& difference, const GjkResult<double>& near,
                    double least_depth)
      : difference_(difference),
        is_a_(difference.A.curved()),
        other_(is_a_ ? difference.B : difference.A),
        radius_((is_a_ ? difference.A : difference.B).half[0]),
        half_length_((is_a_ ? difference.A : difference.B).half[2]),
        least_depth_(least_depth),
        is_apart_(near.lower > 0.0) {
    const Witnesses<double> witnesses = witnessesOf(near.simplex);
    R_CO_ = difference.R_AB;
    p_CO_ = difference.p_AB;
    if (!is_a_) {
      R_CO_.transposeInPlace();
      p_CO_ = -(R_CO_ * difference.p_AB);
    }
    start_ = is_a_ ? witnesses.b : inC(witnesses.a);
    normal_ = is_a_ ? Vector3d(-near.v) : Vector3d(R_CO_ * near.v);
    normal_.normalize();
    for (int i = 0; i < near.simplex.size; ++i) {
      const DifferencePoint<double>& w = near.simplex.vertex[i];
      const Vector3d p = is_a_ ? w.b : inC(w.a);
      if (std::find(vertex_.begin(), vertex_.begin() + nb_vertices_, p) ==
          vertex_.begin() + nb_vertices_) {
        vertex_[nb_vertices_++] = p;
      }
    }
  }

  /// Offers the closest points of the features that GJK seems to have come to, one pair of features
  /// after the other, until `accept` returns true. Returns whether it did. Cost: 0.1 to 0.3 µs
  /// each.
  template <class Accept>
  bool offer(const Accept& accept) const {
    const auto offerThe = [&](const Found& found) { return found && accept(inA(*found)); };
    switch (other_.kind) {
      case Kind::SEGMENT:
        return offerThe(fromAxis(0.0));
      case Kind::BOX:
        return offerThe(fromBox());
      case Kind::POINTS:
        return offerThe(fromVertices());
      case Kind::CYLINDER: {
        const bool to_rim = facesRim();
        const bool to_side = std::abs(normal_.dot(R_CO_.col(2))) < NEARLY;
        if (to_side && offerThe(fromAxis(other_.half[0]))) return true;
        if (offerThe(fromRim(to_rim))) return true;
        if (!is_apart_) return false;
        return offerThe(fromRim(!to_rim)) || offerThe(fromCap());
      }
      default:
        return false;
    }
  }

 private:
  using Kind = ConvexCore::Kind;

  static constexpr int MAX_STEPS = 16;
  static constexpr double SMALL = 1e-7;        // a relative step after which the next is rounding
  static constexpr double LARGEST_TURN = 0.5;  // radians
  static constexpr double NEARLY = 0.1;        // radians
  static constexpr double ON_FACE = 1.0 - 1e-9;
  static constexpr double PARALLEL = 1e-12;
  static constexpr double ACROSS = 0.1;

  // First and second derivatives of a function that grows with the distance from C and is smooth
  // also where that is small, by the directions from C's axis, around it and along it.
  struct Slope {
    double curvature(const Vector3d& d) const {
      const double u = radial.dot(d), v = radial[0] * d[1] - radial[1] * d[0];
      return along_radial * u * u + along_tangent * v * v + along_axis * d[2] * d[2];
    }

    bool is_inside = false;
    Vector3d gradient = Vector3d::Zero(), radial = Vector3d::Zero();
    double along_radial = 0.0, along_tangent = 0.0, along_axis = 0.0;
  };

  // On C and on O; C's frame.
  struct Gap {
    Vector3d on_cylinder, on_other, normal;
    bool is_common = false;
  };
  using Found = std::optional<Gap>;

  // The corner, edge or face with the vertices of O that GJK has come to.
  Found fromVertices() const {
    if (nb_vertices_ == 1) return fromPointOn(vertex_[0], Vector3d::Zero());
    if (nb_vertices_ == 2) return fromEdge(vertex_[0], vertex_[1], 0.0);
    const Vector3d d = vertex_[1] - vertex_[0], e = vertex_[2] - vertex_[0];
    const Vector3d area_normal = d.cross(e);
    const double area = area_normal.norm();
    if (!(area > 0.0)) return {};
    const Vector3d n = area_normal / area;
    const Gap gap = fromFace(n, vertex_[0].dot(n));
    const Vector3d p = gap.on_other - vertex_[0];
    const double along_d = p.cross(e).dot(n), along_e = d.cross(p).dot(n);
    if (along_d < 0.0 || along_e < 0.0 || along_d + along_e > area) return {};
    return gap;
  }

  // The corner, edge or face of the box O that its point is on.
  Found fromBox() const {
    Vector3d corner = R_CO_.transpose() * (start_ - p_CO_);
    int nb_free = 0, free_axis = 0, fixed_axis = 0;
    for (int i = 0; i < 3; ++i) {
      if (std::abs(corner[i]) < ON_FACE * other_.half[i]) {
        free_axis = i;
        ++nb_free;
      } else {
        fixed_axis = i;
        corner[i] = std::copysign(other_.half[i], corner[i]);
      }
    }
    if (nb_free == 3) return {};
    if (nb_free == 2) {
      const Vector3d n = std::copysign(1.0, corner[fixed_axis]) * R_CO_.col(fixed_axis);
      return fromFace(n, p_CO_.dot(n) + other_.half[fixed_axis]);
    }
    if (nb_free == 1) corner[free_axis] = -other_.half[free_axis];
    const Vector3d from = R_CO_ * corner + p_CO_;
    if (nb_free == 0) return fromPointOn(from, Vector3d::Zero());
    return fromEdge(from, from + 2.0 * other_.half[free_axis] * R_CO_.col(free_axis), 0.0);
  }

  // The axis of O: a segment, or a cylinder with its side towards C.
  Found fromAxis(double radius) const {
    const Vector3d half = other_.half[2] * R_CO_.col(2);
    return fromEdge(p_CO_ - half, p_CO_ + half, radius);
  }

  // The cap of the cylinder O that faces C.
  Gap fromCap() const {
    const Vector3d n = capNormal();
    return fromFace(n, p_CO_.dot(n) + other_.half[2]);
  }

  // Its rim, by Newton's method on the angle. `to_rim`: to the nearest rim of C, or to whatever is
  // nearest.
  Found fromRim(bool to_rim) const {
    const Vector3d axis = capNormal();
    const Vector3d center = p_CO_ + other_.half[2] * axis;
    const double r = other_.half[0];
    Vector3d w = start_ - center;
    w -= w.dot(axis) * axis;
    if (!(w.squaredNorm() > 0.0)) return {};
    w.normalize();
    for (int i = 0; i < MAX_STEPS; ++i) {
      const Vector3d t = axis.cross(w), x = center + r * w;
      const Slope slope = slopeAt(x, to_rim);
      if (slope.is_inside) return common(x);
      const double second = r * slope.curvature(t) - slope.gradient.dot(w);
      if (!(second > 0.0)) return {};
      const double step = std::clamp(-slope.gradient.dot(t) / second, -LARGEST_TURN, LARGEST_TURN);
      w = (w + step * t).normalized();
      if (std::abs(step) <= SMALL) return fromPointOn(center + r * w, axis.cross(w));
    }
    return {};
  }

  Vector3d inC(const Vector3d& p_A) const {
    return difference_.R_AB.transpose() * (p_A - difference_.p_AB);
  }

  // Of O a point that it has, but for rounding.
  CylinderGap inA(const Gap& gap) const {
    Vector3d p_O = R_CO_.transpose() * (gap.on_other - p_CO_);
    if (other_.kind != Kind::POINTS) p_O = nearestPoint(other_, p_O, 0.0);
    const Vector3d& a = is_a_ ? gap.on_cylinder : p_O;
    const Vector3d& b = is_a_ ? p_O : gap.on_cylinder;
    const Vector3d n = is_a_ ? gap.normal : Vector3d(-(difference_.R_AB * gap.normal));
    return {{a, difference_.R_AB * b + difference_.p_AB}, n, gap.is_common};
  }

  // Whether a plane across the normal touches C at a rim only, as far as one can tell yet.
  bool facesRim() const {
    return std::min(std::abs(normal_[2]), normal_.head<2>().norm()) > NEARLY;
  }

  Vector3d capNormal() const {
    return normal_.dot(R_CO_.col(2)) < 0.0 ? Vector3d(R_CO_.col(2)) : Vector3d(-R_CO_.col(2));
  }

  // Half the squared distance from a rim, of that from the axis beside the side; the height above a
  // cap.
  Slope slopeAt(const Vector3d& x, bool to_rim) const {
    Slope slope;
    const double rho = std::sqrt(x[0] * x[0] + x[1] * x[1]);
    const double beside = rho - radius_, beyond = std::abs(x[2]) - half_length_;
    if (rho > 0.0) slope.radial = Vector3d(x[0] / rho, x[1] / rho, 0.0);
    if (to_rim || (beside > 0.0 && beyond > 0.0)) {
      slope.gradient = beside * slope.radial;
      slope.gradient[2] = x[2] < 0.0 ? -beyond : beyond;
      slope.along_radial = slope.along_axis = 1.0;
      slope.along_tangent = rho > 0.0 ? beside / rho : 0.0;
    } else if (beside > 0.0) {
      slope.gradient = Vector3d(x[0], x[1], 0.0);
      slope.along_radial = slope.along_tangent = 1.0;
    } else if (beyond > 0.0) {
      slope.gradient[2] = std::copysign(1.0, x[2]);
    } else {
      slope.is_inside = true;
    }
    return slope;
  }

  Found common(const Vector3d& x) const {
    const double across = radius_ - least_depth_;
    const bool is_deep = across > 0.0 && x.head<2>().squaredNorm() < across * across &&
                         std::abs(x[2]) < half_length_ - least_depth_;
    if (!is_deep) return {};
    return Gap{x, x, Vector3d::UnitZ(), true};
  }

  // The point of C nearest to x, and the normal there. `tangent`: the unit direction of the edge or
  // rim of O at x, or 0.
  Found fromPointOn(const Vector3d& x, const Vector3d& tangent) const {
    const double rho = std::sqrt(x[0] * x[0] + x[1] * x[1]);
    const double beside = rho - radius_, beyond = std::abs(x[2]) - half_length_;
    if (!(beside > 0.0 || beyond > 0.0)) return common(x);
    const Vector3d radial = rho > 0.0 ? Vector3d(x[0] / rho, x[1] / rho, 0.0) : Vector3d::UnitX();
    Gap gap{x, x, Vector3d::Zero()};
    if (beside > 0.0) {
      gap.on_cylinder.head<2>() = radius_ * radial.head<2>();
      gap.normal = beside * radial;
    }
    if (beyond > 0.0) {
      gap.on_cylinder[2] = std::copysign(half_length_, x[2]);
      gap.normal[2] = std::copysign(beyond, x[2]);
    }
    // Where the two nearly touch, the tangents know the normal better than the points.
    const Vector3d across = Vector3d(-radial[1], radial[0], 0.0).cross(tangent);
    if (beside > 0.0 && beyond > 0.0 && across.squaredNorm() > ACROSS * ACROSS) {
      gap.normal = across.dot(gap.normal) < 0.0 ? Vector3d(-across) : across;
    } else {
      gap.normal -= gap.normal.dot(tangent) * tangent;
    }
    gap.normal.normalize();
    return gap;
  }

  Found fromEdge(const Vector3d& from, const Vector3d& to, double radius) const {
    Found gap;
    if (facesRim()) gap = fromEdge(from, to, true);
    if (!gap) gap = fromEdge(from, to, false);
    if (gap && !gap->is_common) gap->on_other -= radius * gap->normal;
    return gap;
  }

  // Along an edge the distance is convex: Newton's method between two ends that enclose the least.
  // `to_rim`: as in fromRim().
  Found fromEdge(const Vector3d& from, const Vector3d& to, bool to_rim) const {
    const Vector3d edge = to - from;
    const double length = edge.norm();
    if (!(length > 0.0)) return {};
    const Vector3d e = edge / length;
    double low = 0.0, high = length, t = std::clamp((start_ - from).dot(e), low, high);
    for (int i = 0; i < MAX_STEPS; ++i) {
      const Vector3d x = from + t * e;
      const Slope slope = slopeAt(x, to_rim);
      if (slope.is_inside) return common(x);
      const double first = slope.gradient.dot(e), second = slope.curvature(e);
      if (to_rim && !(second > 0.0)) return {};
      (first > 0.0 ? high : low) = t;
      double next = first > 0.0 ? low : high;
      if (second > 0.0) next = std::clamp(t - first / second, low, high);
      const double step = std::abs(next - t);
      t = first == 0.0 ? t : next;
      if (first != 0.0 && step > SMALL * length) continue;
      const bool is_end = t == 0.0 || t == length;
      return fromPointOn(from + t * e, is_end ? Vector3d(Vector3d::Zero()) : e);
    }
    return {};
  }

  // n: a unit normal of a face of O, `height` its plane's from the origin along it.
  Gap fromFace(Vector3d n, double height) const {
    if (n.dot(normal_) > 0.0) n = -n, height = -height;
    Gap gap{start_, start_, -n};
    const double across = n.head<2>().norm(), beside = start_.head<2>().norm();
    if (across > PARALLEL) {
      gap.on_cylinder.head<2>() = (-radius_ / across) * n.head<2>();
    } else if (beside > radius_) {
      gap.on_cylinder.head<2>() *= radius_ / beside;
    }
    const double h = half_length_;
    gap.on_cylinder[2] =
        std::abs(n[2]) > PARALLEL ? std::copysign(h, -n[2]) : std::clamp(start_[2], -h, h);
    gap.on_other = gap.on_cylinder + (height - gap.on_cylinder.dot(n)) * n;
    return gap;
  }

  const Difference<double>& difference_;
  const bool is_a_;  // C is A
  const ConvexCore& other_;
  const double radius_, half_length_, least_depth_;
  const bool is_apart_;  // GJK has a separating plane
  Eigen::Matrix3d R_CO_;
  Vector3d p_CO_, start_, normal_;
  std::array<Vector3d, 4> vertex_;  // of the simplex, each point of O once
  int nb_vertices_ = 0;
};

}  // namespace collision_pairs
