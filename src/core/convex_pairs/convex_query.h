// One question about two convex shapes, answered in one scalar type, with a certified interval.
//
// Error bounds, with u = epsilon / 2 and m the sum of the lengths of all vectors that go into a
// vertex w = a - (R b + p) of A - B: each product R b is off by 3 sqrt(3) u |b|, each of the two
// sums by u m: |error of w| <= 7.2 u m. A height w . n adds 3 u m for the product and 4 u m because
// |n| is 1 to within 4 u; a length |sum of lambda w| adds 5 u m because the sum of the lambdas is 1
// to within 5 u, 4 u m for the sum and 3 u m for the root. Both are below 20 u m = 10 epsilon m.
#pragma once

#include <type_traits>

#include "closest_vertices.h"
#include "collision_pairs/pair_distance.h"
#include "cylinder_gap.h"
#include "epa.h"
#include "least_height.h"
#include "support_part.h"

namespace collision_pairs {

enum class Wanted { DEPTH, GAP, TOUCH };

/// Functions that fill in a result return whether it is settled: otherwise a scalar type with more
/// digits is asked. DoubleDouble is the last. Two that are no more than `band` metres apart are in
/// contact, and so are those that DoubleDouble cannot keep apart.
template <class T>
class Query {
 public:
  Query(const ConvexCore& A, const ConvexCore& B, const Eigen::Isometry3d& X_AB, double band,
        ClosestVertices& between)
      : A_(A),
        B_(B),
        between_(between),
        curved_(A.curved() || B.curved()),
        smaller_(std::min(A.extent + A.radius, B.extent + B.radius)),
        radii_(T(A.radius) + T(B.radius)),
        difference_(A, B, X_AB) {
    const double magnitude = magnitudeOf(A, B, X_AB.translation());
    magnitude_ = magnitude;
    rounding_ = T(10) * std::numeric_limits<T>::epsilon() * T(magnitude);
    largest_error_ = T(largestError(A, B, magnitude));
    band_ = IS_FINEST ? std::max(T(band), T(2) * rounding_) : T(band);
  }

  bool solve(double max_distance, Wanted wanted, PairDistance& result, CoreOverlap* overlap) const {
    const Vec3<T> center_b = difference_.R_AB * B_.center.template cast<T>() + difference_.p_AB;
    const Vec3<T> start = A_.center.template cast<T>() - center_b;
    // A search ends early only where the distance itself would say the same.
    const T sure = rounding_ + largest_error_;
    const T limit = std::max(T(max_distance), band_) + radii_;
    const T within = wanted == Wanted::TOUCH ? limit
                     : wanted == Wanted::GAP ? band_ + radii_
                                             : T(0);
    GjkLimits<T> limits{limit + sure, within - sure};
    GjkResult<T> found;
    found.v = start;
    for (const double share : FEATURES_WITHIN) {
      const bool is_rough = share > 0.0;
      if (is_rough && (IS_FINEST || !curved_)) continue;
      limits.narrow = T(share) * smaller_;
      advance(difference_, limits, found);
      if (found.end != GjkEnd::APART) break;
      if constexpr (!IS_FINEST) {
        if (is_rough && fillFromFeatures(found, wanted, result)) return true;
      }
    }
    if (found.end == GjkEnd::BEYOND) {
      result.distance = static_cast<double>(found.lower - rounding_ - radii_);
      result.nhat_AB_A = found.normal.template cast<double>();
      result.certainty = Certainty::BEYOND;
      return true;
    }
    if (found.end == GjkEnd::OVERLAP) return fillOverlapFound(found, wanted, result, overlap);
    if (found.end == GjkEnd::WITHIN) return fillTouch(found, found.v.norm(), result);
    return curved_ ? fillCurvedApart(found, result) : fillFlatApart(found, result);
  }

  /// The depth, if `sure` that the two overlap or touch unless a separating plane is found. Without
  /// `wants_exact` an upper bound will do.
  bool fillOverlap(const Simplex<T>& simplex, T magnitude, bool sure, bool wants_exact,
                   PairDistance& result) const {
    Epa<T> epa(difference_, simplex, magnitude);
    EpaResult<T> depth = epa.run(largest_error_ * T(0.25));
    const bool certain = sure || epa.enclosesBall(T(0), rounding_);
    if (curved_) findLeast(depth);
    if (depth.upper < -rounding_) return fillSeparated({depth.normal, depth.upper}, result);
    if (!certain && !IS_FINEST) return false;
    const T upper = std::max(depth.upper, T(0));
    Witnesses<T> deepest{depth.a, depth.b};
    repairWitnesses(difference_, depth.normal, -depth.upper, largest_error_, deepest);
    result.nhat_AB_A = depth.normal.template cast<double>();
    setApart(depth.normal, -upper, deepest);
    finish(-upper, deepest, result);
    if (!certain && upper > rounding_ && !shareOneOf(deepest.a, deepest.b)) {
      result.certainty = Certainty::DEGRADED;
      return false;
    }
    const bool is_exact = upper + rounding_ <= largest_error_ ||
                          epa.enclosesBall(upper + rounding_ - largest_error_, rounding_);
    result.certainty = is_exact ? Certainty::EXACT : Certainty::BOUND;
    return is_exact || (curved_ && sure) || !wants_exact;
  }

