#include "convex_distance.h"

#include <type_traits>

#include "epa.h"
#include "least_height.h"
#include "support_part.h"

namespace collision_pairs {
namespace {

// Largest certified interval that counts as exact, relative to the largest coordinate of the
// Minkowski difference: of a distance; of a depth, which is also EPA's tolerance.
constexpr double DISTANCE_TOLERANCE = 1e-10;
constexpr double EXACT_DEPTH = 1e-6;
constexpr double DEPTH_TOLERANCE = 1e-12;

// The same if a core is curved, relative to the size of the smaller body, which is what matters for
// a small body beside a large one.
constexpr double CURVED_DISTANCE_TOLERANCE = 1e-9;
constexpr double CURVED_DEPTH_TOLERANCE = 1e-9;

// If the witness points of a depth miss the depth by more than this, they are computed again, with
// the shapes this far apart; relative to the size of the smaller body.
constexpr double WITNESS_TOLERANCE = 1e-10;
constexpr double WITNESS_SHIFT = 0.01;

// A closest point nearer to the origin than this has too few digits left to give a direction.
constexpr double NORMAL_FROM_FEATURE_BELOW = 1e-4;

// Rounding error of a height or a distance if no coordinate exceeds `magnitude`.
template <class T>
T roundingOf(T magnitude) {
  return T(64) * std::numeric_limits<T>::epsilon() * magnitude;
}

// Moves the cores' witness points and distance to the surfaces that include the radii.
void finish(const ConvexCore& A, const ConvexCore& B, double core_distance,
            const Eigen::Vector3d& a, const Eigen::Vector3d& b, PairDistance& result) {
  const Eigen::Vector3d& n = result.nhat_AB_A;
  result.distance = core_distance - A.radius - B.radius;
  result.p_ACa = a + A.radius * n;
  result.p_ACb = b - B.radius * n;
}

// The best unit direction from A to B: v itself, or, if v is too short to give a direction, the
// normal of the edge or face of A - B it lies on, or of the polytope around a touching point. The
// best is the one whose support plane is furthest out.
template <class T>
Vec3<T> bestNormal(const Difference<T>& difference, const GjkResult<T>& found) {
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
  if (best < distance - roundingOf(found.magnitude)) {
    Epa<T> epa(difference, found.simplex, found.magnitude);
    offer(epa.run(T(0)).normal);
  }
  return normal;
}

enum class Wanted { DEPTH, GAP, TOUCH };

// One query in one scalar type. Functions that fill in a result return whether it is settled.
template <class T>
class Query {
 public:
  Query(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB)
      : A_(A),
        B_(B),
        curved_(A.curved() || B.curved()),
        smaller_(std::min(A.extent + A.radius, B.extent + B.radius)),
        difference_(A, B, X_AB) {}

  // True if this scalar type is accurate enough for the smaller body.
  bool isPrecise() const {
    return !curved_ ||
           roundingOf(difference_.magnitude()) <= T(CURVED_DISTANCE_TOLERANCE) * smaller_;
  }

  bool solve(double max_distance, Wanted wanted, PairDistance& result, CoreOverlap* overlap) const {
    const T radii = T(A_.radius) + T(B_.radius);
    const Vec3<T> center_b = difference_.R_AB * B_.center.template cast<T>() + difference_.p_AB;
    const Vec3<T> start = A_.center.template cast<T>() - center_b;
    const T limit = T(max_distance) + radii;
    const T enough = wanted == Wanted::TOUCH ? limit : wanted == Wanted::GAP ? radii : T(0);
    const GjkResult<T> found = gjk<T>(difference_, limit, start, enough);
    if (found.end == GjkEnd::BEYOND) {
      // Rounding must not make it equal to the limit: 0 would count as touching.
      result.distance =
          std::max(static_cast<double>(found.lower - radii),
                   std::nextafter(max_distance, std::numeric_limits<double>::infinity()));
      result.nhat_AB_A = found.normal.template cast<double>();
      result.certainty = Certainty::BEYOND;
      return true;
    }
    const bool is_overlap = found.end == GjkEnd::OVERLAP;
    // Round shapes produce slivers, for which "inside" depends on rounding: EPA decides.
    const bool is_sure = is_overlap && (!curved_ || isInside(found));
    if (found.end == GjkEnd::WITHIN || (is_sure && wanted != Wanted::DEPTH)) {
      result.distance = static_cast<double>((is_overlap ? T(0) : found.v.norm()) - radii);
      result.p_ACa = result.p_ACb =
          found.simplex.combine(&DifferencePoint<T>::a).template cast<double>();
      if constexpr (std::is_same_v<T, double>) {
        if (overlap != nullptr && is_overlap && !curved_) {
          *overlap = {found.simplex, found.magnitude};
        }
      }
      return true;
    }
    if (is_overlap) return fillOverlap(found.simplex, found.magnitude, true, result);
    return curved_ ? fillCurvedApart(found, wanted, result) : fillFlatApart(found, result);
  }

