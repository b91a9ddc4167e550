#include "patch_hulls.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "convex_distance.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

void setGap(double distance, const Vector3d& p_ACa, const Vector3d& p_ACb,
            const Vector3d& nhat_AB_A, SurfaceGap& gap) {
  gap.distance = distance;
  gap.p_ACa = p_ACa;
  gap.p_ACb = p_ACb;
  gap.nhat_AB_A = nhat_AB_A;
  gap.beyond = false;
  gap.by_hulls = true;
}

// The closest points of two hulls unless they are beyond the limit. Most are, and the normal that
// proved it for their neighbours proves it for most of them.
std::optional<PairDistance> gapWithin(const ConvexCore& a, const ConvexCore& b,
                                      const Isometry3d& X_AB, Vector3d& nhat_AB_A,
                                      SearchLimit& limit) {
  const double reach = std::sqrt(limit.squared());
  const double along = gapAlong(nhat_AB_A, a, b, X_AB);
  if (along > reach) {
    limit.leaveOut(square(along));
    return std::nullopt;
  }
  const PairDistance hulls = convexGap(a, b, X_AB, reach, roundingOf(a, b));
  if (hulls.distance > 0.0) nhat_AB_A = hulls.nhat_AB_A;
  if (hulls.certainty != Certainty::BEYOND) return hulls;
  limit.leaveOut(square(hulls.distance));
  return std::nullopt;
}

// For hulls whose closest points are not both on the surfaces: true if their distance excludes the
// pair.
bool isNearEnough(const PairDistance& hulls, const ConvexCore& a, const ConvexCore& b,
                  SearchLimit& limit) {
  const double lower = lowerEndOfGap(hulls, a, b);
  return lower > 0.0 && limit.excludes(square(lower));
}

}  // namespace

ConvexCore pieceCore(const PreparedMesh& mesh, const TriangleTree::Node& node, Corners& corners) {
  if (node.isPatch()) return mesh.tree.patchCore(node.patch);
  corners = cornersOf(*mesh.triangles, node.children);
  return cornersCore(corners);
}

PatchOutcome comparePatches(const PreparedMesh& A, std::uint32_t a, const PreparedMesh& B,
                            std::uint32_t b, const Isometry3d& X_AB, const Isometry3d& X_BA,
                            Vector3d& nhat_AB_A, SearchLimit& limit, ClosestPoints& best,
                            SurfaceGap& gap) {
  Corners corners_a, corners_b;
  const ConvexCore core_a = pieceCore(A, A.tree.node(a), corners_a);
  const ConvexCore core_b = pieceCore(B, B.tree.node(b), corners_b);
  const auto within_limit = gapWithin(core_a, core_b, X_AB, nhat_AB_A, limit);
  if (!within_limit) return PatchOutcome::SETTLED;
  const PairDistance& hulls = *within_limit;
  const double rounding = roundingOf(core_a, core_b);
  if (hulls.certainty != Certainty::EXACT || hulls.touches()) {
    return PatchOutcome::HULLS_TOUCH;
  }
  const double within = std::max(rounding, limit.tolerance());
  const Vector3d p_BCb = X_BA * hulls.p_ACb;
  const auto on_a = closestOnPart(A, a, hulls.p_ACa, within);
  if (!on_a) return PatchOutcome::NOT_ON_A;
  const auto on_b = closestOnPart(B, b, p_BCb, within);
  if (!on_b) return PatchOutcome::NOT_ON_B;
  const double beside_a = (*on_a - hulls.p_ACa).norm(), beside_b = (*on_b - p_BCb).norm();
  if (beside_a <= rounding && beside_b <= rounding) {
    if (square(hulls.distance) >= best.squared) return PatchOutcome::SETTLED;
    best = {square(hulls.distance), hulls.p_ACa, hulls.p_ACb};
    setGap(hulls.distance, hulls.p_ACa, hulls.p_ACb, hulls.nhat_AB_A, gap);
    limit.found(best.squared);
    return PatchOutcome::SETTLED;
  }
  const Vector3d p_AQb = X_AB * *on_b, apart = p_AQb - *on_a;
  if (apart.squaredNorm() < best.squared) {
    best = {apart.squaredNorm(), *on_a, p_AQb};
    setGap(apart.norm(), *on_a, p_AQb, apart.normalized(), gap);
    limit.found(best.squared);
  }
  if (isNearEnough(hulls, core_a, core_b, limit)) return PatchOutcome::SETTLED;
  return beside_a > beside_b ? PatchOutcome::NOT_ON_A : PatchOutcome::NOT_ON_B;
}

PatchOutcome comparePatch(const PreparedMesh& A, std::uint32_t a, const ConvexCore& B,
                          const Isometry3d& X_AB, Vector3d& nhat_AB_A, SearchLimit& limit,
                          SurfaceGap& gap) {
  const ConvexCore core = A.tree.patchCore(A.tree.node(a).patch);
  const auto within_limit = gapWithin(core, B, X_AB, nhat_AB_A, limit);
  if (!within_limit) return PatchOutcome::SETTLED;
  const PairDistance& hulls = *within_limit;
  const double rounding = roundingOf(core, B);
  if (hulls.certainty != Certainty::EXACT || hulls.touches()) {
    return PatchOutcome::HULLS_TOUCH;
  }
  const auto on_a = closestOnPart(A, a, hulls.p_ACa, std::max(rounding, limit.tolerance()));
  if (!on_a) return PatchOutcome::NOT_ON_A;
  const bool is_exact = (*on_a - hulls.p_ACa).norm() <= rounding;
  const Vector3d apart = hulls.p_ACb - *on_a;
  const double distance = is_exact ? hulls.distance : apart.norm();
  if (distance < gap.distance) {
    setGap(distance, is_exact ? hulls.p_ACa : *on_a, hulls.p_ACb,
           is_exact ? hulls.nhat_AB_A : Vector3d(apart.normalized()), gap);
    limit.found(square(distance));
  }
  return is_exact || isNearEnough(hulls, core, B, limit) ? PatchOutcome::SETTLED
                                                         : PatchOutcome::NOT_ON_A;
}

}  // namespace collision_pairs