  /// False if the closest points do not lie, or not clearly, between these vertices.
  bool fillBetween(const ClosestVertices& vertices, PairDistance& result) const {
    GjkResult<double> found;
    return closestBetween(difference_, vertices, magnitude_, found) &&
           areClosest(difference_, vertices, magnitude_, found.v) && fillFar(found, result);
  }

  /// The same for vertices near those. They are set.
  bool fillNear(const ClosestVertices& vertices, PairDistance& result) const {
    GjkResult<double> found;
    between_ = vertices;
    if (closestBetween(difference_, vertices, magnitude_, found) &&
        areClosest(difference_, vertices, magnitude_, found.v)) {
      return fillFar(found, result);
    }
    if (found.simplex.size == 0) return false;
    found.lower = 0.0;
    advance(difference_, {}, found);
    bool is_whole;
    between_ = closestVertices(found.simplex, is_whole);
    return !(between_ == vertices) && fillBetween(between_, result);
  }

 private:
  bool isOfHulls() const {
    return A_.kind == ConvexCore::Kind::POINTS && A_.edges && B_.kind == A_.kind && B_.edges;
  }

  // False if the two are in contact, or so near that the distance of the two points is no good.
  bool fillFar(const GjkResult<double>& found, PairDistance& result) const {
    const double distance = found.v.norm();
    return isFar(found) && settles(found.lower, distance) &&
           found.lower - rounding_ > band_ + radii_ &&
           fillApart(found, -found.v / distance, result);
  }

  // From nothing but the vertices that the point found lies between, if any are clear. `lower`: of
  // the distance.
  bool fillFromVertices(const GjkResult<T>& found, T lower, PairDistance& result) const {
    if (!isOfHulls()) return false;
    bool is_whole;
    between_ = closestVertices(found.simplex, is_whole);
    if constexpr (!IS_FINEST) {
      GjkResult<double> clear;
      if (closestBetween(difference_, between_, magnitude_, clear) &&
          ((is_whole && settles(lower, clear.v.norm())) ||
           areClosest(difference_, between_, magnitude_, clear.v)) &&
          fillFar(clear, result)) {
        return true;
      }
      between_ = {};
    }
    return false;
  }

  static constexpr bool IS_FINEST = !std::is_same_v<T, double>;

  // A closest point nearer to the origin than this has too few digits left to give a direction;
  // relative to the largest vertex.
  static constexpr double NORMAL_FROM_FEATURE_BELOW = 1e-4;
  // A curved depth whose interval is wider than this is searched for all around the body; relative
  // to the smaller body.
  static constexpr double CLOSED_DEPTH = 1e-6;
  // Closest points that are further than this from lying along the normal are computed again.
  static constexpr double WITNESS_TOLERANCE = 1e-10;
  // With a cylinder, the features of the closest points are tried at these intervals, relative to
  // the smaller body, before GJK goes on to rounding.
  static constexpr std::array<double, 3> FEATURES_WITHIN{0.01, 1e-4, 0.0};
  // A point this far below the surface of a cylinder is one of both in exact arithmetic too; of the
  // largest error.
  static constexpr double COMMON_DEPTH = 8.0;

  // True if the two are certainly in contact, or certainly not, and the distance is as accurate as
  // promised.
  bool settles(T lower, T upper) const {
    const T contact = band_ + radii_;
    const bool is_sure = IS_FINEST || lower - rounding_ > contact || upper + rounding_ <= contact;
    return is_sure && upper - lower + rounding_ <= largest_error_;
  }

  // Moves the cores' witness points and distance to the surfaces that include the radii.
  void finish(T core_distance, const Witnesses<T>& points, PairDistance& result) const {
    const Eigen::Vector3d& n = result.nhat_AB_A;
    result.distance = reported(core_distance);
    result.p_ACa = points.a.template cast<double>() + A_.radius * n;
    result.p_ACb = points.b.template cast<double>() - B_.radius * n;
  }

  double reported(T core_distance) const {
    const T distance = core_distance - radii_;
    const auto metres = static_cast<double>(distance);
    return distance > band_ ? metres : std::min(metres, 0.0);
  }

