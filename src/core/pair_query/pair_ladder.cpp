#include "pair_ladder.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "convex_distance.h"
#include "fcl_answer.h"
#include "infinity.h"
#include "scene_element.h"
#include "sphere_cover.h"
#include "sphere_distance.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

// clang-format off
// Why no rung misses what a finer one finds, with u = 2^-53 and r the largest coordinate of an
// element in its own frame. Every shape is enlarged by more than the possible error:
// - hull of a mesh: vertices are copied; Qhull drops a point within its own rounding of a facet,
//   about 7 u sqrt(3) r, and merges facets within a small multiple of it. Enlarged by 128 u r.
// - hull with fewer vertices: one is left out only where GJK finds it within t of the hull so far,
//   up to 16 u r. Enlarged by t and the hull's own.
// - OBB: 3 products a coordinate, 9 u r (Higham), and axes orthonormal within 8 u, 14 u r: 32 u r.
// - box along the element's axes: minima and maxima, 2 u r; comparing two rotates both,
//   9 u (r1 + r2 + |p|). 128 u of the sum of half sizes and centre.
// - axis-aligned box in the world: 4 products and sums, 4 u (3 r + |p|) with |p| its distance from
//   W. 16 to 32 u (r + |p|).
// - sphere: corners of clipped triangles. 1e-12 of its radius and of its centre's distance from E.
// All rungs use the same rounded pose. A gap of separated boxes is exact to u of itself. GJK
// reports "beyond" only by a separating plane, whose rounding, a few u of the sizes, is within
// ROUNDING, by which the limit is raised before the query and lowered after it. An axis-aligned box
// need not hold the OBB or a simplified hull: those rungs take the better of both answers.
// clang-format on
constexpr double LADDER_ROUNDING = 64.0 * std::numeric_limits<double>::epsilon();
constexpr double MOVED_LITTLE = 0.1;  // squared difference of two poses' matrices; metres

SpheresOrShape spheresOf(const SceneElement& element) {
  return {element.spheres ? &element.spheres->get() : nullptr,
          element.spheres ? nullptr : &preparedOf(element)};
}

/// A lower bound of what convexGap() found, but for roundingOf(). With a cylinder, a distance that
/// is EXACT has larger errors.
double certainGap(const PairDistance& gap, const ConvexCore& a, const ConvexCore& b) {
  const bool is_bound = gap.certainty == Certainty::BEYOND || !(a.curved() || b.curved());
  return is_bound ? gap.distance : lowerEndOfGap(gap, a, b);
}

/// What a bound by hulls is raised by before the query and lowered by after it: rounding, and the
/// error of FCL where it is what answers, so that no bound contradicts a contact. `offset`: of the
/// poses, see contactBand().
double errorOfBound(const Prepared& a, const ConvexCore& b, const Isometry3d& X_AB, double offset) {
  const double rounding =
      roundingOf(a.core, b) + contactBand(a.core, b, X_AB.translation(), offset);
  if (a.method != NarrowPhaseMethod::FCL) return rounding;
  return rounding + FCL_CONFIRMED * (a.core.extent + a.core.radius + b.extent + b.radius);
}

/// The element's box; its frame is at the centre.
ConvexCore coreOfBox(const SceneElement& element) {
  ConvexCore core;
  core.kind = ConvexCore::Kind::BOX;
  core.half = element.box_half;
  core.extent = core.half.norm();
  return core;
}

PairDistance beyond(double lower_bound) {
  PairDistance answer;
  answer.distance = lower_bound;
  answer.certainty = Certainty::BEYOND;
  return answer;
}

/// Transforms points and normal from the frame of A, and moves the points from the shapes to their
/// padded surfaces.
void inWorld(const Isometry3d& X_WA, double padding, PairDistance& found) {
  found.p_ACa = X_WA * found.p_ACa;
  found.p_ACb = X_WA * found.p_ACb;
  found.nhat_AB_A = X_WA.linear() * found.nhat_AB_A;
  if (!(padding > 0.0)) return;
  found.p_ACa += 0.5 * padding * found.nhat_AB_A;
  found.p_ACb -= 0.5 * padding * found.nhat_AB_A;
}

}  // namespace

