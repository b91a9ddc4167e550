// The table of methods for each pair of shapes.
//
//   pair                                   yes or no            signed distance
//   half-space, anything                   lowest point         the same
//   sphere, primitive                      closed form          the same
//   capsule, capsule                       closed form          the same
//   box, box                               separating axes      GJK, EPA
//   convex, convex (all others)            a common point, GJK  GJK, EPA; cylinders: and Newton
//   mesh, anything                         hulls first         hulls first
//   mesh, convex                           triangles, inside    triangles; depth: hulls by EPA
//   mesh, mesh                             triangles, inside    triangles; depth: hulls by EPA
//
// "convex" is every primitive, every Convex and every mesh that is convex. With a margin, yes or no
// for a mesh uses the signed distance, and two boxes are treated like all other convex shapes. With
// NarrowPhaseMethod::FCL this table is used only for what FCL does not answer (Scratch::touches,
// ::distance).
#include "collision_pairs/narrow_phase.h"

#include <algorithm>
#include <cmath>

#include "closed_forms.h"
#include "convex_distance.h"
#include "infinity.h"
#include "mesh_query.h"
#include "plain_pairs.h"
#include "pose_repair.h"
#include "solids.h"
#include "surface_contact.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double NORMAL_FROM_TRIANGLES_BELOW = 1e-4;  // of the triangles' size
constexpr double LARGEST_ERROR = 1e-9;  // of a native distance, of the two bodies' size

double justAbove(double metres) { return std::nextafter(metres, INF); }

bool isWithin(const PairDistance& found, double metres) {
  return found.certainty != Certainty::BEYOND && found.distance <= metres;
}

double scaleOf(const Prepared& shape) { return shape.core.extent + shape.core.radius; }

}  // namespace

struct NarrowPhase::Scratch {
  MeshQuery query;
  SurfaceContact contacts;
  std::uint64_t nb_degraded = 0;
  std::uint64_t nb_answered_natively = 0;
  double band = 0.0;                   // of the pair that is asked about: contactBand()
  ClosestVertices* between = nullptr;  // of its hulls, or null

  bool touches(const Prepared& A, const Prepared& B, const Isometry3d& X_AB, double margin,
               PairDistance& result) {
    return asksFcl(A, B) ? fclTouches(A, B, X_AB, margin, result)
                         : nativeTouches(A, B, X_AB, margin, result);
  }

  // True if a plane keeps the two so far apart that no arithmetic could find them in contact.
  bool areApartAlong(const Vector3d& n, const Prepared& A, const Prepared& B,
                     const Isometry3d& X_AB, double margin) const {
    if (n.isZero(0.0) || asksFcl(A, B) || A.isHalfSpace() || B.isHalfSpace()) return false;
    return gapAlong(n, A.core, B.core, X_AB) > margin + band + errorOf(A, B);
  }

  // Whether the two are within contact_distance is what touches() says.
  PairDistance distance(const Prepared& A, const Prepared& B, const Isometry3d& X_AB,
                        double max_distance, const Accuracy& accuracy) {
    const bool asks_fcl = asksFcl(A, B);
    const std::uint64_t natively_before = nb_answered_natively;
    PairDistance found = search(A, B, X_AB, max_distance, accuracy);
    const double within = accuracy.contact_distance;
    const bool is_uncertain = found.certainty == Certainty::DEGRADED ||
                              std::abs(found.distance - within) <= errorOf(A, B);
    // touches() would do just the same.
    const bool is_same = (within == 0.0 || (within == max_distance && accuracy.isExact())) &&
                         (A.mesh || B.mesh || asks_fcl);
    if (is_uncertain && !is_same) decide(A, B, X_AB, within, found);
    nb_answered_natively = std::min(nb_answered_natively, natively_before + 1);
    if (found.certainty == Certainty::BEYOND) {
      found.distance = std::max(found.distance, justAbove(max_distance));
    } else if (found.distance > max_distance) {
      found.certainty = Certainty::BEYOND;
    }
    return found;
  }

 private:
  static bool asksFcl(const Prepared& A, const Prepared& B) {
    return A.method == NarrowPhaseMethod::FCL && B.method == NarrowPhaseMethod::FCL;
  }

