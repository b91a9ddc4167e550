#include "mesh_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <Eigen/Eigenvalues>

#include "convex_distance.h"
#include "convex_hull.h"
#include "covered_solid.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double TIGHTNESS = 1e-4;  // of the largest extent
constexpr double EPSILON = std::numeric_limits<double>::epsilon();
constexpr double BOX_ROUNDING = 16.0 * EPSILON;

Vector3d meanOf(const std::vector<Vector3d>& points) {
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& p : points) mean += p / static_cast<double>(points.size());
  return mean;
}

// Indices of `points`, first the outermost ones along 26 directions, then the others from the
// outside in, so that later points are seldom outside the hull of the earlier ones.
std::vector<std::size_t> outermostFirst(const std::vector<Vector3d>& points) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const Vector3d mean = meanOf(points);
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

/// Corners of the hull of planar points, counter-clockwise (Andrew's monotone chain, 1979).
std::vector<Vector2d> planarHull(std::vector<Vector2d> points) {
  const auto less = [](const Vector2d& a, const Vector2d& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  };
  std::sort(points.begin(), points.end(), less);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<Vector2d> hull;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t base = hull.size();
    for (const Vector2d& p : points) {
      while (hull.size() >= base + 2) {
        const Vector2d last = hull.back() - hull[hull.size() - 2];
        const Vector2d next = p - hull.back();
        if (last.x() * next.y() - last.y() * next.x() > 0.0) break;
        hull.pop_back();
      }
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

Vector3d extentAlong(const Matrix3d& R_EO, const std::vector<Vector3d>& points, Vector3d& lower) {
  lower = Vector3d::Constant(std::numeric_limits<double>::infinity());
  Vector3d upper = -lower;
  for (const Vector3d& p_E : points) {
    const Vector3d p_O = R_EO.transpose() * p_E;
    lower = lower.cwiseMin(p_O);
    upper = upper.cwiseMax(p_O);
  }
  return upper - lower;
}

/// Rotates `R_EO` about its own axis `k` to the smallest cross section of the points.
Matrix3d turnedForLeastSection(const Matrix3d& R_EO, int k, const std::vector<Vector3d>& points) {
  const Vector3d u = R_EO.col((k + 1) % 3), v = R_EO.col((k + 2) % 3);
  std::vector<Vector2d> section;
  section.reserve(points.size());
  for (const Vector3d& p : points) section.emplace_back(u.dot(p), v.dot(p));
  section = planarHull(std::move(section));
  double least = std::numeric_limits<double>::infinity();
  double best_angle = 0.0;
  for (std::size_t i = 0; i < section.size(); ++i) {
    const Vector2d edge = section[(i + 1) % section.size()] - section[i];
    if (edge.isZero(0.0)) continue;
    const Eigen::Rotation2Dd turn(-std::atan2(edge.y(), edge.x()));
    Vector2d lower = Vector2d::Constant(std::numeric_limits<double>::infinity()), upper = -lower;
    for (const Vector2d& p : section) {
      lower = lower.cwiseMin(turn * p);
      upper = upper.cwiseMax(turn * p);
    }
    const double area = (upper - lower).prod();
    if (area < least) {
      least = area;
      best_angle = std::atan2(edge.y(), edge.x());
    }
  }
  // Eigenvectors are orthonormal to 30 roundings only, which the margin would not hold.
  const Eigen::AngleAxisd turn(best_angle, R_EO.col(k));
  return Eigen::Quaterniond(turn.toRotationMatrix() * R_EO).normalized().toRotationMatrix();
}

Matrix3d principalAxes(const std::vector<Vector3d>& points) {
  const Vector3d mean = meanOf(points);
  Matrix3d covariance = Matrix3d::Zero();
  for (const Vector3d& p : points) covariance += (p - mean) * (p - mean).transpose();
  Matrix3d axes = Eigen::SelfAdjointEigenSolver<Matrix3d>(covariance).eigenvectors();
  if (axes.determinant() < 0.0) axes.col(0) *= -1.0;
  return axes;
}

std::pair<Box, Isometry3d> boxAroundPoints(const std::vector<Vector3d>& points) {
  double least = std::numeric_limits<double>::infinity();
  std::pair<Box, Isometry3d> best;
  const double margin = 16.0 * EPSILON * reachOf(points);
  for (const Matrix3d& axes : {Matrix3d(Matrix3d::Identity()), principalAxes(points)}) {
    for (int k = 0; k < 3; ++k) {
      const Matrix3d R_EO = turnedForLeastSection(axes, k, points);
      Vector3d lower;
      const Vector3d extent = extentAlong(R_EO, points, lower);
      // The surface area decides between flat boxes, whose volumes are all 0.
      const double measure =
          extent.prod() +
          1e-6 * extent.maxCoeff() *
              (extent.x() * extent.y() + extent.y() * extent.z() + extent.z() * extent.x());
      if (measure >= least) continue;
      least = measure;
      best.first.size = extent + Vector3d::Constant(2.0 * margin);
      best.second = Isometry3d::Identity();
      best.second.linear() = R_EO;
      best.second.translation() = R_EO * (lower + 0.5 * extent);
    }
  }
  return best;
}

struct BoxVisitor {
  using Result = std::pair<Box, Isometry3d>;
  static Result centred(const Vector3d& size) { return {Box{size}, Isometry3d::Identity()}; }
  Result operator()(const Box& box) const { return centred(box.size); }
  Result operator()(const Sphere& s) const { return centred(Vector3d::Constant(2.0 * s.radius)); }
  Result operator()(const Cylinder& c) const {
    return centred({2.0 * c.radius, 2.0 * c.radius, c.length});
  }
  Result operator()(const Capsule& c) const {
    return centred({2.0 * c.radius, 2.0 * c.radius, (c.length + 2.0 * c.radius) * (1.0 + EPSILON)});
  }
  Result operator()(const HalfSpace&) const {
    return centred(Vector3d::Constant(std::numeric_limits<double>::max()));
  }
  Result operator()(const Convex& convex) const { return boxAroundPoints(convex.mesh->vertices); }
  Result operator()(const Mesh& mesh) const {
    return boxAroundPoints(hullVertices(*mesh.mesh)->vertices);
  }
};

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
      taken.nb_points = static_cast<int>(fewer.points.size());
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
  const auto [lower, upper] = boxAround(corners);
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
  // Along every axis, as computeAabb() does.
  const Vector3d outwards =
      Vector3d::Constant(margin + (BOX_ROUNDING * X_WE.translation().cwiseAbs()).sum());
  box.min += p_WC - outwards;
  box.max += p_WC + outwards;
  return box;
}

std::pair<Box, Isometry3d> enclosingBox(const Shape& shape) {
  return std::visit(BoxVisitor{}, shape);
}

}  // namespace collision_pairs