  bool fillTouch(const GjkResult<T>& found, T core_distance, PairDistance& result) const {
    result.distance = reported(core_distance);
    result.p_ACa = result.p_ACb =
        found.simplex.combine(&DifferencePoint<T>::a).template cast<double>();
    return true;
  }

  // Slivers, and four vertices in a plane, appear to enclose an origin that is beside them.
  bool fillOverlapFound(const GjkResult<T>& found, Wanted wanted, PairDistance& result,
                        CoreOverlap* overlap) const {
    const bool sure = isInside(found, rounding_), wants_depth = wanted == Wanted::DEPTH;
    if (!sure || wants_depth) {
      const bool is_settled =
          fillOverlap(found.simplex, found.magnitude, sure, wants_depth, result);
      if (wants_depth || !is_settled || !result.touches()) return is_settled;
    } else {
      fillTouch(found, T(0), result);
    }
    if constexpr (!IS_FINEST) {
      if (overlap != nullptr && !curved_) *overlap = {found.simplex, found.magnitude};
    }
    return true;
  }

  void findLeast(EpaResult<T>& depth) const {
    LeastHeight<T> search(difference_);
    SupportPlane<T> least = search.search(depth.normal);
    if (least.height - depth.lower > T(CLOSED_DEPTH) * smaller_) least = search.searchAround();
    if (least.height < depth.upper) depth.upper = least.height, depth.normal = least.normal;
  }

  // True if the point a of A is within the largest error of B, or b of B within that of A.
  bool shareOneOf(const Vec3<T>& a, const Vec3<T>& b) const {
    const ConvexCore point;
    const auto meets = [&](const Difference<T>& difference) {
      const T near = largest_error_;
      const GjkEnd end = gjk<T>(difference, difference.p_AB, {near, near}).end;
      return end == GjkEnd::OVERLAP || end == GjkEnd::WITHIN;
    };
    return meets({point, B_, difference_.R_AB, difference_.p_AB - a}) ||
           meets({A_, point, Mat3<T>::Identity(), b});
  }

  // The best unit direction from A to B: v itself, or the normal of the edge or face of A - B that
  // it lies on. The best is the one whose support plane is furthest out.
  SupportPlane<T> bestPlane(const GjkResult<T>& found) const {
    SupportPlane<T> best;
    const auto offer = [&](const Vec3<T>& n) {
      if (!(n.squaredNorm() > T(0.5))) return;
      const T height = difference_.furthest(n).w.dot(n);
      if (height < best.height) best = {n, height};
    };
    const auto& v = found.simplex.vertex;
    const Vec3<T> towards = -found.v.normalized();
    offer(towards);
    if (settles(-best.height, found.v.norm())) return best;
    offer(found.normal);
    if (found.simplex.size == 2) {
      const Vec3<T> edge = (v[1].w - v[0].w).normalized();
      offer((towards - towards.dot(edge) * edge).normalized());
    }
    if (found.simplex.size == 3) {
      const Vec3<T> face = (v[1].w - v[0].w).cross(v[2].w - v[0].w).normalized();
      offer(face.dot(towards) < T(0) ? Vec3<T>(-face) : face);
    }
    return best;
  }

  bool isFar(const GjkResult<T>& found) const {
    return found.v.norm() >= T(NORMAL_FROM_FEATURE_BELOW) * found.magnitude;
  }

  bool fillApart(const GjkResult<T>& found, const Vec3<T>& n, PairDistance& result) const {
    result.nhat_AB_A = n.template cast<double>();
    finish(found.v.norm(), witnessesOf(found.simplex), result);
    result.certainty = Certainty::EXACT;
    return true;
  }

  // GJK took a sliver for an overlap: from the plane that proves otherwise it ends elsewhere.
  bool fillSeparated(const SupportPlane<T>& plane, PairDistance& result) const {
    if (curved_) return fillFromPlane(plane.normal, nullptr, result);
    const GjkResult<T> found = gjk<T>(difference_, -plane.normal);
    if (found.end == GjkEnd::OVERLAP) return fillFromPlane(plane.normal, nullptr, result);
    return fillFlatApart(found, result, plane);
  }