  PairDistance search(const Prepared& A, const Prepared& B, const Isometry3d& X_AB,
                      double max_distance, const Accuracy& accuracy) {
    return asksFcl(A, B) ? fclDistance(A, B, X_AB, max_distance, accuracy)
                         : nativeDistance(A, B, X_AB, max_distance, accuracy);
  }

  // Rounding may put a distance on the wrong side of one that differs from it by less, in metres.
  static double errorOf(const Prepared& A, const Prepared& B) {
    return (asksFcl(A, B) ? FCL_CONFIRMED : LARGEST_ERROR) * (scaleOf(A) + scaleOf(B));
  }

  // For a distance that rounding may have put on the wrong side of contact_distance.
  void decide(const Prepared& A, const Prepared& B, const Isometry3d& X_AB, double contact_distance,
              PairDistance& found) {
    PairDistance detail;
    const bool is_contact = touches(A, B, X_AB, contact_distance, detail);
    if (is_contact && found.certainty == Certainty::BEYOND) found = search(A, B, X_AB, INF, {});
    if (detail.certainty == Certainty::DEGRADED) {
      found.certainty = Certainty::DEGRADED;
    } else if (is_contact && found.certainty == Certainty::DEGRADED) {
      found.certainty = Certainty::BOUND;
    }
    if (!is_contact && found.distance < -errorOf(A, B)) found.certainty = Certainty::DEGRADED;
    found.distance = is_contact ? std::min(found.distance, contact_distance)
                                : std::max(found.distance, justAbove(contact_distance));
  }

  // FCL if it has a result. Containment, the depth of contained bodies, and what is nearer to
  // contact than FCL can tell are always computed natively.
  bool fclTouches(const Prepared& A, const Prepared& B, const Isometry3d& X_AB, double margin,
                  PairDistance& result) {
    if (margin > 0.0) {
      result = fclDistance(A, B, X_AB, margin, {});
      return isWithin(result, margin);
    }
    const auto fcl = A.fcl && B.fcl ? askFcl(*A.fcl, *B.fcl, X_AB, {}) : FclAnswer();
    using Outcome = FclAnswer::Outcome;
    if (fcl.outcome == Outcome::TOUCHING || fcl.outcome == Outcome::DEPTH) {
      return !isHairApart(A, B, X_AB);
    }
    if (fcl.outcome == Outcome::APART && !oneHoldsTheOther(A, B, X_AB) && !abut(A, B, X_AB)) {
      return false;
    }
    ++nb_answered_natively;
    return fcl.outcome == Outcome::APART || nativeTouches(A, B, X_AB, 0.0, result);
  }

  PairDistance fclDistance(const Prepared& A, const Prepared& B, const Isometry3d& X_AB,
                           double max_distance, const Accuracy& accuracy) {
    const bool has_fcl = A.fcl && B.fcl;
    const auto fcl = has_fcl ? askFcl(*A.fcl, *B.fcl, X_AB, max_distance) : FclAnswer();
    using Outcome = FclAnswer::Outcome;
    // FCL's normal of two whose axes meet may lie along them.
    const auto isAlongNormal = [&](const PairDistance& depth) {
      return gapAlong(depth.nhat_AB_A, A.core, B.core, X_AB) >= depth.distance - errorOf(A, B);
    };
    const bool is_shallow = fcl.outcome == Outcome::DEPTH && fcl.found.distance >= -errorOf(A, B);
    if ((fcl.outcome == Outcome::TOUCHING || is_shallow) && isHairApart(A, B, X_AB)) {
      return nativeDistance(A, B, X_AB, max_distance, accuracy);
    }
    if (fcl.outcome == Outcome::DEPTH && isAlongNormal(fcl.found)) return fcl.found;
    const bool is_clear = fcl.found.distance > errorOf(A, B) + band;
    if (fcl.outcome == Outcome::APART && !oneHoldsTheOther(A, B, X_AB) &&
        (is_clear || !abut(A, B, X_AB))) {
      return fcl.found;
    }
    ++nb_answered_natively;
    if (fcl.outcome == Outcome::NONE) {
      PairDistance native = nativeDistance(A, B, X_AB, max_distance, accuracy);
      if (has_fcl) decide(A, B, X_AB, 0.0, native);  // FCL may say yes or no without a distance
      return native;
    }
    if (A.mesh || B.mesh) return hullDepth(A, B, X_AB, {});
    PairDistance depth = convexPair(A, B, X_AB, INF, band);
    depth.distance = std::min(depth.distance, 0.0);  // FCL decided that they touch
    if (depth.certainty == Certainty::DEGRADED) depth.certainty = Certainty::BOUND;
    return depth;
  }

