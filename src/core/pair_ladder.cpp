#include "pair_ladder.h"

#include <algorithm>
#include <cmath>

#include "prepared_shape.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

PairDistance beyond(double lower_bound) {
  PairDistance answer;
  answer.distance = lower_bound;
  answer.certainty = Certainty::BEYOND;
  return answer;
}

}  // namespace

void PairLadder::begin(const CollisionScene& scene, const std::vector<Isometry3d>& X_WE,
                       const std::vector<Aabb>& boxes) {
  scene_ = &scene;
  X_WE_ = &X_WE;
  boxes_ = &boxes;
}

// Relative first: far from the origin the difference is exact where the poses are not.
Isometry3d PairLadder::relativePose(const BoxPair& pair) const {
  return (*X_WE_)[pair.first].inverse() * (*X_WE_)[pair.second];
}

PairLadder::Answer PairLadder::measure(const BoxPair& pair, Fidelity rung, double max_distance) {
  if (rung == Fidelity::AABB) return measureBoxes(pair);
  return measureAt(pair, relativePose(pair), rung, max_distance);
}

PairLadder::Answer PairLadder::climb(const BoxPair& pair, Fidelity top, double max_distance) {
  if (top == Fidelity::AABB) return measureBoxes(pair);
  const Isometry3d X_AB = relativePose(pair);
  const double gap = turnedBoxGap(pair, X_AB);
  if (gap > max_distance) return {beyond(gap), Fidelity::OBB};
  Answer answer = measureAt(pair, X_AB, top, max_distance);
  if (answer.found.by_hulls) answer.rung = Fidelity::CONVEX;
  return answer;
}

bool PairLadder::touches(const BoxPair& pair, Fidelity top) {
  if (top != Fidelity::MESH) return climb(pair, top, 0.0).found.touches();
  const Isometry3d X_AB = relativePose(pair);
  if (turnedBoxGap(pair, X_AB) > 0.0) return false;
  const auto& elements = scene_->elements();
  return narrow_phase_.touches(*elements[pair.first].rung(top).shape,
                               *elements[pair.second].rung(top).shape, X_AB);
}

PairLadder::Answer PairLadder::measureAt(const BoxPair& pair, const Isometry3d& X_AB, Fidelity rung,
                                         double max_distance) {
  const Rung& a = scene_->elements()[pair.first].rung(rung);
  const Rung& b = scene_->elements()[pair.second].rung(rung);
  const double margin = a.margin + b.margin;
  const Isometry3d X = rung == Fidelity::OBB ? a.X_ER.inverse() * X_AB * b.X_ER : X_AB;
  Answer answer{narrow_phase_.distance(*a.shape, *b.shape, X, max_distance + margin), rung};
  PairDistance& found = answer.found;
  found.distance -= margin;
  if (found.certainty == Certainty::BEYOND) return answer;
  const Isometry3d& X_WE = (*X_WE_)[pair.first];
  const Isometry3d X_WA = rung == Fidelity::OBB ? X_WE * a.X_ER : X_WE;
  found.p_ACa = X_WA * found.p_ACa;
  found.p_ACb = X_WA * found.p_ACb;
  found.nhat_AB_A = X_WA.linear() * found.nhat_AB_A;
  if (rung != Fidelity::OBB) return answer;
  // The tight axis-aligned box need not enclose the turned one. Both enclose the element, so the
  // better bound of the two counts, and this rung never says less than the one below.
  const double boxes = std::sqrt(squaredGap((*boxes_)[pair.first], (*boxes_)[pair.second]));
  return boxes > std::max(found.distance, 0.0) ? Answer{measureBoxes(pair).found, rung} : answer;
}

PairLadder::Answer PairLadder::measureBoxes(const BoxPair& pair) const {
  const Aabb& a = (*boxes_)[pair.first];
  const Aabb& b = (*boxes_)[pair.second];
  const Vector3d gap = (b.min - a.max).cwiseMax(a.min - b.max);
  PairDistance found;
  int axis = 0;
  const double widest = gap.maxCoeff(&axis);
  // Witness points: the nearest points of the two boxes, mid-way where they overlap.
  const Vector3d lower = a.min.cwiseMax(b.min), upper = a.max.cwiseMin(b.max);
  const Vector3d middle = 0.5 * (lower + upper);
  found.p_ACa = middle.cwiseMax(a.min).cwiseMin(a.max);
  found.p_ACb = middle.cwiseMax(b.min).cwiseMin(b.max);
  if (widest > 0.0) {
    found.distance = std::sqrt(squaredGap(a, b));
    found.nhat_AB_A = (found.p_ACb - found.p_ACa) / found.distance;
  } else {  // the least translation along an axis that takes them apart
    const bool b_is_above = a.center()[axis] <= b.center()[axis];
    found.distance = widest;
    found.nhat_AB_A = (b_is_above ? 1.0 : -1.0) * Vector3d::Unit(axis);
    found.p_ACa[axis] = b_is_above ? a.max[axis] : a.min[axis];
    found.p_ACb[axis] = b_is_above ? b.min[axis] : b.max[axis];
  }
  return {found, Fidelity::AABB};
}

double PairLadder::turnedBoxGap(const BoxPair& pair, const Isometry3d& X_AB) const {
  const auto& a =
      static_cast<const Prepared&>(*scene_->elements()[pair.first].rung(Fidelity::MESH).shape);
  const auto& b =
      static_cast<const Prepared&>(*scene_->elements()[pair.second].rung(Fidelity::MESH).shape);
  if (a.isHalfSpace() || b.isHalfSpace()) return 0.0;
  return std::sqrt(squaredBoxGap(a.box, b.box, X_AB.linear(), X_AB.translation()));
}

}  // namespace collision_pairs