void PairLadder::begin(const CollisionScene& scene, const std::vector<Isometry3d>& X_WE,
                       const std::vector<Aabb>& boxes) {
  scene_ = &scene;
  X_WE_ = &X_WE;
  boxes_ = &boxes;
  natively_before_ = narrow_phase_.numAnsweredNatively();
}

std::uint32_t PairLadder::numAnsweredNatively() const {
  return static_cast<std::uint32_t>(narrow_phase_.numAnsweredNatively() - natively_before_);
}

// The difference of the positions comes first: far from the origin it is exact, whereas
// transforming each position into the frame of A would round.
Isometry3d PairLadder::relativePose(const Isometry3d& X_WA, const Isometry3d& X_WB) {
  Isometry3d X_AB;
  X_AB.linear().noalias() = X_WA.linear().transpose() * X_WB.linear();
  X_AB.translation().noalias() =
      X_WA.linear().transpose() * (X_WB.translation() - X_WA.translation());
  X_AB.makeAffine();
  return X_AB;
}

PairLadder::Answer PairLadder::measure(const BoxPair& pair, Fidelity rung, double max_distance) {
  if (rung == Fidelity::AABB) return measureBoxes(pair);
  const Isometry3d X_AB = relativePose(pair);
  if (rung == Fidelity::SPHERES) return measureSpheres(pair, X_AB, max_distance);
  return measureAt(pair, X_AB, rung, max_distance, 0.0);
}

Fidelity PairLadder::rungOf(const BoxPair& pair, Fidelity top) const {
  const auto& elements = scene_->elements();
  return std::min({top, elements[pair.first].finest, elements[pair.second].finest});
}

bool PairLadder::needsTriangles(const BoxPair& pair, Fidelity top) const {
  if (rungOf(pair, top) != Fidelity::MESH) return false;
  const Prepared& a = preparedOf(scene_->elements()[pair.first]);
  const Prepared& b = preparedOf(scene_->elements()[pair.second]);
  return (a.mesh || b.mesh) && !a.isHalfSpace() && !b.isHalfSpace();
}

BoxPair PairLadder::byModel(const BoxPair& pair) const {
  const auto& elements = scene_->elements();
  return elements[pair.first].model < elements[pair.second].model
             ? pair
             : BoxPair{pair.second, pair.first};
}

PairLadder::Answer PairLadder::refine(const BoxPair& pair, Fidelity top, double max_distance,
                                      double tolerance) {
  top = rungOf(pair, top);
  if (top == Fidelity::AABB) return measureBoxes(pair);
  const Isometry3d X_AB = relativePose(pair);
  const double gap = obbGap(pair, X_AB);
  if (gap > max_distance) return {beyond(gap), Fidelity::OBB};
  if (top == Fidelity::SPHERES) return measureSpheres(pair, X_AB, max_distance);
  Answer answer = measureAt(pair, X_AB, top, max_distance, tolerance);
  if (answer.found.by_hulls) answer.rung = Fidelity::CONVEX;
  return answer;
}

PairLadder::Answer PairLadder::touches(const BoxPair& pair, Fidelity top) {
  top = rungOf(pair, top);
  const std::uint64_t degraded_before = narrow_phase_.numDegraded();
  PairDistance found;
  found.certainty = Certainty::BEYOND;
  if (!meets(pair, top)) return {found, top};
  const bool degraded = narrow_phase_.numDegraded() > degraded_before;
  found.certainty = degraded ? Certainty::DEGRADED : Certainty::BOUND;
  found.distance = 0.0;
  return {found, top};
}

