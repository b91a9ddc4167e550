#include "plain_pairs.h"

#include "closed_forms.h"
#include "convex_distance.h"

namespace collision_pairs {

using Eigen::Isometry3d;

PairDistance convexPair(const Prepared& A, const Prepared& B, const Isometry3d& X_AB,
                        double max_distance, double band, ClosestVertices* between) {
  return hasClosedForm(A.core, B.core)
             ? closedForm(A.core, B.core, X_AB, band)
             : convexDistance(A.core, B.core, X_AB, max_distance, band, between);
}

PairDistance halfSpaceWith(const Prepared& A, const Prepared& B, const Isometry3d& X_AB,
                           double band) {
  if (A.isHalfSpace() && B.isHalfSpace()) return halfSpacePair(X_AB);
  if (A.isHalfSpace()) return halfSpaceDistance(B.core, X_AB, band);
  return exchanged(halfSpaceDistance(A.core, X_AB.inverse(Eigen::Isometry), band), X_AB);
}

bool convexTouch(const Prepared& A, const Prepared& B, const Isometry3d& X_AB, double margin,
                 double band, PairDistance& result) {
  if (hasClosedForm(A.core, B.core)) {
    return closedForm(A.core, B.core, X_AB, band).distance <= margin;
  }
  using Kind = ConvexCore::Kind;
  if (A.core.kind == Kind::BOX && B.core.kind == Kind::BOX && margin == 0.0) {
    if (const auto is_sure = boxesTouch(A.core.half, B.core.half, X_AB, band)) return *is_sure;
  }
  result = convexTouch(A.core, B.core, X_AB, margin, band);
  return result.distance <= margin;
}

}  // namespace collision_pairs
