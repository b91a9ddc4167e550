#include "collision_pairs/aabb.h"

#include <cmath>
#include <limits>

namespace collision_pairs {
namespace {

using Eigen::Vector3d;

// What the box of a body is enlarged by along every axis, of the lengths of all axes. A coordinate
// is a sum of at most four products, and off by a few units in the last place of the largest
// partial sum: eight units are enough. The other eight are the body's share of contactBand(), which
// knows no axes, so that boxes of bodies in contact meet.
constexpr double ROUNDING = 16.0 * std::numeric_limits<double>::epsilon();

Aabb aroundCenter(const Vector3d& center, const Vector3d& half) {
  const Vector3d outwards = half.array() + (ROUNDING * (half + center.cwiseAbs())).sum();
  return {center - outwards, center + outwards};
}

// Extent of a unit disc with the unit normal n along each axis: sqrt(1 - n_i^2), in a form without
// cancellation if n_i is close to one. Not std::hypot(), which takes several times as long: squares
// that underflow are smaller than the error bound.
Vector3d discExtent(const Vector3d& n) {
  constexpr double UNDERFLOW_BOUND = 1e-300;
  const Vector3d squared = n.cwiseAbs2();
  const Vector3d across(squared.y() + squared.z(), squared.x() + squared.z(),
                        squared.x() + squared.y());
  return (across.array() + UNDERFLOW_BOUND).sqrt();
}

Aabb aroundVertices(const TriangleMesh& mesh, const Eigen::Isometry3d& X_WE) {
  const Eigen::Matrix3d R_WE = X_WE.linear();
  Vector3d lower = Vector3d::Constant(std::numeric_limits<double>::infinity());
  Vector3d upper = -lower;
  Vector3d reach = Vector3d::Zero();  // of the vertices from E's origin, for the rounding bound
  for (const Vector3d& p_EV : mesh.vertices) {
    const Vector3d v = R_WE * p_EV;
    lower = lower.cwiseMin(v);
    upper = upper.cwiseMax(v);
    reach = reach.cwiseMax(p_EV.cwiseAbs());
  }
  const Vector3d slack =
      Vector3d::Constant((ROUNDING * (reach + X_WE.translation().cwiseAbs())).sum());
  return {X_WE.translation() + lower - slack, X_WE.translation() + upper + slack};
}

struct AabbVisitor {
  const Eigen::Isometry3d& X_WE;

  Vector3d axis() const { return X_WE.linear().col(2); }
  Vector3d center() const { return X_WE.translation(); }

  Aabb operator()(const Box& box) const {
    return aroundCenter(center(), X_WE.linear().cwiseAbs() * (0.5 * box.size));
  }
  Aabb operator()(const Sphere& sphere) const {
    return aroundCenter(center(), Vector3d::Constant(sphere.radius));
  }
  Aabb operator()(const Cylinder& cylinder) const {
    return aroundCenter(
        center(), cylinder.radius * discExtent(axis()) + 0.5 * cylinder.length * axis().cwiseAbs());
  }
  Aabb operator()(const Capsule& capsule) const {
    return aroundCenter(
        center(), Vector3d::Constant(capsule.radius) + 0.5 * capsule.length * axis().cwiseAbs());
  }
  Aabb operator()(const HalfSpace&) const {
    const double everywhere = std::numeric_limits<double>::max();
    Aabb box{Vector3d::Constant(-everywhere), Vector3d::Constant(everywhere)};
    const Vector3d normal = X_WE.linear().col(2);
    const Vector3d p = X_WE.translation();
    const double slack = (ROUNDING * p.cwiseAbs()).sum();
    for (int k = 0; k < 3; ++k) {
      if (normal == Vector3d::Unit(k)) box.max[k] = p[k] + slack;
      if (normal == -Vector3d::Unit(k)) box.min[k] = p[k] - slack;
    }
    return box;
  }
  Aabb operator()(const Convex& convex) const { return aroundVertices(*convex.mesh, X_WE); }
  Aabb operator()(const Mesh& mesh) const { return aroundVertices(*mesh.mesh, X_WE); }
};

}  // namespace

Aabb computeAabb(const Shape& shape, const Eigen::Isometry3d& X_WE) {
  return std::visit(AabbVisitor{X_WE}, shape);
}

}  // namespace collision_pairs