  // `sure`: the two overlap or touch unless a separating plane is found.
  bool fillOverlap(const Simplex<T>& simplex, T magnitude, bool sure, PairDistance& result) const {
    const T size = curved_ ? smaller_ : magnitude;
    const T closed = std::max(T(EXACT_DEPTH) * size, roundingOf(magnitude));
    EpaResult<T> depth = Epa<T>(difference_, simplex, magnitude)
                             .run(T(curved_ ? CURVED_DEPTH_TOLERANCE : DEPTH_TOLERANCE) * size);
    if (curved_) {
      LeastHeight<T> search(difference_);
      SupportPlane<T> least = search.search(depth.normal);
      if (least.height - depth.lower > closed) least = search.searchAround();
      if (least.height < depth.upper) depth.upper = least.height, depth.normal = least.normal;
    }
    if (depth.upper < -roundingOf(magnitude)) {  // a separating plane: there was no overlap
      return fillFromPlane(depth.normal, magnitude, nullptr, result);
    }
    const T upper = std::max(depth.upper, T(0));
    Witnesses<T> deepest{depth.a, depth.b};
    repairWitnesses(depth.normal, -depth.upper, deepest);
    result.nhat_AB_A = depth.normal.template cast<double>();
    setApart(depth.normal, -upper, deepest);
    finish(A_, B_, -static_cast<double>(upper), deepest.a.template cast<double>(),
           deepest.b.template cast<double>(), result);
    const T rounding = tolerance(magnitude);
    if (!sure && !(depth.lower > T(0)) && upper > rounding &&
        !shareOneOf(deepest.a, deepest.b, rounding)) {
      result.certainty = Certainty::DEGRADED;
      return false;
    }
    const bool is_closed = upper - depth.lower <= closed;
    result.certainty = is_closed ? Certainty::EXACT : Certainty::BOUND;
    return is_closed || curved_;
  }

 private:
  T tolerance(T magnitude) const {
    if (!curved_) return T(DISTANCE_TOLERANCE) * magnitude;
    return std::max(T(CURVED_DISTANCE_TOLERANCE) * smaller_, roundingOf(magnitude));
  }

  // True if the origin is inside by more than rounding of the vertices can explain, judged by the
  // volumes of the four tetrahedra that it forms with the faces.
  static bool isInside(const GjkResult<T>& found) {
    if (found.simplex.size != 4) return false;
    const auto& v = found.simplex.vertex;
    const T volume = std::abs((v[1].w - v[0].w).dot((v[2].w - v[0].w).cross(v[3].w - v[0].w)));
    const auto& lambda = found.simplex.lambda;
    const T least = *std::min_element(lambda.begin(), lambda.end());
    return least * volume > T(8) * roundingOf(found.magnitude) * found.magnitude * found.magnitude;
  }

  // True if the point a of A is within `tolerance` of B, or b of B within that of A.
  bool shareOneOf(const Vec3<T>& a, const Vec3<T>& b, T tolerance) const {
    const ConvexCore point;
    const auto meets = [&](const Difference<T>& difference) {
      const GjkEnd end = gjk<T>(difference, tolerance, difference.p_AB, tolerance).end;
      return end == GjkEnd::OVERLAP || end == GjkEnd::WITHIN;
    };
    return meets({point, B_, difference_.R_AB, difference_.p_AB - a}) ||
           meets({A_, point, Mat3<T>::Identity(), b});
  }

  void fillApart(const GjkResult<T>& found, PairDistance& result) const {
    result.nhat_AB_A = bestNormal(difference_, found).template cast<double>();
    const Witnesses<T> points = witnessesOf(found.simplex);
    finish(A_, B_, static_cast<double>(found.v.norm()), points.a.template cast<double>(),
           points.b.template cast<double>(), result);
    result.certainty = Certainty::EXACT;
  }

