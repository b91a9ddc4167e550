#include "patch_hulls.h"

#include <cmath>

#include "convex_distance.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

double square(double x) { return x * x; }

// A patch by the corners of it, a triangle by its own; `corners` holds these.
ConvexCore pieceCore(const PreparedMesh& mesh, const TriangleTree::Node& node, Corners& corners) {
  if (node.isPatch()) return mesh.tree.patchCore(node.patch);
  corners = cornersOf(*mesh.triangles, node.children);
  return cornersCore(corners);
}

}  // namespace

PatchOutcome comparePatches(const PreparedMesh& A, std::uint32_t a, const PreparedMesh& B,
                            std::uint32_t b, const Isometry3d& X_AB, const Isometry3d& X_BA,
                            ClosestPoints& best, SurfaceGap& gap) {
  Corners corners_a, corners_b;
  const ConvexCore core_a = pieceCore(A, A.tree.node(a), corners_a);
  const ConvexCore core_b = pieceCore(B, B.tree.node(b), corners_b);
  const PairDistance hulls = convexGap(core_a, core_b, X_AB, std::sqrt(best.squared));
  if (hulls.certainty == Certainty::BEYOND) return PatchOutcome::SETTLED;
  const double rounding = roundingOf(core_a, core_b);
  if (hulls.certainty != Certainty::EXACT || hulls.distance <= rounding) {
    return PatchOutcome::HULLS_TOUCH;
  }
  if (!isOnMesh(A, a, hulls.p_ACa, rounding)) return PatchOutcome::NOT_ON_A;
  if (!isOnMesh(B, b, X_BA * hulls.p_ACb, rounding)) return PatchOutcome::NOT_ON_B;
  if (square(hulls.distance) >= best.squared) return PatchOutcome::SETTLED;
  best = {square(hulls.distance), hulls.p_ACa, hulls.p_ACb};
  gap.beyond = false;
  gap.by_hulls = true;
  gap.nhat_AB_A = hulls.nhat_AB_A;
  return PatchOutcome::SETTLED;
}

PatchOutcome comparePatch(const PreparedMesh& A, std::uint32_t a, const ConvexCore& B,
                          const Isometry3d& X_AB, SurfaceGap& gap) {
  const ConvexCore core = A.tree.patchCore(A.tree.node(a).patch);
  const PairDistance hulls = convexGap(core, B, X_AB, gap.distance);
  if (hulls.certainty == Certainty::BEYOND) return PatchOutcome::SETTLED;
  const double rounding = roundingOf(core, B);
  if (hulls.certainty != Certainty::EXACT || hulls.distance <= rounding) {
    return PatchOutcome::HULLS_TOUCH;
  }
  if (!isOnMesh(A, a, hulls.p_ACa, rounding)) return PatchOutcome::NOT_ON_A;
  if (hulls.distance >= gap.distance) return PatchOutcome::SETTLED;
  gap.distance = hulls.distance;
  gap.p_ACa = hulls.p_ACa;
  gap.p_ACb = hulls.p_ACb;
  gap.nhat_AB_A = hulls.nhat_AB_A;
  gap.beyond = false;
  gap.by_hulls = true;
  return PatchOutcome::SETTLED;
}

}  // namespace collision_pairs
