#include "mesh_bounds.h"

#include <limits>

#include "enclosure.h"

namespace collision_pairs {
namespace {

using Eigen::Vector3d;

constexpr double TIGHTNESS = 1e-4;  // of the largest extent
constexpr double ROUNDING = 16.0 * std::numeric_limits<double>::epsilon();

}  // namespace

MeshBounds::MeshBounds(const std::vector<Vector3d>& corners, double the_margin) {
  Vector3d lower = corners.front(), upper = lower;
  for (const Vector3d& p : corners) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  center = 0.5 * (lower + upper);
  FewerPoints fewer = fewerPoints(corners, TIGHTNESS * (upper - lower).maxCoeff());
  for (Vector3d& p : fewer.points) p -= center;
  points = PackedPoints(fewer.points);
  reach = (upper - lower).sum();
  margin = the_margin + fewer.margin + ROUNDING * (reach + center.cwiseAbs().sum());
}

Aabb MeshBounds::boxAt(const Eigen::Isometry3d& X_WE) const {
  Aabb box;
  points.extent(X_WE.linear(), box.min, box.max);
  const Vector3d p_WC = X_WE * center;
  const Vector3d outwards = Vector3d::Constant(margin) + ROUNDING * X_WE.translation().cwiseAbs();
  box.min += p_WC - outwards;
  box.max += p_WC + outwards;
  return box;
}

}  // namespace collision_pairs