bool PairLadder::meets(const BoxPair& pair, Fidelity rung) {
  if (rung == Fidelity::AABB) return measureBoxes(pair).found.touches();
  const Isometry3d X_AB = relativePose(pair);
  if (obbGap(pair, X_AB) > 0.0) return false;
  const double padding = scene_->padding(pair.first, pair.second);
  if (rung == Fidelity::SPHERES) {
    return spheresApart(pair, X_AB, 0.0).distance <= padding &&
           !(boxGap(pair, X_AB).distance > 0.0);
  }
  const Rung& a = scene_->elements()[pair.first].rung(rung);
  const Rung& b = scene_->elements()[pair.second].rung(rung);
  const double margin = a.margin + b.margin + padding;
  const Isometry3d X = rung == Fidelity::OBB ? a.X_ER.inverse() * X_AB * b.X_ER : X_AB;
  Vector3d& apart_along = lastOf(pair, X).apart_along;
  return narrow_phase_.touches(*a.shape, *b.shape, X, margin, offset(pair), &apart_along) &&
         !((a.loose || b.loose) && boxGap(pair, X_AB).distance > 0.0);
}

PairLadder::Last& PairLadder::lastOf(const BoxPair& pair, const Isometry3d& X_AB) {
  last_.resize(MOST_LAST);
  Last& last = last_[(pair.first * 31 + pair.second) % MOST_LAST];
  const bool has_moved = !((X_AB.matrix() - last.X_AB.matrix()).squaredNorm() < MOVED_LITTLE);
  if (has_moved || !(last.pair == pair)) last = {};
  last.pair = pair;
  last.X_AB = X_AB;
  return last;
}

PairLadder::Answer PairLadder::measureAt(const BoxPair& pair, const Isometry3d& X_AB, Fidelity rung,
                                         double max_distance, double tolerance) {
  const Rung& a = scene_->elements()[pair.first].rung(rung);
  const Rung& b = scene_->elements()[pair.second].rung(rung);
  const double padding = scene_->padding(pair.first, pair.second);
  const double margin = a.margin + b.margin + padding;
  const Isometry3d X = rung == Fidelity::OBB ? a.X_ER.inverse() * X_AB * b.X_ER : X_AB;
  const Accuracy accuracy{tolerance, margin};
  Answer answer{narrow_phase_.distance(*a.shape, *b.shape, X, max_distance + margin, accuracy,
                                       offset(pair), &lastOf(pair, X).between),
                rung};
  PairDistance& found = answer.found;
  found.distance -= margin;
  if (found.certainty == Certainty::BEYOND) return answer;
  const Isometry3d& X_WE = (*X_WE_)[pair.first];
  inWorld(rung == Fidelity::OBB ? X_WE * a.X_ER : X_WE, padding, found);
  if (!a.loose && !b.loose) return answer;
  found.p_ACa += a.margin * found.nhat_AB_A;  // onto the enlarged shapes
  found.p_ACb -= b.margin * found.nhat_AB_A;
  return notBelowBoxes(pair, X_AB, answer);
}

// The element's boxes need not enclose the spheres, a simplified hull, or the OBB of the ladder.
// All enclose the element, so the best bound is used: no rung is worse than the coarsest, and a
// report finds no contact where a verdict has ended at the boxes.
PairLadder::Answer PairLadder::notBelowBoxes(const BoxPair& pair, const Isometry3d& X_AB,
                                             Answer answer) const {
  const Answer boxes = measureBoxes(pair);
  if (boxes.found.distance > answer.found.distance) answer.found = boxes.found;
  PairDistance found = boxGap(pair, X_AB);
  if (!(found.distance > answer.found.distance)) return answer;
  Isometry3d X_AC = Isometry3d::Identity();
  X_AC.translation() = scene_->elements()[pair.first].box_center;
  inWorld((*X_WE_)[pair.first] * X_AC, scene_->padding(pair.first, pair.second), found);
  return {found, answer.rung};
}

// Their distance, also where obbGap() sees no gap along their axes: then this would jump, and a
// motion is certified by how fast a distance can change.
PairDistance PairLadder::boxGap(const BoxPair& pair, const Isometry3d& X_AB) const {
  PairDistance gap;
  gap.distance = -INF;
  const SceneElement &a = scene_->elements()[pair.first], &b = scene_->elements()[pair.second];
  if (std::isinf(a.box_half[0]) || std::isinf(b.box_half[0])) return gap;
  const ConvexCore core_a = coreOfBox(a), core_b = coreOfBox(b);
  Isometry3d X = X_AB;  // of the boxes' centres
  X.translation() = X_AB * b.box_center - a.box_center;
  const PairDistance found = convexGap(core_a, core_b, X, INF);
  if (found.certainty != Certainty::EXACT || !(found.distance > 0.0)) return gap;
  gap = found;
  gap.distance -= scene_->padding(pair.first, pair.second) +
                  contactBand(core_a, core_b, X.translation(), offset(pair));
  return gap;
}

