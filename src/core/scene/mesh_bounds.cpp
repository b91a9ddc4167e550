#include "mesh_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "convex_distance.h"
#include "convex_hull.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double TIGHTNESS = 1e-4;  // of the largest extent
constexpr double EPSILON = std::numeric_limits<double>::epsilon();
constexpr double BOX_ROUNDING = 16.0 * EPSILON;

// Indices of `points`, first the outermost ones along 26 directions, then the others from the
// outside in, so that later points are seldom outside the hull of the earlier ones.
std::vector<std::size_t> outermostFirst(const std::vector<Vector3d>& points) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& p : points) mean += p / static_cast<double>(points.size());
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return (points[a] - mean).squaredNorm() > (points[b] - mean).squaredNorm();
  });
  std::vector<std::size_t> first;
  for (int i = 0; i < 27; ++i) {
    const Vector3d direction(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    if (direction.isZero()) continue;
    first.push_back(
        *std::max_element(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
          return direction.dot(points[a]) < direction.dot(points[b]);
        }));
  }
  first.insert(first.end(), order.begin(), order.end());
  return first;
}

}  // namespace

double reachOf(const std::vector<Vector3d>& points) {
  double reach = 0.0;
  for (const Vector3d& p : points) reach = std::max(reach, p.cwiseAbs().maxCoeff());
  return reach;
}

double hullMargin(const TriangleMesh& mesh) { return 64.0 * EPSILON * reachOf(mesh.vertices); }

std::shared_ptr<const TriangleMesh> hullVertices(const TriangleMesh& mesh) {
  auto hull = std::make_shared<TriangleMesh>();
  hull->name = mesh.name;
  hull->vertices = convexHull(mesh.vertices).points.vertices;
  return hull;
}

FewerPoints fewerPoints(const std::vector<Vector3d>& points, double tolerance) {
  FewerPoints fewer;
  fewer.margin = tolerance + 64.0 * EPSILON * reachOf(points);
  ConvexCore taken, point;
  taken.kind = ConvexCore::Kind::POINTS;
  Isometry3d X = Isometry3d::Identity();
  for (const std::size_t i : outermostFirst(points)) {
    if (!fewer.points.empty()) {
      taken.points = fewer.points.data();
      taken.num_points = static_cast<int>(fewer.points.size());
      taken.center = fewer.points.front();
      taken.extent = std::max(taken.extent, (points[i] - taken.center).norm());
      X.translation() = points[i];
      const PairDistance gap = convexGap(taken, point, X, tolerance, tolerance);
      if (gap.certainty != Certainty::DEGRADED && gap.touches()) continue;
    }
    fewer.points.push_back(points[i]);
  }
  return fewer;
}

FewerPoints atMostPoints(const std::vector<Vector3d>& points, std::size_t max_points) {
  if (points.size() <= max_points) return {points, 0.0};
  constexpr int HALVINGS = 20;
  double lower = 1e-6 * reachOf(points), upper = 4.0 * reachOf(points);  // upper: one point does
  FewerPoints best = fewerPoints(points, upper);
  for (int i = 0; i < HALVINGS; ++i) {
    const double middle = std::sqrt(lower * upper);
    FewerPoints fewer = fewerPoints(points, middle);
    const bool few_enough = fewer.points.size() <= max_points;
    (few_enough ? upper : lower) = middle;
    if (few_enough) best = std::move(fewer);
  }
  return best;
}

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
  margin = the_margin + fewer.margin + BOX_ROUNDING * (reach + center.cwiseAbs().sum());
}

Aabb MeshBounds::boxAt(const Eigen::Isometry3d& X_WE) const {
  Aabb box;
  points.extent(X_WE.linear(), box.min, box.max);
  const Vector3d p_WC = X_WE * center;
  const Vector3d outwards =
      Vector3d::Constant(margin) + BOX_ROUNDING * X_WE.translation().cwiseAbs();
  box.min += p_WC - outwards;
  box.max += p_WC + outwards;
  return box;
}

}  // namespace collision_pairs
