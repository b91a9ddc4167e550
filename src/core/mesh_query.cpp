#include "mesh_query.h"

#include <algorithm>
#include <cmath>

#include "closest_on_mesh.h"
#include "convex_distance.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

// Surfaces this close, relative to the coordinates they were computed from, meet: what is left is
// rounding.
constexpr double MEET_TOLERANCE = 4e-16;

// Closest points of hulls this close to a surface, relative to the coordinates, are on it.
constexpr double PATCH_ROUNDING = 64.0 * std::numeric_limits<double>::epsilon();

double square(double x) { return x * x; }

Triangle moved(const Triangle& t, const Isometry3d& X) {
  return {X * t.v[0], X * t.v[1], X * t.v[2]};
}

double magnitude(const OrientedBox& a, const OrientedBox& b, const Isometry3d& X_AB) {
  return a.center.cwiseAbs().maxCoeff() + a.size() + b.center.cwiseAbs().maxCoeff() + b.size() +
         X_AB.translation().cwiseAbs().maxCoeff();
}

// Improves `gap` by one triangle of A against the solid B.
void improveByConvex(const Triangle& t, const ConvexCore& B, const Isometry3d& X_AB,
                     SurfaceGap& gap, std::uint32_t index) {
  if (B.kind == ConvexCore::Kind::POINT) {
    const Vector3d center = X_AB.translation();
    const Vector3d closest = closestOnTriangle(t, center);
    const double distance = (center - closest).norm();
    if (distance - B.radius >= gap.distance) return;
    gap.distance = distance - B.radius;
    gap.p_ACa = closest;
    gap.p_ACb =
        distance > 0.0 ? Vector3d(center - B.radius / distance * (center - closest)) : center;
  } else {
    const PairDistance found = convexGap(triangleCore(t), B, X_AB, gap.distance);
    if (found.certainty == Certainty::BEYOND || found.distance >= gap.distance) return;
    gap.distance = found.distance;
    gap.p_ACa = found.p_ACa;
    gap.p_ACb = found.p_ACb;
  }
  gap.triangle_a = index;
  gap.beyond = false;
  gap.by_hulls = false;
}

double roundingOf(const ConvexCore& a, const ConvexCore& b) {
  return PATCH_ROUNDING * (a.extent + a.center.norm() + b.extent + b.center.norm() + b.radius);
}

// Two patches by their hulls. True if that settles them: too far apart to matter, or the hulls'
// closest points are points of both surfaces.
bool comparePatches(const PreparedMesh& A, std::uint32_t a, const PreparedMesh& B, std::uint32_t b,
                    const Isometry3d& X_AB, ClosestPoints& best, SurfaceGap& gap) {
  const ConvexCore core_a = A.tree.patchCore(A.tree.node(a).patch);
  const ConvexCore core_b = B.tree.patchCore(B.tree.node(b).patch);
  const PairDistance hulls = convexGap(core_a, core_b, X_AB, std::sqrt(best.squared));
  if (hulls.certainty == Certainty::BEYOND) return true;
  const double rounding = roundingOf(core_a, core_b);
  if (hulls.certainty != Certainty::EXACT || hulls.distance <= rounding) return false;
  if (!isOnMesh(A, a, hulls.p_ACa, rounding)) return false;
  if (!isOnMesh(B, b, X_AB.inverse(Eigen::Isometry) * hulls.p_ACb, rounding)) return false;
  if (square(hulls.distance) >= best.squared) return true;
  best = {square(hulls.distance), hulls.p_ACa, hulls.p_ACb};
  gap.beyond = false;
  gap.by_hulls = true;
  gap.nhat_AB_A = hulls.nhat_AB_A;
  return true;
}

// Where contact is all that is of interest, boxes that overlap are split until triangles meet:
// the hulls of patches would say little.
bool worthHulls(const OrientedBox& a, const OrientedBox& b, double max_distance) {
  return max_distance > 0.01 * std::min(a.size(), b.size());
}

// The same for a patch and a convex solid.
bool comparePatch(const PreparedMesh& A, std::uint32_t a, const ConvexCore& B,
                  const Isometry3d& X_AB, SurfaceGap& gap) {
  const ConvexCore core = A.tree.patchCore(A.tree.node(a).patch);
  const PairDistance hulls = convexGap(core, B, X_AB, gap.distance);
  if (hulls.certainty == Certainty::BEYOND) return true;
  const double rounding = roundingOf(core, B);
  if (hulls.certainty != Certainty::EXACT || hulls.distance <= rounding) return false;
  if (!isOnMesh(A, a, hulls.p_ACa, rounding)) return false;
  if (hulls.distance >= gap.distance) return true;
  gap.distance = hulls.distance;
  gap.p_ACa = hulls.p_ACa;
  gap.p_ACb = hulls.p_ACb;
  gap.nhat_AB_A = hulls.nhat_AB_A;
  gap.beyond = false;
  gap.by_hulls = true;
  return true;
}

}  // namespace

Triangle triangleOf(const TriangleMesh& mesh, std::uint32_t index) {
  const auto& t = mesh.triangles[index];
  return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
}

ConvexCore triangleCore(const Triangle& t) {
  ConvexCore core;
  core.kind = ConvexCore::Kind::POINTS;
  core.points = t.v.data();
  core.num_points = 3;
  core.center = (t.v[0] + t.v[1] + t.v[2]) / 3.0;
  for (const Vector3d& v : t.v) core.extent = std::max(core.extent, (v - core.center).norm());
  return core;
}