PairDistance PairLadder::spheresApart(const BoxPair& pair, const Isometry3d& X_AB,
                                      double max_distance) {
  const SceneElement &a = scene_->elements()[pair.first], &b = scene_->elements()[pair.second];
  const double padding = scene_->padding(pair.first, pair.second);
  const double reach = max_distance + padding;
  if (!a.spheres && !b.spheres) {
    return narrow_phase_.distance(*a.rung(Fidelity::MESH).shape, *b.rung(Fidelity::MESH).shape,
                                  X_AB, reach, {0.0, padding}, offset(pair));
  }
  // The triangles of a mesh need not be prepared.
  const auto coreOf = [](const SceneElement& element) {
    if (!element.spheres) return preparedOf(element).core;
    ConvexCore core = coreOfBox(element);
    core.center = element.box_center;
    return core;
  };
  const double band = contactBand(coreOf(a), coreOf(b), X_AB.translation(), offset(pair));
  PairDistance found =
      sphereDistance(spheresOf(a), spheresOf(b), X_AB, reach + band, padding + band);
  found.distance -= band;
  return found;
}

PairLadder::Answer PairLadder::measureSpheres(const BoxPair& pair, const Isometry3d& X_AB,
                                              double max_distance) {
  const double padding = scene_->padding(pair.first, pair.second);
  Answer answer{spheresApart(pair, X_AB, max_distance), Fidelity::SPHERES};
  answer.found.distance -= padding;
  if (answer.found.certainty == Certainty::BEYOND) return answer;
  inWorld((*X_WE_)[pair.first], padding, answer.found);
  return notBelowBoxes(pair, X_AB, answer);
}

PairLadder::Answer PairLadder::boundOfAlignedBoxes(const BoxPair& pair, double max_distance) const {
  Answer bound = measureBoxes(pair);
  const bool is_beyond = bound.found.distance > max_distance;
  bound.found.certainty = is_beyond ? Certainty::BEYOND : Certainty::UNFINISHED;
  return bound;
}

PairLadder::Answer PairLadder::boundOfBoxes(const BoxPair& pair, double max_distance) const {
  Answer bound = boundOfAlignedBoxes(pair, max_distance);
  const double gap = obbGap(pair, relativePose(pair));
  if (gap > max_distance) return {beyond(gap), Fidelity::OBB};
  if (gap <= std::max(bound.found.distance, 0.0)) return bound;
  bound.found.distance = gap;
  bound.rung = Fidelity::OBB;
  return bound;
}

PairLadder::Answer PairLadder::boundOfHulls(const BoxPair& pair, const Answer& known,
                                            double max_distance) const {
  const Prepared& a = preparedOf(scene_->elements()[pair.first]);
  const Prepared& b = preparedOf(scene_->elements()[pair.second]);
  const Isometry3d X_AB = relativePose(pair);
  const double error = errorOfBound(a, b.core, X_AB, offset(pair));
  const double margin = error + scene_->padding(pair.first, pair.second);
  const PairDistance gap = convexGap(a.core, b.core, X_AB, max_distance + margin, error);
  const double distance = certainGap(gap, a.core, b.core) - margin;
  if (gap.certainty == Certainty::DEGRADED || distance <= std::max(known.found.distance, 0.0)) {
    return known;
  }
  if (distance > max_distance) return {beyond(distance), Fidelity::CONVEX};
  Answer bound = known;
  bound.found.distance = distance;
  bound.rung = Fidelity::CONVEX;
  return bound;
}