  bool fillFlatApart(const GjkResult<T>& found, PairDistance& result) const {
    fillApart(found, result);
    const bool sure = found.end == GjkEnd::APART || found.lower > T(0);
    if (sure && found.v.norm() - found.lower <= tolerance(found.magnitude)) return true;
    // Stalled on slivers: the polytope's faces give the separating plane that GJK misses because of
    // rounding. If there is none and the shapes are this close, they touch.
    const EpaResult<T> planes = Epa<T>(difference_, found.simplex, found.magnitude).run(T(0));
    const T lower = std::max(found.lower, -planes.upper);
    const bool close = found.v.norm() - lower <= tolerance(found.magnitude);
    if (close && lower <= T(0)) return fillOverlap(found.simplex, found.magnitude, true, result);
    if (lower > found.lower) result.nhat_AB_A = planes.normal.template cast<double>();
    if (close) return true;
    result.distance = static_cast<double>(lower) - A_.radius - B_.radius;
    result.certainty = Certainty::DEGRADED;
    return false;
  }

  // GJK's own closest points if they are far enough apart to be exact, else those of the separating
  // plane. If there is none and the shapes are this close, they touch.
  bool fillCurvedApart(const GjkResult<T>& found, Wanted wanted, PairDistance& result) const {
    const T distance = found.v.norm();
    const bool is_far = distance >= T(NORMAL_FROM_FEATURE_BELOW) * found.magnitude;
    // A gap bounds a search, or is one of many triangles': the search below would add no relevant
    // digit but most of the cost.
    const bool is_closed =
        found.end == GjkEnd::APART ||
        (wanted == Wanted::GAP && distance - found.lower <= T(DISTANCE_TOLERANCE) * smaller_);
    if (is_far && is_closed) {
      fillApart(found, result);
      return true;
    }
    LeastHeight<T> search(difference_);
    SupportPlane<T> least = search.search(found.normal);
    if (distance > T(0)) least = search.search(Vec3<T>(-found.v / distance));
    if (least.height < T(0) &&
        fillFromPlane(least.normal, found.magnitude, &found.simplex, result)) {
      return true;
    }
    // Stalled on slivers: the polytope's faces give the plane that GJK misses because of rounding.
    least = search.search(Epa<T>(difference_, found.simplex, found.magnitude).run(T(0)).normal);
    if (least.height < T(0)) {
      return fillFromPlane(least.normal, found.magnitude, &found.simplex, result);
    }
    const bool sure = distance <= tolerance(found.magnitude);
    return fillOverlap(found.simplex, found.magnitude, sure, result);
  }

  // From the separating plane with normal n, and the simplex of GJK's closest points if there is
  // one.
  bool fillFromPlane(const Vec3<T>& n, T magnitude, const Simplex<T>* simplex,
                     PairDistance& result) const {
    const T lower = -difference_.furthest(n).w.dot(n);
    Witnesses<T> closest{Vec3<T>::Zero(), Vec3<T>::Constant(std::numeric_limits<T>::infinity())};
    if (simplex != nullptr) closest = witnessesOf(*simplex);
    repairWitnesses(n, lower, closest);
    const T apart = closest.apart();
    if (residualOf(closest, n, lower) <= T(WITNESS_TOLERANCE) * smaller_) {
      setApart(n, lower, closest);
    }
    result.nhat_AB_A = n.template cast<double>();
    finish(A_, B_, static_cast<double>(lower), closest.a.template cast<double>(),
           closest.b.template cast<double>(), result);
    const bool is_closed = apart - lower <= tolerance(magnitude);
    result.certainty = is_closed ? Certainty::EXACT : Certainty::DEGRADED;
    return is_closed;
  }

  static T residualOf(const Witnesses<T>& points, const Vec3<T>& n, T apart) {
    return (points.a - points.b + apart * n).norm();
  }

  // Moves both by the same amount, so that b - a is exactly `apart` along n.
  static void setApart(const Vec3<T>& n, T apart, Witnesses<T>& points) {
    const Vec3<T> middle = (points.a + points.b) / T(2);
    const Vec3<T> half = n * (apart / T(2));
    points.a = middle - half;
    points.b = middle + half;
  }

  // Witness points whose difference is not `apart` along n come from GJK, which does not notice a
  // tilt of the order of the square root of rounding, or from a polytope that is still coarse. The
  // parts in the support planes with normal n have the same closest points, which are found more
  // accurately with the planes moved onto each other, or near each other. Of a part that is nearly
  // parallel to its plane, only one point may belong to it.
  void repairWitnesses(const Vec3<T>& n, T apart, Witnesses<T>& witnesses) const {
    T best = residualOf(witnesses, n, apart);
    const auto tryParts = [&](T planes_apart, bool point_of_a, bool point_of_b) {
      if (best <= T(WITNESS_TOLERANCE) * smaller_) return;
      const Witnesses<T> found =
          closestOfParts(difference_, n, planes_apart - apart, smaller_, point_of_a, point_of_b);
      const T residual = residualOf(found, n, apart);
      if (!(residual < best)) return;
      best = residual;
      witnesses = found;
    };
    for (const T planes_apart : {T(0), T(WITNESS_SHIFT) * smaller_}) {
      tryParts(planes_apart, false, false);
      tryParts(planes_apart, true, false);
      tryParts(planes_apart, false, true);
    }
  }