SurfaceGap MeshQuery::meshMesh(const PreparedMesh& A, const PreparedMesh& B, const Isometry3d& X_AB,
                               double max_distance) {
  const Matrix3d R = X_AB.linear();
  const Vector3d p = X_AB.translation();
  const auto boxGap = [&](std::uint32_t a, std::uint32_t b) {
    return squaredBoxGap(A.tree.node(a).box, B.tree.node(b).box, R, p);
  };
  const double meet = MEET_TOLERANCE * magnitude(A.tree.node(0).box, B.tree.node(0).box, X_AB);
  SurfaceGap gap;
  gap.distance = std::sqrt(boxGap(0, 0));
  if (gap.distance > max_distance) return gap;
  gap.distance = std::nextafter(max_distance, std::numeric_limits<double>::infinity());
  // Found strictly below the limit: so that a gap equal to the limit is found too, one ulp more.
  ClosestPoints best{square(std::max(max_distance, meet)) * (1.0 + 1e-15)};
  const bool by_patches = worthHulls(A.tree.node(0).box, B.tree.node(0).box, max_distance);
  stack_.clear();
  stack_.push_back({0, 0, 0.0});
  while (!stack_.empty()) {
    const Entry entry = stack_.back();
    stack_.pop_back();
    if (entry.squared_gap > best.squared) continue;
    const TriangleTree::Node& a = A.tree.node(entry.a);
    const TriangleTree::Node& b = B.tree.node(entry.b);
    if (a.leaf && b.leaf) {
      const Triangle t = triangleOf(*A.triangles, a.child);
      const Triangle u = moved(triangleOf(*B.triangles, b.child), X_AB);
      if (!improveByTriangles(t, u, best)) continue;
      gap.beyond = false;
      gap.by_hulls = false;
      gap.triangle_a = a.child;
      gap.triangle_b = b.child;
      if (best.squared <= square(meet)) break;
      continue;
    }
    if (by_patches && a.isPatch() && b.isPatch() &&
        comparePatches(A, entry.a, B, entry.b, X_AB, best, gap)) {
      continue;
    }
    // Down to the patches on both sides first: between two patches their hulls may decide.
    const bool split_a = by_patches && a.above_patches != b.above_patches
                             ? a.above_patches
                             : !a.leaf && (b.leaf || a.box.size() >= b.box.size());
    Entry near = split_a ? Entry{a.child, entry.b, 0.0} : Entry{entry.a, b.child, 0.0};
    Entry far = split_a ? Entry{a.child + 1, entry.b, 0.0} : Entry{entry.a, b.child + 1, 0.0};
    near.squared_gap = boxGap(near.a, near.b);
    far.squared_gap = boxGap(far.a, far.b);
    if (far.squared_gap < near.squared_gap) std::swap(near, far);
    if (far.squared_gap <= best.squared) stack_.push_back(far);
    if (near.squared_gap <= best.squared) stack_.push_back(near);
  }
  if (gap.beyond) return gap;
  gap.distance = best.squared <= square(meet) ? 0.0 : std::sqrt(best.squared);
  gap.p_ACa = best.on_a;
  gap.p_ACb = best.on_b;
  return gap;
}

SurfaceGap MeshQuery::meshConvex(const PreparedMesh& A, const Prepared& B, const Isometry3d& X_AB,
                                 double max_distance) {
  const Matrix3d R = X_AB.linear();
  const Vector3d p = X_AB.translation();
  const auto boxGap = [&](std::uint32_t a) {
    return squaredBoxGap(A.tree.node(a).box, B.box, R, p);
  };
  const double meet = MEET_TOLERANCE * magnitude(A.tree.node(0).box, B.box, X_AB);
  SurfaceGap gap;
  gap.distance = std::sqrt(boxGap(0));
  if (gap.distance > max_distance) return gap;
  gap.distance = std::max(max_distance, meet) * (1.0 + 1e-15);
  const bool by_patches = worthHulls(A.tree.node(0).box, B.box, max_distance);
  stack_.clear();
  stack_.push_back({0, 0, 0.0});
  while (!stack_.empty()) {
    const Entry entry = stack_.back();
    stack_.pop_back();
    if (entry.squared_gap > square(gap.distance)) continue;
    const TriangleTree::Node& a = A.tree.node(entry.a);
    if (a.leaf) {
      improveByConvex(triangleOf(*A.triangles, a.child), B.core, X_AB, gap, a.child);
      if (!gap.beyond && gap.distance <= meet) break;
      continue;
    }
    if (by_patches && a.isPatch() && comparePatch(A, entry.a, B.core, X_AB, gap)) continue;
    Entry near{a.child, 0, boxGap(a.child)}, far{a.child + 1, 0, boxGap(a.child + 1)};
    if (far.squared_gap < near.squared_gap) std::swap(near, far);
    if (far.squared_gap <= square(gap.distance)) stack_.push_back(far);
    if (near.squared_gap <= square(gap.distance)) stack_.push_back(near);
  }
  if (gap.beyond) {
    gap.distance = std::nextafter(max_distance, std::numeric_limits<double>::infinity());
  }
  if (!gap.beyond && gap.distance <= meet) gap.distance = 0.0;
  return gap;
}

bool MeshQuery::meshHoldsMesh(const PreparedMesh& A, const PreparedMesh& B,
                              const Isometry3d& X_AB) {
  if (A.solid.empty()) return false;
  return std::any_of(B.part_points.begin(), B.part_points.end(),
                     [&](const Vector3d& p_BQ) { return A.solid.holds(X_AB * p_BQ); });
}

}  // namespace collision_pairs