double PairLadder::hullsApart(std::uint32_t element, Fidelity rung, const ConvexCore& shape,
                              const Isometry3d& X_WS, double max_distance, Vector3d& nhat_E) const {
  const Rung& of_element = scene_->elements()[element].rung(rung);
  const Prepared& prepared = preparedOf(of_element);
  const Isometry3d& X_WE = (*X_WE_)[element];
  const Isometry3d X_ES = relativePose(X_WE, X_WS);
  const double margin = errorOfBound(prepared, shape, X_ES, offset(X_WE, X_WS)) + of_element.margin;
  return roughGap(nhat_E, prepared.core, shape, X_ES, max_distance + 2.0 * margin) - margin;
}

double PairLadder::errorOfSurface(std::uint32_t element, const ConvexCore& shape,
                                  const Isometry3d& X_WS) const {
  const Isometry3d& X_WE = (*X_WE_)[element];
  const Prepared& prepared = preparedOf(scene_->elements()[element]);
  return errorOfBound(prepared, shape, relativePose(X_WE, X_WS), offset(X_WE, X_WS));
}

double PairLadder::reachAlong(const Vector3d& nhat_W, std::uint32_t element, Fidelity rung,
                              const ConvexCore& shape) const {
  const Rung& of_element = scene_->elements()[element].rung(rung);
  const Prepared& prepared = preparedOf(of_element);
  const Isometry3d& X_WE = (*X_WE_)[element];
  const Vector3d nhat_E = X_WE.linear().transpose() * nhat_W;
  const double furthest = nhat_W.dot(X_WE * support<double>(prepared.core, nhat_E));
  return furthest + prepared.core.radius + of_element.margin +
         errorOfBound(prepared, shape, X_WE, X_WE.translation().norm());
}

PairLadder::Answer PairLadder::measureBoxes(const BoxPair& pair) const {
  const Aabb& a = (*boxes_)[pair.first];
  const Aabb& b = (*boxes_)[pair.second];
  const Vector3d gap = (b.min - a.max).cwiseMax(a.min - b.max);
  PairDistance found;
  int axis = 0;
  const double widest = gap.maxCoeff(&axis);
  // Witness points: the nearest points of the two boxes, in the middle of the overlap on axes where
  // they overlap.
  const Vector3d lower = a.min.cwiseMax(b.min), upper = a.max.cwiseMin(b.max);
  const Vector3d middle = 0.5 * (lower + upper);
  found.p_ACa = middle.cwiseMax(a.min).cwiseMin(a.max);
  found.p_ACb = middle.cwiseMax(b.min).cwiseMin(b.max);
  if (widest > 0.0) {
    found.distance = std::sqrt(squaredGap(a, b));
    found.nhat_AB_A = (found.p_ACb - found.p_ACa) / found.distance;
  } else {  // the smallest translation along an axis that separates them
    const bool b_is_above = a.center()[axis] <= b.center()[axis];
    found.distance = widest;
    found.nhat_AB_A = (b_is_above ? 1.0 : -1.0) * Vector3d::Unit(axis);
    found.p_ACa[axis] = b_is_above ? a.max[axis] : a.min[axis];
    found.p_ACb[axis] = b_is_above ? b.min[axis] : b.max[axis];
  }
  return {found, Fidelity::AABB};
}

double PairLadder::obbGap(const BoxPair& pair, const Isometry3d& X_AB) const {
  const SceneElement& a = scene_->elements()[pair.first];
  const SceneElement& b = scene_->elements()[pair.second];
  const double padding = scene_->padding(pair.first, pair.second);
  if (std::isinf(a.box_half[0]) || std::isinf(b.box_half[0])) return -padding;
  const Vector3d p_AB = X_AB * b.box_center - a.box_center;
  const double squared_gap = squaredBoxGap(a.box_half, b.box_half, X_AB.linear(), p_AB);
  if (!(squared_gap > 0.0)) return -padding;
  const double coordinates = a.box_center.lpNorm<1>() + a.box_half.sum() +
                             X_AB.translation().lpNorm<1>() + b.box_center.lpNorm<1>() +
                             b.box_half.sum() + offset(pair);
  return std::sqrt(squared_gap) - LADDER_ROUNDING * coordinates - padding;
}

}  // namespace collision_pairs