  const ConvexCore& A_;
  const ConvexCore& B_;
  const bool curved_;
  const T smaller_;  // size of the smaller body
  const Difference<T> difference_;
};

PairDistance solveTwice(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                        double max_distance, Wanted wanted, CoreOverlap* overlap = nullptr) {
  PairDistance result;
  const double gap = boundingSphereDistance(A, B, X_AB);
  if (gap > max_distance) {
    result.distance = gap;
    result.certainty = Certainty::BEYOND;
    return result;
  }
  const Query<double> query(A, B, X_AB);
  const bool is_precise = query.isPrecise();
  if (is_precise && query.solve(max_distance, wanted, result, overlap)) return result;
  const Query<long double> finer(A, B, X_AB);
  PairDistance second;
  const bool settled = finer.solve(max_distance, wanted, second, nullptr);
  return settled || !is_precise || second.distance > result.distance ? second : result;
}

// The point of a core that is nearest to p, in its frame. Not for hulls.
Eigen::Vector3d nearestPoint(const ConvexCore& core, const Eigen::Vector3d& p) {
  Eigen::Vector3d nearest = p.cwiseMax(-core.half).cwiseMin(core.half);
  if (core.kind != ConvexCore::Kind::CYLINDER) return nearest;
  const double across = p.head<2>().squaredNorm(), radius = core.half[0];
  nearest.head<2>() = p.head<2>();
  if (across > radius * radius) nearest.head<2>() *= radius / std::sqrt(across);
  return nearest;
}

// Alternating projections: from the centre of B to the nearest point of A, from there to the
// nearest point of B, and so on. They soon find two points within the margin for most bodies that
// have such points; a failure proves nothing.
bool nearPointsFound(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                     double margin) {
  constexpr int MAX_STEPS = 3;
  using Kind = ConvexCore::Kind;
  if (A.kind == Kind::POINTS || B.kind == Kind::POINTS) return false;
  const double enough = A.radius + B.radius + margin;
  Eigen::Vector3d b = X_AB.translation();
  for (int i = 0; i < MAX_STEPS; ++i) {
    const Eigen::Vector3d a = nearestPoint(A, b);
    const Eigen::Vector3d a_B = X_AB.linear().transpose() * (a - X_AB.translation());
    const Eigen::Vector3d b_B = nearestPoint(B, a_B);
    if ((b_B - a_B).squaredNorm() <= enough * enough) return true;
    b.noalias() = X_AB.linear() * b_B + X_AB.translation();
  }
  return false;
}

}  // namespace

double gapAlong(const Eigen::Vector3d& n, const ConvexCore& A, const ConvexCore& B,
                const Eigen::Isometry3d& X_AB) {
  const Difference<double> difference(A, B, X_AB);
  const Eigen::Vector3d w = difference.furthest(n).w;
  return -w.dot(n) - A.radius - B.radius - roundingOf(difference.magnitude());
}

double boundingSphereDistance(const ConvexCore& A, const ConvexCore& B,
                              const Eigen::Isometry3d& X_AB) {
  return (X_AB * B.center - A.center).norm() - A.extent - B.extent - A.radius - B.radius;
}

PairDistance convexDistance(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                            double max_distance) {
  return solveTwice(A, B, X_AB, max_distance, Wanted::DEPTH);
}

PairDistance convexGap(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                       double max_distance, CoreOverlap* overlap) {
  return solveTwice(A, B, X_AB, max_distance, Wanted::GAP, overlap);
}

PairDistance convexTouch(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                         double margin) {
  if (nearPointsFound(A, B, X_AB, margin)) {
    PairDistance touch;
    touch.distance = margin;
    return touch;
  }
  return solveTwice(A, B, X_AB, margin, Wanted::TOUCH);
}

PairDistance convexDepth(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB,
                         const CoreOverlap& overlap) {
  PairDistance result;
  const Query<double> query(A, B, X_AB);
  if (query.fillOverlap(overlap.simplex, overlap.magnitude, true, result)) return result;
  return convexDistance(A, B, X_AB, std::numeric_limits<double>::infinity());
}

}  // namespace collision_pairs
