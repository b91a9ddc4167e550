#include "mesh_query.h"

#include <algorithm>
#include <cmath>

#include "convex_distance.h"
#include "surface_contact.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

// Updates `gap` with one triangle of A against the solid B.
void improveByConvex(const Triangle& t, const ConvexCore& B, const Isometry3d& X_AB, double band,
                     SearchLimit& limit, SurfaceGap& gap, std::uint32_t index) {
  if (B.kind == ConvexCore::Kind::POINT) {
    const Vector3d center = X_AB.translation();
    const Vector3d closest = closestOnTriangle(t, center);
    const double distance = (center - closest).norm();
    if (distance - B.radius >= gap.distance) return;
    gap.distance = distance - B.radius > band ? distance - B.radius : 0.0;
    gap.p_ACa = closest;
    gap.p_ACb =
        distance > 0.0 ? Vector3d(center - B.radius / distance * (center - closest)) : center;
  } else {
    const PairDistance found = convexGap(cornersCore(t.v), B, X_AB, gap.distance, band);
    if (found.certainty == Certainty::BEYOND || found.distance >= gap.distance) return;
    gap.distance = std::max(found.distance, 0.0);
    gap.p_ACa = found.p_ACa;
    gap.p_ACb = found.p_ACb;
  }
  gap.triangle_a = index;
  gap.beyond = false;
  gap.by_hulls = false;
  limit.found(square(gap.distance));
}

// Which of two nodes to split, if they are not both leaves. First both down to patches, since the
// hulls of two patches may settle the pair. Then the one whose hull's closest point is not on its
// surface, down to its triangles, as long as the other's may be. Else the larger.
bool splitsA(const TriangleTree::Node& a, const TriangleTree::Node& b, bool by_patches,
             PatchOutcome outcome) {
  if (a.isLeaf() || b.isLeaf()) return b.isLeaf();
  if (by_patches && a.above_patches != b.above_patches) return a.above_patches;
  if (outcome == PatchOutcome::NOT_ON_A) return true;
  if (outcome == PatchOutcome::NOT_ON_B) return false;
  if (by_patches && a.isPatch() != b.isPatch()) return b.isPatch();
  return a.size >= b.size;
}

bool isPiece(const TriangleTree::Node& node) { return node.isPatch() || node.isLeaf(); }

// If only contact matters, overlapping boxes are split until triangles intersect: the hulls of
// patches would rarely settle anything.
bool worthHulls(const OrientedBox& a, const OrientedBox& b, double max_distance) {
  return max_distance > 0.01 * std::min(a.size(), b.size());
}

}  // namespace

void MeshQuery::pushNearestLast(const Entry& parent, bool of_a, const TriangleTree::Node& split,
                                const FourGaps& gaps, SearchLimit& limit) {
  const std::size_t first = stack_.size();
  for (std::uint32_t i = 0; i < split.nb_children; ++i) {
    if (limit.excludes(gaps.of[i])) continue;
    const std::uint32_t child = split.children + i;
    Entry entry = of_a ? Entry{child, parent.b, gaps.of[i]} : Entry{parent.a, child, gaps.of[i]};
    entry.squared_gap = std::max(entry.squared_gap, slabs_.squaredGap(entry.a, entry.b));
    if (limit.excludes(entry.squared_gap)) continue;
    std::size_t place = stack_.size();
    stack_.push_back(entry);
    for (; place > first && stack_[place - 1].squared_gap < entry.squared_gap; --place) {
      stack_[place] = stack_[place - 1];
    }
    stack_[place] = entry;
  }
}

