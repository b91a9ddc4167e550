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
    const PairDistance found = convexGap(cornersCore(t.v), B, X_AB, gap.distance);
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

// A patch by the corners of it, a triangle by its own; `corners` holds these.
ConvexCore pieceCore(const PreparedMesh& mesh, const TriangleTree::Node& node, Corners& corners) {
  if (node.isPatch()) return mesh.tree.patchCore(node.patch);
  const auto& t = mesh.triangles->triangles[node.children];
  for (int k = 0; k < 3; ++k) corners[k] = mesh.triangles->vertices[t[k]];
  return cornersCore(corners);
}

// What is known of two patches, or of a triangle and a patch, by their hulls.
enum class Compared {
  SETTLED,     // too far apart to matter, or the hulls' closest points are on both surfaces
  NOT_ON_A,    // the closest point of A's hull is not on its surface
  NOT_ON_B,    // that of B's is not
  HULLS_TOUCH  // or nearly
};

Compared comparePieces(const PreparedMesh& A, std::uint32_t a, const PreparedMesh& B,
                       std::uint32_t b, const Isometry3d& X_AB, const Isometry3d& X_BA,
                       ClosestPoints& best, SurfaceGap& gap) {
  Corners corners_a, corners_b;
  const ConvexCore core_a = pieceCore(A, A.tree.node(a), corners_a);
  const ConvexCore core_b = pieceCore(B, B.tree.node(b), corners_b);
  const PairDistance hulls = convexGap(core_a, core_b, X_AB, std::sqrt(best.squared));
  if (hulls.certainty == Certainty::BEYOND) return Compared::SETTLED;
  const double rounding = roundingOf(core_a, core_b);
  if (hulls.certainty != Certainty::EXACT || hulls.distance <= rounding) {
    return Compared::HULLS_TOUCH;
  }
  if (!isOnMesh(A, a, hulls.p_ACa, rounding)) return Compared::NOT_ON_A;
  if (!isOnMesh(B, b, X_BA * hulls.p_ACb, rounding)) return Compared::NOT_ON_B;
  if (square(hulls.distance) >= best.squared) return Compared::SETTLED;
  best = {square(hulls.distance), hulls.p_ACa, hulls.p_ACb};
  gap.beyond = false;
  gap.by_hulls = true;
  gap.nhat_AB_A = hulls.nhat_AB_A;
  return Compared::SETTLED;
}

// Which of two nodes to split that are not both leaves: down to the patches on both sides first,
// for between two patches their hulls may decide; then the one whose hull is not its surface, down
// to its triangles, while the other one's hull may still be; else the larger.
bool splitsA(const TriangleTree::Node& a, const TriangleTree::Node& b, bool by_patches,
             Compared compared) {
  if (a.isLeaf() || b.isLeaf()) return b.isLeaf();
  if (by_patches && a.above_patches != b.above_patches) return a.above_patches;
  if (compared == Compared::NOT_ON_A) return true;
  if (compared == Compared::NOT_ON_B) return false;
  if (by_patches && a.isPatch() != b.isPatch()) return b.isPatch();
  return a.size >= b.size;
}

bool isPiece(const TriangleTree::Node& node) { return node.isPatch() || node.isLeaf(); }

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

ConvexCore cornersCore(const Corners& corners) {
  ConvexCore core;
  core.kind = ConvexCore::Kind::POINTS;
  core.points = corners.data();
  core.num_points = 3;
  core.center = (corners[0] + corners[1] + corners[2]) / 3.0;
  for (const Vector3d& v : corners) core.extent = std::max(core.extent, (v - core.center).norm());
  return core;
}

