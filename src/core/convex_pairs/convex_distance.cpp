#include "convex_distance.h"

#include <type_traits>

#include "epa.h"

namespace collision_pairs {
namespace {

// What the certified interval of a distance must close to, relative to the largest coordinate of
// the Minkowski difference, to be called exact.
constexpr double DISTANCE_TOLERANCE = 1e-10;
constexpr double CURVED_DISTANCE_TOLERANCE = 1e-8;
constexpr double DEPTH_TOLERANCE = 1e-12;
constexpr double CURVED_DEPTH_TOLERANCE = 1e-9;
constexpr double EXACT_DEPTH = 1e-6;

// Witness points of a depth further than this from one depth apart are sought again, with the
// shapes this far apart; both relative as above.
constexpr double WITNESS_TOLERANCE = 1e-10;
constexpr double WITNESS_SHIFT = 0.01;

// A closest point this near the origin has lost too many digits to give a direction.
constexpr double NORMAL_FROM_FEATURE_BELOW = 1e-4;

double distanceTolerance(const ConvexCore& A, const ConvexCore& B) {
  return A.curved() || B.curved() ? CURVED_DISTANCE_TOLERANCE : DISTANCE_TOLERANCE;
}

// Puts the cores' witness points and depth or distance on the rounded surfaces.
void finish(const ConvexCore& A, const ConvexCore& B, double core_distance,
            const Eigen::Vector3d& a, const Eigen::Vector3d& b, PairDistance& result) {
  const Eigen::Vector3d& n = result.nhat_AB_A;
  result.distance = core_distance - A.radius - B.radius;
  result.p_ACa = a + A.radius * n;
  result.p_ACb = b - B.radius * n;
}

// The best unit direction from A to B: v itself, or, where v is short and its direction rounding,
// the normal of the edge or face of A - B it lies on, or of the polytope around a touching point.
// The best is the one whose support plane is furthest out.
template <class T>
Vec3<T> bestNormal(Difference<T>& difference, const GjkResult<T>& found) {
  Vec3<T> normal = -found.v.normalized();
  const T distance = found.v.norm();
  if (!(distance < T(NORMAL_FROM_FEATURE_BELOW) * found.magnitude)) return normal;
  const auto height = [&](const Vec3<T>& n) { return -difference.furthest(n).w.dot(n); };
  T best = height(normal);
  const auto offer = [&](const Vec3<T>& n) {
    const T h = n.norm() > T(0.5) ? height(n) : best;
    if (h > best) best = h, normal = n;
  };
  offer(found.normal);
  const auto& v = found.simplex.vertex;
  if (found.simplex.size == 2) {
    const Vec3<T> edge = (v[1].w - v[0].w).normalized();
    offer((normal - normal.dot(edge) * edge).normalized());
  }
  if (found.simplex.size == 3) {
    const Vec3<T> face = (v[1].w - v[0].w).cross(v[2].w - v[0].w).normalized();
    offer(face);
    offer(-face);
  }
  const T rounding = T(64) * std::numeric_limits<T>::epsilon() * found.magnitude;
  if (best < distance - rounding) {
    Epa<T> epa(difference, found.simplex, found.magnitude);
    offer(epa.run(T(0)).normal);
  }
  return normal;
}

template <class T>
void fillApart(const ConvexCore& A, const ConvexCore& B, Difference<T>& difference,
               const GjkResult<T>& found, PairDistance& result) {
  result.nhat_AB_A = bestNormal(difference, found).template cast<double>();
  const Vec3<T> a = found.simplex.combine(&DifferencePoint<T>::a);
  const Vec3<T> b = found.simplex.combine(&DifferencePoint<T>::b);
  finish(A, B, static_cast<double>(found.v.norm()), a.template cast<double>(),
         b.template cast<double>(), result);
  result.certainty = Certainty::EXACT;
}

// Witness points that are not one depth apart along the normal come from a polytope that is still
// coarse. Moved apart along the normal the same two points are the closest ones, which GJK finds.
template <class T>
void mendWitnesses(const Difference<T>& difference, T magnitude, EpaResult<T>& depth) {
  const auto residual = [&](const Vec3<T>& a, const Vec3<T>& b) {
    return (a - b - depth.upper * depth.normal).norm();
  };
  const T found = residual(depth.a, depth.b);
  if (found <= T(WITNESS_TOLERANCE) * magnitude) return;
  Difference<T> apart = difference;
  const Vec3<T> shift = depth.normal * (depth.upper + T(WITNESS_SHIFT) * magnitude);
  apart.p_AB += shift;
  const GjkResult<T> closest =
      gjk<T>(apart, std::numeric_limits<T>::infinity(), Vec3<T>(-depth.normal));
  if (closest.end != GjkEnd::APART && closest.end != GjkEnd::STALLED) return;
  const Vec3<T> a = closest.simplex.combine(&DifferencePoint<T>::a);
  const Vec3<T> b = closest.simplex.combine(&DifferencePoint<T>::b) - shift;
  if (residual(a, b) < found) depth.a = a, depth.b = b;
}

template <class T>
bool fillOverlap(const ConvexCore& A, const ConvexCore& B, Difference<T>& difference,
                 const Simplex<T>& simplex, T magnitude, PairDistance& result) {
  const bool curved = A.curved() || B.curved();
  const T relative = curved ? T(CURVED_DEPTH_TOLERANCE) : T(DEPTH_TOLERANCE);
  Epa<T> epa(difference, simplex, magnitude);
  EpaResult<T> depth = epa.run(relative * magnitude);
  mendWitnesses(difference, magnitude, depth);
  result.nhat_AB_A = depth.normal.template cast<double>();
  const T rounding = T(64) * std::numeric_limits<T>::epsilon() * magnitude;
  const bool refuted = depth.upper < -rounding;  // a plane lies between: it was no overlap
  // Centred on the face's own two points, so that they are exactly one depth apart.
  const T upper = refuted ? depth.upper : std::max(depth.upper, T(0));
  const Vec3<T> middle = (depth.a + depth.b) / T(2);
  const Vec3<T> half = depth.normal * (upper / T(2));
  finish(A, B, -static_cast<double>(upper), Vec3<T>(middle + half).template cast<double>(),
         Vec3<T>(middle - half).template cast<double>(), result);
  if (refuted) {
    const bool met = (depth.a - depth.b).norm() + upper <= distanceTolerance(A, B) * magnitude;
    result.certainty = met ? Certainty::EXACT : Certainty::DEGRADED;
    return met;
  }
  const bool closed = upper - depth.lower <= T(EXACT_DEPTH) * magnitude;
  result.certainty = closed ? Certainty::EXACT : Certainty::BOUND;
  return closed || curved;
}

enum class Depth { MEASURED, IGNORED };

// True if settled in this scalar type.
template <class T>
bool solve(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
           double max_distance, Depth depth, PairDistance& result, CoreOverlap* overlap = nullptr) {
  Difference<T> difference(A, B, X_AB);
  const T radii = T(A.radius) + T(B.radius);
  const Vec3<T> start = (A.center - X_AB * B.center).template cast<T>();
  GjkResult<T> found = gjk<T>(difference, T(max_distance) + radii, start);
  if (found.end == GjkEnd::BEYOND) {
    // Rounding must not make it the limit itself: 0 would read as a touch.
    result.distance =
        std::max(static_cast<double>(found.lower - radii),
                 std::nextafter(max_distance, std::numeric_limits<double>::infinity()));
    result.certainty = Certainty::BEYOND;
    return true;
  }
  // Round shapes make slivers, on which "inside" is a matter of rounding: EPA tells.
  const bool measure = depth == Depth::MEASURED || A.curved() || B.curved();
  if (found.end == GjkEnd::OVERLAP && measure) {
    return fillOverlap(A, B, difference, found.simplex, found.magnitude, result);
  }
  if (found.end == GjkEnd::OVERLAP) {
    result.distance = -static_cast<double>(radii);
    result.p_ACa = result.p_ACb =
        found.simplex.combine(&DifferencePoint<T>::a).template cast<double>();
    if constexpr (std::is_same_v<T, double>) {
      if (overlap != nullptr) *overlap = {found.simplex, found.magnitude};
    }
    return true;
  }
  fillApart(A, B, difference, found, result);
  const T tolerance = distanceTolerance(A, B) * found.magnitude;
  const bool sure = found.end == GjkEnd::APART || found.lower > T(0);
  if (sure && found.v.norm() - found.lower <= tolerance) return true;
  // Stalled between slivers: the polytope's faces find the plane that GJK's rounding hides. Where
  // none lies between the shapes, and they are this close, they touch.
  const EpaResult<T> planes = Epa<T>(difference, found.simplex, found.magnitude).run(T(0));
  const T lower = std::max(found.lower, -planes.upper);
  const bool close = found.v.norm() - lower <= tolerance;
  if (close && lower <= T(0))
    return fillOverlap(A, B, difference, found.simplex, found.magnitude, result);
  if (lower > found.lower) result.nhat_AB_A = planes.normal.template cast<double>();
  if (close) return true;
  result.distance = static_cast<double>(lower - radii);
  result.certainty = Certainty::DEGRADED;
  return false;
}

PairDistance solveTwice(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                        double max_distance, Depth depth, CoreOverlap* overlap = nullptr) {
  PairDistance result;
  const double gap = ballDistance(A, B, X_AB);
  if (gap > max_distance) {
    result.distance = gap;
    result.certainty = Certainty::BEYOND;
    return result;
  }
  if (solve<double>(A, B, X_AB, max_distance, depth, result, overlap)) return result;
  PairDistance second;
  const bool settled = solve<long double>(A, B, X_AB, max_distance, depth, second);
  return settled || second.distance > result.distance ? second : result;
}

}  // namespace

double ballDistance(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB) {
  return (X_AB * B.center - A.center).norm() - A.extent - B.extent - A.radius - B.radius;
}

PairDistance convexDistance(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                            double max_distance) {
  return solveTwice(A, B, X_AB, max_distance, Depth::MEASURED);
}

PairDistance convexGap(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                       double max_distance, CoreOverlap* overlap) {
  return solveTwice(A, B, X_AB, max_distance, Depth::IGNORED, overlap);
}

PairDistance convexDepth(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                         const CoreOverlap& overlap) {
  Difference<double> difference(A, B, X_AB);
  PairDistance result;
  if (fillOverlap(A, B, difference, overlap.simplex, overlap.magnitude, result)) return result;
  return convexDistance(A, B, X_AB, std::numeric_limits<double>::infinity());
}

}  // namespace collision_pairs
