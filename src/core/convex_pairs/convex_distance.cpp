#include "convex_distance.h"

#include "convex_query.h"
#include "double_double.h"

namespace collision_pairs {
namespace {

// What lies beyond the limit only by rounding is left to the distance itself. (A rotation in double
// may stretch a body by 1.5e-14.)
bool isBeyond(double gap, double max_distance, const ConvexCore& A, const ConvexCore& B,
              const Eigen::Isometry3d& X_AB) {
  return gap > max_distance &&
         gap - 4.0 * largestError(A, B, magnitudeOf(A, B, X_AB.translation())) > max_distance;
}

// The rungs, and how often each left a query to the next: of 514,000 of panda, ur5 and pr2 in
// recorded states and along motions (detector_benchmark).
//   bounding spheres   93 %: not beyond the limit
//   double             gaps 2.9 %, contact or not none of 13,481, depths 5 of 110
//   double-double      none: what it left would be DEGRADED
PairDistance solveTwice(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                        double max_distance, Wanted wanted, double band,
                        CoreOverlap* overlap = nullptr, ClosestVertices* between = nullptr) {
  PairDistance result;
  ClosestVertices ended;
  const Query<double> query(A, B, X_AB, band, ended);
  // What is proved of vertices near the known ones is what a search from the centres proves too, if
  // it does not end BEYOND: see closest_vertices.h.
  const bool is_new = !between || *between == ClosestVertices{};
  if (!is_new && query.fillNear(*between, result) && result.distance <= max_distance) {
    *between = ended;
    return result;
  }
  result = {};
  ended = {};
  const double gap = boundingSphereDistance(A, B, X_AB);
  if (isBeyond(gap, std::max(max_distance, band), A, B, X_AB)) {
    result.distance = gap;
    result.certainty = Certainty::BEYOND;
    return result;
  }
  if (!query.solve(max_distance, wanted, result, overlap)) {
    PairDistance finest;
    Query<DoubleDouble>(A, B, X_AB, band, ended).solve(max_distance, wanted, finest, nullptr);
    result = {};
    if (!query.fillBetween(ended, result)) result = finest;
  }
  if (between && result.certainty != Certainty::BEYOND) {
    // Where vertices were known and no good, as of faces that are parallel, they are tried again
    // only once they are.
    PairDistance same;
    if (!is_new && !query.fillBetween(ended, same)) ended = {}, ended.a[0] = -2;
    *between = ended;
  }
  if (result.distance > max_distance && result.certainty == Certainty::EXACT) {
    const double error = largestError(A, B, magnitudeOf(A, B, X_AB.translation()));
    result.distance =
        std::max(result.distance - error,
                 std::nextafter(max_distance, std::numeric_limits<double>::infinity()));
    result.certainty = Certainty::BEYOND;
  }
  return result;
}

// Alternating projections: from the centre of B to the nearest point of A, from there to the
// nearest point of B, and so on. They soon find two points within the margin for most bodies that
// have such points; a failure proves nothing. Found by more than rounding: a point of the core
// without its rim is one of the core in exact arithmetic too.
bool nearPointsFound(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                     double margin) {
  constexpr int MAX_STEPS = 3;
  if (A.kind == ConvexCore::Kind::POINTS || B.kind == ConvexCore::Kind::POINTS) return false;
  const double rim = 8.0 * largestError(A, B, magnitudeOf(A, B, X_AB.translation()));
  const double enough = A.radius + B.radius + margin - rim;
  const bool is_thick = B.kind > ConvexCore::Kind::SEGMENT && B.half.minCoeff() > rim;
  Eigen::Vector3d b = X_AB.translation();
  for (int i = 0; i < MAX_STEPS; ++i) {
    const Eigen::Vector3d a = nearestPoint(A, b, 0.0);
    const Eigen::Vector3d a_B = X_AB.linear().transpose() * (a - X_AB.translation());
    const Eigen::Vector3d b_B = nearestPoint(B, a_B, rim);
    const double squared = (b_B - a_B).squaredNorm();
    if (enough > 0.0 ? squared <= enough * enough : is_thick && squared == 0.0) return true;
    b.noalias() = X_AB.linear() * b_B + X_AB.translation();
  }
  return false;
}

}  // namespace

double gapAlong(const Eigen::Vector3d& n, const ConvexCore& A, const ConvexCore& B,
                const Eigen::Isometry3d& X_AB) {
  const Difference<double> difference(A, B, X_AB);
  const Eigen::Vector3d w = difference.furthest(n).w;
  const double magnitude = magnitudeOf(A, B, X_AB.translation());
  return -w.dot(n) - A.radius - B.radius -
         10.0 * std::numeric_limits<double>::epsilon() * magnitude;
}

double roughGap(Eigen::Vector3d& n, const ConvexCore& A, const ConvexCore& B,
                const Eigen::Isometry3d& X_AB, double max_distance) {
  constexpr double SHARE = 0.1;  // that a search over cubes has no use for
  if (n.isZero(0.0)) n = (X_AB * B.center - A.center).normalized();
  const double magnitude = magnitudeOf(A, B, X_AB.translation());
  const double off =
      A.radius + B.radius + 10.0 * std::numeric_limits<double>::epsilon() * magnitude;
  const auto found = gjk<double>({A, B, X_AB}, -n, {max_distance + off, 0.0, SHARE});
  n = found.normal;
  return found.lower - off;
}

double boundingSphereDistance(const ConvexCore& A, const ConvexCore& B,
                              const Eigen::Isometry3d& X_AB) {
  return (X_AB * B.center - A.center).norm() - A.extent - B.extent - A.radius - B.radius;
}

PairDistance convexDistance(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                            double max_distance, double band, ClosestVertices* between) {
  return solveTwice(A, B, X_AB, max_distance, Wanted::DEPTH, band, nullptr, between);
}

PairDistance convexGap(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                       double max_distance, double band, CoreOverlap* overlap,
                       ClosestVertices* between) {
  return solveTwice(A, B, X_AB, max_distance, Wanted::GAP, band, overlap, between);
}

PairDistance convexTouch(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                         double margin, double band) {
  if (nearPointsFound(A, B, X_AB, margin)) {
    PairDistance touch;
    touch.distance = margin;
    return touch;
  }
  return solveTwice(A, B, X_AB, margin, Wanted::TOUCH, band);
}

PairDistance convexDepth(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                         const CoreOverlap& overlap, double band) {
  PairDistance result;
  ClosestVertices ended;
  const Query<double> query(A, B, X_AB, band, ended);
  if (query.fillOverlap(overlap.simplex, overlap.magnitude, true, false, result)) return result;
  return convexDistance(A, B, X_AB, std::numeric_limits<double>::infinity(), band);
}

}  // namespace collision_pairs