  // `known`: a support plane.
  bool fillFlatApart(const GjkResult<T>& found, PairDistance& result,
                     const SupportPlane<T>& known = {}) const {
    const T distance = found.v.norm();
    if (isFar(found) && settles(found.lower, distance)) {
      return fillFromVertices(found, found.lower, result) ||
             fillApart(found, -found.v / distance, result);
    }
    SupportPlane<T> plane = bestPlane(found);
    if (known.height < plane.height) plane = known;
    if (settles(-plane.height, distance) && (!IS_FINEST || plane.height < -rounding_)) {
      return fillFromVertices(found, -plane.height, result) ||
             fillApart(found, plane.normal, result);
    }
    if (!IS_FINEST) return false;
    // The polytope's faces give the separating plane that GJK misses because of rounding. If there
    // is none and the cores are this close, they touch.
    const EpaResult<T> planes = Epa<T>(difference_, found.simplex, found.magnitude).run(T(0));
    if (planes.upper < plane.height) plane = {planes.normal, planes.upper};
    const T lower = -plane.height;
    const bool is_exact = distance - lower + rounding_ <= largest_error_;
    if (is_exact && lower <= rounding_) {
      return fillOverlap(found.simplex, found.magnitude, true, true, result);
    }
    fillApart(found, plane.normal, result);
    if (is_exact) return true;
    result.distance = reported(lower);
    result.certainty = Certainty::DEGRADED;
    return false;
  }

  // GJK's own closest points if they are far enough apart to be exact, else those of the separating
  // plane. If there is none and the shapes are this close, they touch.
  bool fillCurvedApart(const GjkResult<T>& found, PairDistance& result) const {
    const T distance = found.v.norm();
    const auto isAlong = [&](const Vec3<T>& n) {
      return (found.v + distance * n).norm() <= T(WITNESS_TOLERANCE) * smaller_;
    };
    if (isFar(found) && settles(found.lower, distance) && isAlong(found.normal)) {
      return fillApart(found, found.normal, result);
    }
    LeastHeight<T> search(difference_);
    SupportPlane<T> least = search.search(found.normal);
    if (distance > T(0)) least = search.search(Vec3<T>(-found.v / distance));
    if (least.height < T(0) && fillFromPlane(least.normal, &found.simplex, result)) return true;
    // Stalled on slivers: the polytope's faces give the plane that GJK misses because of rounding.
    least = search.search(Epa<T>(difference_, found.simplex, found.magnitude).run(T(0)).normal);
    if (least.height < T(0)) return fillFromPlane(least.normal, &found.simplex, result);
    const bool sure = IS_FINEST && distance <= largest_error_;
    return fillOverlap(found.simplex, found.magnitude, sure, true, result);
  }

  // From the separating plane with normal n, and the simplex of GJK's closest points if there is
  // one.
  bool fillFromPlane(const Vec3<T>& n, const Simplex<T>* simplex, PairDistance& result) const {
    const T lower = -difference_.furthest(n).w.dot(n);
    Witnesses<T> closest{Vec3<T>::Zero(), Vec3<T>::Constant(std::numeric_limits<T>::infinity())};
    if (simplex != nullptr) closest = witnessesOf(*simplex);
    repairWitnesses(difference_, n, lower, largest_error_, closest);
    const T apart = closest.apart();
    if (residualOf(closest, n, lower) <= largest_error_) setApart(n, lower, closest);
    result.nhat_AB_A = n.template cast<double>();
    finish(lower, closest, result);
    const bool is_settled = settles(lower, apart);
    result.certainty = is_settled ? Certainty::EXACT : Certainty::DEGRADED;
    return is_settled;
  }

  // False if the features are not those of the closest points, or if there is nothing between them
  // but rounding.
  bool fillFromFeatures(const GjkResult<double>& found, Wanted wanted, PairDistance& result) const {
    const CylinderGapSearch search(difference_, found, COMMON_DEPTH * largest_error_);
    return search.offer([&](const CylinderGap& gap) {
      if (!gap.is_common) return fillFromWitnesses(gap.normal, gap.points, result);
      if (wanted == Wanted::DEPTH) return false;
      result.distance = reported(0.0);
      result.p_ACa = result.p_ACb = gap.points.a;
      return true;
    });
  }

  bool fillFromWitnesses(const Vec3<T>& n, Witnesses<T> closest, PairDistance& result) const {
    // Along an edge that runs through a cap nothing is left of the normal, and a height along
    // nothing is 0 wherever the two are.
    if (!(n.squaredNorm() > T(0.5))) return false;
    const T lower = -difference_.furthest(n).w.dot(n), apart = closest.apart();
    if (!settles(lower, apart) || residualOf(closest, n, lower) > largest_error_) return false;
    setApart(n, lower, closest);
    result.nhat_AB_A = n.template cast<double>();
    finish(lower, closest, result);
    result.certainty = Certainty::EXACT;
    return true;
  }

  const ConvexCore& A_;
  const ConvexCore& B_;
  ClosestVertices& between_;
  const bool curved_;
  const T smaller_;  // size of the smaller body
  const T radii_;
  const Difference<T> difference_;
  double magnitude_;
  T rounding_;       // of a height or a length
  T largest_error_;  // of an EXACT distance
  T band_;           // gaps up to this are contact
};

}  // namespace collision_pairs