  // For two that FCL has apart: true if the gap is too small for it, and natively a contact.
  bool abut(const Prepared& A, const Prepared& B, const Isometry3d& X_AB) {
    PairDistance detail;
    if (!nativeTouches(A, B, X_AB, 0.0, detail)) return false;
    const double error = errorOf(A, B) + band;
    const FclAnswer asked = askFcl(*A.fcl, *B.fcl, X_AB, error);
    return asked.outcome != FclAnswer::Outcome::APART || asked.found.distance <= error;
  }

  // For two that FCL has in contact: true if they are natively apart, by less than FCL can tell.
  bool isHairApart(const Prepared& A, const Prepared& B, const Isometry3d& X_AB) {
    PairDistance detail;
    if (nativeTouches(A, B, X_AB, 0.0, detail)) return false;
    const double error = errorOf(A, B) + band;
    const bool is_apart = isWithin(nativeDistance(A, B, X_AB, error), error);
    nb_answered_natively += is_apart;
    return is_apart;
  }

  // For two whose surfaces are disjoint.
  bool oneHoldsTheOther(const Prepared& A, const Prepared& B, const Isometry3d& X_AB) const {
    if ((!A.mesh && !B.mesh) || hullsMiss(A, B, X_AB, band)) return false;
    const Isometry3d X_BA = X_AB.inverse(Eigen::Isometry);
    if (!B.mesh) return meshHoldsConvex(A, B, X_AB);
    if (!A.mesh) return meshHoldsConvex(B, A, X_BA);
    return meshHoldsMesh(A, B, X_AB) || meshHoldsMesh(B, A, X_BA);
  }

  bool nativeTouches(const Prepared& A, const Prepared& B, const Isometry3d& X_AB, double margin,
                     PairDistance& result) {
    if (A.isHalfSpace() || B.isHalfSpace()) {
      return halfSpaceWith(A, B, X_AB, band).distance <= margin;
    }
    if (!A.mesh && !B.mesh) return convexTouch(A, B, X_AB, margin, band, result);
    if (margin > 0.0) {
      result = nativeDistance(A, B, X_AB, margin);
      return isWithin(result, margin);
    }
    return !hullsMiss(A, B, X_AB, band, &result.nhat_AB_A) && solidsMeet(A, B, X_AB);
  }

  // For two whose hulls may overlap, one of them a mesh: surfaces that meet, or containment. All
  // contacts of meshes are decided here; splitting boxes finds them much faster than a distance.
  bool solidsMeet(const Prepared& A, const Prepared& B, const Isometry3d& X_AB) {
    const Isometry3d X_BA = X_AB.inverse(Eigen::Isometry);
    if (A.mesh && B.mesh) {
      if (squaredBoxGap(A.box, B.box.movedBy(X_AB)) > band * band) return false;
      return contacts.surfacesMeet(*A.mesh, *B.mesh, X_AB, band) || meshHoldsMesh(A, B, X_AB) ||
             meshHoldsMesh(B, A, X_BA);
    }
    const Prepared& M = A.mesh ? A : B;
    const Prepared& C = A.mesh ? B : A;
    const Isometry3d& X_MC = A.mesh ? X_AB : X_BA;
    return !query.meshConvex(*M.mesh, C.core, X_MC, 0.0, band).beyond ||
           meshHoldsConvex(M, C, X_MC);
  }

  // The shortest translation that separates the hulls: an upper bound of the depth of a contact.
  PairDistance hullDepth(const Prepared& A, const Prepared& B, const Isometry3d& X_AB,
                         const CoreOverlap& overlap) const {
    PairDistance result = overlap.found() ? convexDepth(A.core, B.core, X_AB, overlap, band)
                                          : convexPair(A, B, X_AB, INF, band);
    if (result.distance > 0.0) result.distance = 0.0;
    result.certainty = Certainty::BOUND;
    return result;
  }