void MeshQuery::pushNearestLast(const Entry& parent, bool of_a, const TriangleTree::Node& split,
                                const FourGaps& gaps, double limit) {
  const std::size_t first = stack_.size();
  for (std::uint32_t i = 0; i < split.nb_children; ++i) {
    if (gaps.of[i] > limit) continue;
    const std::uint32_t child = split.children + i;
    Entry entry = of_a ? Entry{child, parent.b, gaps.of[i]} : Entry{parent.a, child, gaps.of[i]};
    entry.squared_gap = std::max(entry.squared_gap, slabs_.squaredGap(entry.a, entry.b));
    if (entry.squared_gap > limit) continue;
    std::size_t place = stack_.size();
    stack_.push_back(entry);
    for (; place > first && stack_[place - 1].squared_gap < entry.squared_gap; --place) {
      stack_[place] = stack_[place - 1];
    }
    stack_[place] = entry;
  }
}

SurfaceGap MeshQuery::meshMesh(const PreparedMesh& A, const PreparedMesh& B, const Isometry3d& X_AB,
                               double max_distance, const Vector3d* nhat_AB_A) {
  const Isometry3d X_BA = X_AB.inverse(Eigen::Isometry);
  const OrientedBox box_a = A.tree.box(0), box_b = B.tree.box(0);
  const double meet = MEET_TOLERANCE * magnitude(box_a, box_b, X_AB);
  SurfaceGap gap;
  gap.distance = std::sqrt(squaredBoxGap(box_a, box_b.movedBy(X_AB)));
  if (gap.distance > max_distance) return gap;
  gap.distance = std::nextafter(max_distance, std::numeric_limits<double>::infinity());
  // Found strictly below the limit: so that a gap equal to the limit is found too, one ulp more.
  ClosestPoints best{square(std::max(max_distance, meet)) * (1.0 + 1e-15)};
  const bool by_patches = worthHulls(box_a, box_b, max_distance);
  slabs_.clear();
  if (by_patches && nhat_AB_A != nullptr) slabs_.set(A, B, X_AB, *nhat_AB_A);
  stack_.clear();
  stack_.push_back({0, 0, 0.0});
  while (!stack_.empty()) {
    const Entry entry = stack_.back();
    stack_.pop_back();
    if (entry.squared_gap > best.squared) continue;
    const TriangleTree::Node& a = A.tree.node(entry.a);
    const TriangleTree::Node& b = B.tree.node(entry.b);
    if (a.isLeaf() && b.isLeaf()) {
      const Triangle t = triangleOf(*A.triangles, a.children);
      const Triangle u = moved(triangleOf(*B.triangles, b.children), X_AB);
      if (!improveByTriangles(t, u, best)) continue;
      gap.beyond = false;
      gap.by_hulls = false;
      gap.triangle_a = a.children;
      gap.triangle_b = b.children;
      if (best.squared <= square(meet)) break;
      continue;
    }
    Compared compared = Compared::HULLS_TOUCH;
    if (by_patches && isPiece(a) && isPiece(b)) {
      compared = comparePieces(A, entry.a, B, entry.b, X_AB, X_BA, best, gap);
      if (compared == Compared::SETTLED) continue;
    }
    const bool split_a = splitsA(a, b, by_patches, compared);
    const FourGaps gaps =
        split_a ? squaredBoxGaps(A.tree.childBoxes(a), B.tree.box(entry.b).movedBy(X_AB))
                : squaredBoxGaps(B.tree.childBoxes(b), A.tree.box(entry.a).movedBy(X_BA));
    pushNearestLast(entry, split_a, split_a ? a : b, gaps, best.squared);
  }
  if (gap.beyond) return gap;
  gap.distance = best.squared <= square(meet) ? 0.0 : std::sqrt(best.squared);
  gap.p_ACa = best.on_a;
  gap.p_ACb = best.on_b;
  return gap;
}