SurfaceGap MeshQuery::meshMesh(const PreparedMesh& A, const PreparedMesh& B, const Isometry3d& X_AB,
                               double max_distance, double band, const Vector3d* nhat_AB_A,
                               const Accuracy& accuracy) {
  const Isometry3d X_BA = X_AB.inverse(Eigen::Isometry);
  const OrientedBox box_a = A.tree.box(0), box_b = B.tree.box(0);
  SurfaceGap gap;
  gap.distance = std::sqrt(squaredBoxGap(box_a, box_b.movedBy(X_AB)));
  if (gap.distance > std::max(max_distance, band)) return gap;
  gap.distance = std::nextafter(max_distance, std::numeric_limits<double>::infinity());
  // The search finds gaps strictly below its limit; one ulp more includes a gap equal to it.
  ClosestPoints best{square(std::max(max_distance, band)) * (1.0 + 1e-15)};
  SearchLimit limit(best.squared, accuracy);
  Vector3d apart_along = nhat_AB_A != nullptr ? *nhat_AB_A : Vector3d::UnitX();
  const bool by_patches = worthHulls(box_a, box_b, max_distance);
  slabs_.clear();
  if (by_patches && nhat_AB_A != nullptr) slabs_.set(A, B, X_AB, *nhat_AB_A);
  stack_.clear();
  stack_.push_back({0, 0, 0.0});
  while (!stack_.empty()) {
    const Entry entry = stack_.back();
    stack_.pop_back();
    if (limit.excludes(entry.squared_gap)) continue;
    const TriangleTree::Node& a = A.tree.node(entry.a);
    const TriangleTree::Node& b = B.tree.node(entry.b);
    if (a.isLeaf() && b.isLeaf()) {
      const Triangle t = triangleOf(*A.triangles, a.children);
      const Triangle u(moved(cornersOf(*B.triangles, b.children), X_AB));
      if (!improveByTriangles(t, u, best)) continue;
      gap.beyond = false;
      gap.by_hulls = false;
      gap.triangle_a = a.children;
      gap.triangle_b = b.children;
      limit.found(best.squared);
      if (best.squared <= square(band)) break;
      continue;
    }
    PatchOutcome outcome = PatchOutcome::HULLS_TOUCH;
    if (by_patches && isPiece(a) && isPiece(b)) {
      outcome = comparePatches(A, entry.a, B, entry.b, X_AB, X_BA, apart_along, limit, best, gap);
      if (outcome == PatchOutcome::SETTLED) continue;
    }
    const bool split_a = splitsA(a, b, by_patches, outcome);
    const FourGaps gaps = split_a ? A.tree.squaredGaps(a, B.tree, entry.b, X_AB)
                                  : B.tree.squaredGaps(b, A.tree, entry.a, X_BA);
    pushNearestLast(entry, split_a, split_a ? a : b, gaps, limit);
  }
  if (gap.beyond) return gap;
  gap.distance = best.squared <= square(band) ? 0.0 : std::sqrt(best.squared);
  gap.lower = limit.lowerEnd(gap.distance);
  gap.p_ACa = best.on_a;
  gap.p_ACb = best.on_b;
  return gap;
}

SurfaceGap MeshQuery::meshConvex(const PreparedMesh& A, const ConvexCore& B, const Isometry3d& X_AB,
                                 double max_distance, double band, const Accuracy& accuracy) {
  const OrientedBox box_a = A.tree.box(0), box_b = boxAround(B).movedBy(X_AB);
  SurfaceGap gap;
  gap.distance = std::sqrt(squaredBoxGap(box_a, box_b));
  if (gap.distance > std::max(max_distance, band)) return gap;
  gap.distance = std::max(max_distance, band) * (1.0 + 1e-15);
  SearchLimit limit(square(gap.distance), accuracy);
  Vector3d apart_along = Vector3d::UnitX();
  const bool by_patches = worthHulls(box_a, box_b, max_distance);
  slabs_.clear();
  stack_.clear();
  stack_.push_back({0, 0, 0.0});
  while (!stack_.empty()) {
    const Entry entry = stack_.back();
    stack_.pop_back();
    if (limit.excludes(entry.squared_gap)) continue;
    const TriangleTree::Node& a = A.tree.node(entry.a);
    if (a.isLeaf()) {
      improveByConvex(triangleOf(*A.triangles, a.children), B, X_AB, band, limit, gap, a.children);
      if (!gap.beyond && gap.distance == 0.0) break;
      continue;
    }
    if (by_patches && a.isPatch() &&
        comparePatch(A, entry.a, B, X_AB, apart_along, limit, gap) == PatchOutcome::SETTLED) {
      continue;
    }
    const FourGaps gaps = squaredBoxGaps(A.tree.childBoxes(a), box_b);
    pushNearestLast(entry, true, a, gaps, limit);
  }
  if (gap.beyond) {
    gap.distance = std::nextafter(max_distance, std::numeric_limits<double>::infinity());
    return gap;
  }
  gap.lower = limit.lowerEnd(gap.distance);
  return gap;
}

}  // namespace collision_pairs