  // If surfaces nearly touch, their closest points give no direction: use the two triangles, or the
  // triangle and the convex shape.
  static void setNormal(const SurfaceGap& gap, const ConvexCore& a, const ConvexCore& b,
                        const Isometry3d& X_AB, PairDistance& result) {
    const bool is_clear =
        gap.distance > NORMAL_FROM_TRIANGLES_BELOW * (a.extent + b.extent + b.radius);
    result.nhat_AB_A = is_clear ? Vector3d((gap.p_ACb - gap.p_ACa).normalized())
                                : convexDistance(a, b, X_AB, INF).nhat_AB_A;
  }

  // The result for two that do not meet, but may be nearer than any number. Without triangles: too
  // far apart, or two patches settled by their hulls.
  static PairDistance apart(const SurfaceGap& gap) {
    PairDistance result;
    result.distance = std::max(gap.distance, justAbove(0.0));
    if (gap.beyond) {
      result.certainty = Certainty::BEYOND;
      return result;
    }
    result.p_ACa = gap.p_ACa;
    result.p_ACb = gap.p_ACb;
    result.nhat_AB_A = gap.nhat_AB_A;
    return result;
  }

  // The two points of the solids found from the closest points of the hulls.
  static PairDistance besideHulls(const HullBounds& bounds) {
    PairDistance result;
    result.distance = bounds.upper;
    result.p_ACa = bounds.p_ACa;
    result.p_ACb = bounds.p_ACb;
    result.nhat_AB_A = (bounds.p_ACb - bounds.p_ACa).normalized();
    return result;
  }

  // For two that are apart: replaces the upper end of the certified interval by the lower one.
  static PairDistance tolerated(PairDistance found, double lower, const Accuracy& accuracy) {
    if (accuracy.isExact() || found.certainty == Certainty::BEYOND ||
        found.distance <= accuracy.contact_distance || lower >= found.distance) {
      return found;
    }
    found.distance = std::max(lower, justAbove(accuracy.contact_distance));
    found.certainty = Certainty::TOLERATED;
    return found;
  }

  // For two that do not meet.
  PairDistance meshDistance(const Prepared& A, const Prepared& B, const Isometry3d& X_AB,
                            double max_distance, const Accuracy& accuracy,
                            const HullBounds& bounds) {
    if (!A.mesh) {
      const Isometry3d X_BA = X_AB.inverse(Eigen::Isometry);
      return exchanged(meshDistance(B, A, X_BA, max_distance, accuracy, bounds), X_AB);
    }
    const bool hulls_meet = bounds.outcome == HullBounds::Outcome::OPEN;
    const Vector3d* nhat_AB_A = hulls_meet ? nullptr : &bounds.hulls.nhat_AB_A;
    const SurfaceGap gap =
        B.mesh ? query.meshMesh(*A.mesh, *B.mesh, X_AB, max_distance, band, nhat_AB_A, accuracy)
               : query.meshConvex(*A.mesh, B.core, X_AB, max_distance, band, accuracy);
    PairDistance result = apart(gap);
    if (!gap.beyond && !gap.by_hulls) {
      const auto corners_a = cornersOf(*A.mesh->triangles, gap.triangle_a);
      const auto corners_b = B.mesh ? cornersOf(*B.mesh->triangles, gap.triangle_b) : corners_a;
      setNormal(gap, cornersCore(corners_a), B.mesh ? cornersCore(corners_b) : B.core, X_AB,
                result);
    }
    return tolerated(result, std::max(gap.lower, bounds.lower), accuracy);
  }

  // For two that are apart: searches for points nearer than the two known ones by more than the
  // tolerance. If there are none, the known ones are the result.
  PairDistance distanceFromKnown(const Prepared& A, const Prepared& B, const Isometry3d& X_AB,
                                 const Accuracy& accuracy, const HullBounds& bounds) {
    const double far_enough = accuracy.farEnough(bounds.upper);
    const PairDistance known = besideHulls(bounds);
    if (bounds.lower > accuracy.contact_distance && bounds.lower >= far_enough) {
      return tolerated(known, bounds.lower, accuracy);
    }
    const PairDistance found = meshDistance(A, B, X_AB, far_enough, accuracy, bounds);
    if (found.certainty != Certainty::BEYOND) return found;
    return tolerated(known, std::max(found.distance, bounds.lower), accuracy);
  }