// Children are written to the stack whether they overlap or not, and kept by moving its end: a
// branch for each would be guessed wrong half of the time.
void MeshQuery::pushOverlaps(const NodePair& parent, bool of_a, const TriangleTree::Node& split,
                             const FourGaps& gaps, double limit) {
  if (overlaps_.size() < nb_overlaps_ + BOX_LANES) overlaps_.resize(2 * overlaps_.size() + 64);
  for (std::uint32_t i = 0; i < BOX_LANES; ++i) {
    NodePair& place = overlaps_[nb_overlaps_];
    place.a = of_a ? split.children + i : parent.a;
    place.b = of_a ? parent.b : split.children + i;
    nb_overlaps_ += static_cast<std::size_t>((i < split.nb_children) & (gaps.of[i] <= limit));
  }
}

// Boxes that overlap say nothing about which of them hold triangles that meet, so they are not put
// in order, nor are hulls asked.
bool MeshQuery::surfacesMeet(const PreparedMesh& A, const PreparedMesh& B, const Isometry3d& X_AB) {
  const Isometry3d X_BA = X_AB.inverse(Eigen::Isometry);
  const OrientedBox box_a = A.tree.box(0), box_b = B.tree.box(0);
  if (squaredBoxGap(box_a, box_b.movedBy(X_AB)) > 0.0) return false;
  const double limit = square(MEET_TOLERANCE * magnitude(box_a, box_b, X_AB));
  ClosestPoints best{limit * (1.0 + 1e-15)};
  overlaps_.resize(std::max<std::size_t>(overlaps_.size(), 1));
  overlaps_[0] = {0, 0};
  nb_overlaps_ = 1;
  while (nb_overlaps_ > 0) {
    const NodePair pair = overlaps_[--nb_overlaps_];
    const TriangleTree::Node& a = A.tree.node(pair.a);
    const TriangleTree::Node& b = B.tree.node(pair.b);
    if (a.isLeaf() && b.isLeaf()) {
      const Triangle t = triangleOf(*A.triangles, a.children);
      const Triangle u = moved(triangleOf(*B.triangles, b.children), X_AB);
      if (improveByTriangles(t, u, best)) return true;
      continue;
    }
    const bool split_a = !a.isLeaf() && (b.isLeaf() || a.size >= b.size);
    const FourGaps gaps =
        split_a ? squaredBoxGaps(A.tree.childBoxes(a), B.tree.box(pair.b).movedBy(X_AB))
                : squaredBoxGaps(B.tree.childBoxes(b), A.tree.box(pair.a).movedBy(X_BA));
    pushOverlaps(pair, split_a, split_a ? a : b, gaps, limit);
  }
  return false;
}

SurfaceGap MeshQuery::meshConvex(const PreparedMesh& A, const Prepared& B, const Isometry3d& X_AB,
                                 double max_distance) {
  const OrientedBox box_a = A.tree.box(0), box_b = B.box.movedBy(X_AB);
  const double meet = MEET_TOLERANCE * magnitude(box_a, B.box, X_AB);
  SurfaceGap gap;
  gap.distance = std::sqrt(squaredBoxGap(box_a, box_b));
  if (gap.distance > max_distance) return gap;
  gap.distance = std::max(max_distance, meet) * (1.0 + 1e-15);
  const bool by_patches = worthHulls(box_a, box_b, max_distance);
  slabs_.clear();
  stack_.clear();
  stack_.push_back({0, 0, 0.0});
  while (!stack_.empty()) {
    const Entry entry = stack_.back();
    stack_.pop_back();
    if (entry.squared_gap > square(gap.distance)) continue;
    const TriangleTree::Node& a = A.tree.node(entry.a);
    if (a.isLeaf()) {
      improveByConvex(triangleOf(*A.triangles, a.children), B.core, X_AB, gap, a.children);
      if (!gap.beyond && gap.distance <= meet) break;
      continue;
    }
    if (by_patches && a.isPatch() && comparePatch(A, entry.a, B.core, X_AB, gap)) continue;
    const FourGaps gaps = squaredBoxGaps(A.tree.childBoxes(a), box_b);
    pushNearestLast(entry, true, a, gaps, square(gap.distance));
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
