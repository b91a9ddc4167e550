#include "solids.h"

#include <algorithm>

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

bool coresMiss(const ConvexCore& a, const ConvexCore& b, const Isometry3d& X_AB, double band,
               Vector3d* nhat_AB_A = nullptr) {
  const double within = roundingOf(a, b) + band;
  const PairDistance gap = convexGap(a, b, X_AB, within, within);
  if (nhat_AB_A) *nhat_AB_A = gap.nhat_AB_A;
  return gap.certainty != Certainty::DEGRADED && !gap.touches();
}

}  // namespace

bool hullsMiss(const Prepared& A, const Prepared& B, const Isometry3d& X_AB, double band,
               Vector3d* nhat_AB_A) {
  return coresMiss(A.core, B.core, X_AB, band, nhat_AB_A);
}

bool hullMisses(const Prepared& A, const Vector3d& p_AQ) {
  Isometry3d X_AQ = Isometry3d::Identity();
  X_AQ.translation() = p_AQ;
  return coresMiss(A.core, ConvexCore{}, X_AQ, 0.0);
}

HullBounds boundsFromHulls(const Prepared& A, const Prepared& B, const Isometry3d& X_AB,
                           double max_distance, double band, ClosestVertices* between) {
  using Outcome = HullBounds::Outcome;
  const double rounding = roundingOf(A.core, B.core);
  HullBounds bounds;
  bounds.hulls = convexGap(A.core, B.core, X_AB, max_distance + rounding, rounding + band,
                           &bounds.overlap, between);
  if (bounds.hulls.certainty == Certainty::BEYOND) {
    bounds.outcome = Outcome::BEYOND;
    bounds.hulls.distance -= rounding;
    return bounds;
  }
  if (bounds.hulls.certainty != Certainty::EXACT || bounds.hulls.touches()) return bounds;
  const Vector3d& p_ACa = bounds.hulls.p_ACa;
  const Vector3d& p_ACb = bounds.hulls.p_ACb;
  bounds.p_ACa = A.mesh ? closestOnMesh(*A.mesh, p_ACa) : p_ACa;
  bounds.p_ACb =
      B.mesh ? X_AB * closestOnMesh(*B.mesh, X_AB.inverse(Eigen::Isometry) * p_ACb) : p_ACb;
  const double beside = (bounds.p_ACa - p_ACa).norm() + (bounds.p_ACb - p_ACb).norm();
  bounds.outcome = beside <= rounding ? Outcome::SETTLED : Outcome::APART;
  bounds.lower = lowerEndOfGap(bounds.hulls, A.core, B.core) - rounding;
  bounds.upper = (bounds.p_ACb - bounds.p_ACa).norm();
  return bounds;
}

// The hull first: most points are outside it, and testing that is much faster than solid angles.
bool meshHoldsPoint(const Prepared& A, const Vector3d& p_AQ) {
  return !A.mesh->solid.empty() && !hullMisses(A, p_AQ) && A.mesh->solid.holds(p_AQ);
}

bool meshHoldsMesh(const Prepared& A, const Prepared& B, const Isometry3d& X_AB) {
  const auto& parts = B.mesh->part_points;
  return std::any_of(parts.begin(), parts.end(),
                     [&](const Vector3d& p_BQ) { return meshHoldsPoint(A, X_AB * p_BQ); });
}

bool meshHoldsVertexDeep(const Prepared& A, const Prepared& B, const Isometry3d& X_AB,
                         const std::function<double(const Vector3d&)>& moves) {
  constexpr std::size_t LOOKED_AT = 4000, TRIED = 24;
  if (!A.mesh || !B.mesh || A.mesh->solid.empty()) return false;
  const auto& [vertices, triangles, name] = *B.mesh->triangles;
  std::vector<std::pair<double, Vector3d>> deepest;  // in A's box
  for (std::size_t i = 0; i < triangles.size(); i += 1 + triangles.size() / LOOKED_AT) {
    const Vector3d p_AV = X_AB * vertices[triangles[i][0]];
    const Vector3d p_box = A.box.R.transpose() * (p_AV - A.box.center);
    const double in_box = (A.box.half - p_box.cwiseAbs()).minCoeff();
    if (!(in_box > 0.0)) continue;
    const double spare = in_box - moves(p_AV);
    if (spare > 0.0) deepest.emplace_back(spare, p_AV);
  }
  const std::size_t tried = std::min(TRIED, deepest.size());
  std::partial_sort(deepest.begin(), deepest.begin() + static_cast<std::ptrdiff_t>(tried),
                    deepest.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  return std::any_of(deepest.begin(), deepest.begin() + static_cast<std::ptrdiff_t>(tried),
                     [&](const auto& vertex) {
                       const Vector3d& p_AV = vertex.second;
                       return (closestOnMesh(*A.mesh, p_AV) - p_AV).norm() > moves(p_AV) &&
                              meshHoldsPoint(A, p_AV);
                     });
}

bool meshHoldsConvex(const Prepared& A, const Prepared& B, const Isometry3d& X_AB) {
  return meshHoldsPoint(A, X_AB * B.core.center);
}

}  // namespace collision_pairs