  PairDistance nativeDistance(const Prepared& A, const Prepared& B, const Isometry3d& X_AB,
                              double max_distance, const Accuracy& accuracy = {}) {
    if (A.isHalfSpace() || B.isHalfSpace()) return halfSpaceWith(A, B, X_AB, band);
    if (!A.mesh && !B.mesh) return convexPair(A, B, X_AB, max_distance, band, between);
    HullBounds bounds = boundsFromHulls(A, B, X_AB, max_distance, band, between);
    using Outcome = HullBounds::Outcome;
    if (bounds.outcome == Outcome::BEYOND || bounds.outcome == Outcome::SETTLED) {
      bounds.hulls.by_hulls = true;
      return bounds.hulls;
    }
    if (bounds.outcome == Outcome::OPEN) {
      if (solidsMeet(A, B, X_AB)) return hullDepth(A, B, X_AB, bounds.overlap);
      if (max_distance == 0.0) return apart(SurfaceGap{0.0});
    } else if (bounds.upper <= max_distance) {
      return distanceFromKnown(A, B, X_AB, accuracy, bounds);
    }
    return meshDistance(A, B, X_AB, max_distance, accuracy, bounds);
  }
};

namespace {

// The result without a valid pose: the shapes may penetrate by up to their size.
PairDistance worstCase(const Prepared& A, const Prepared& B) {
  PairDistance result;
  const bool unbounded = A.isHalfSpace() || B.isHalfSpace();
  result.distance = unbounded ? -INF : -2.0 * (scaleOf(A) + scaleOf(B));
  result.certainty = Certainty::DEGRADED;
  return result;
}

}  // namespace

NarrowPhase::NarrowPhase() : scratch_(std::make_unique<Scratch>()) {}
NarrowPhase::~NarrowPhase() = default;
NarrowPhase::NarrowPhase(NarrowPhase&&) noexcept = default;
NarrowPhase& NarrowPhase::operator=(NarrowPhase&&) noexcept = default;

bool NarrowPhase::touches(const PreparedShape& A, const PreparedShape& B, const Isometry3d& X_AB,
                          double margin, double offset, Vector3d* apart_along) {
  const auto& a = static_cast<const Prepared&>(A);
  const auto& b = static_cast<const Prepared&>(B);
  Isometry3d X = X_AB;
  scratch_->band = contactBand(a.core, b.core, X.translation(), offset);
  PairDistance detail = repairPose(X) ? PairDistance() : worstCase(a, b);
  const bool is_pose = detail.certainty != Certainty::DEGRADED;
  if (apart_along && is_pose && scratch_->areApartAlong(*apart_along, a, b, X, margin))
    return false;
  const bool answer = !is_pose || scratch_->touches(a, b, X, margin, detail);
  if (detail.certainty == Certainty::DEGRADED) ++scratch_->nb_degraded;
  if (apart_along) *apart_along = answer ? Vector3d(Vector3d::Zero()) : detail.nhat_AB_A;
  return answer;
}

PairDistance NarrowPhase::distance(const PreparedShape& A, const PreparedShape& B,
                                   const Isometry3d& X_AB, double max_distance,
                                   const Accuracy& accuracy, double offset,
                                   ClosestVertices* between) {
  const auto& a = static_cast<const Prepared&>(A);
  const auto& b = static_cast<const Prepared&>(B);
  Isometry3d X = X_AB;
  scratch_->band = contactBand(a.core, b.core, X.translation(), offset);
  scratch_->between = between;
  const PairDistance result =
      repairPose(X) ? scratch_->distance(a, b, X, max_distance, accuracy) : worstCase(a, b);
  if (result.certainty == Certainty::DEGRADED) ++scratch_->nb_degraded;
  return result;
}

std::uint64_t NarrowPhase::numDegraded() const { return scratch_->nb_degraded; }

std::uint64_t NarrowPhase::numAnsweredNatively() const { return scratch_->nb_answered_natively; }

}  // namespace collision_pairs
