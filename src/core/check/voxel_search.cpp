#include "voxel_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "convex_core.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double INF = std::numeric_limits<double>::infinity();
constexpr double ROUNDING = 64.0 * std::numeric_limits<double>::epsilon();
constexpr double SAME = 1e-10;  // metres: smaller differences of voxels' distances are ignored

Aabb grown(const Aabb& box, double metres) {
  const Vector3d all = Vector3d::Constant(metres);
  return {box.min - all, box.max + all};
}

/// A lower bound of the signed distance of two boxes with the same axes, and of what they enclose:
/// their gap, or minus the smallest translation along an axis that separates them.
double signedGap(const Vector3d& between) {
  const double widest = between.maxCoeff();
  return widest > 0.0 ? between.cwiseMax(0.0).norm() : widest;
}

/// A box as a convex shape around its centre, and its pose; enlarged by rounding.
ConvexCore coreOf(const Aabb& box) {
  ConvexCore core;
  core.kind = ConvexCore::Kind::BOX;
  core.half = 0.5 * (1.0 + ROUNDING) * (box.max - box.min);
  core.extent = core.half.norm();
  return core;
}

Isometry3d poseOf(const Aabb& box) {
  Isometry3d X = Isometry3d::Identity();
  X.translation() = box.center();
  return X;
}

double sizeOf(const Aabb& box) {
  return box.min.cwiseAbs().cwiseMax(box.max.cwiseAbs()).maxCoeff();
}

}  // namespace

void VoxelSearch::begin(const CollisionScene& scene, std::vector<Isometry3d>& X_WE,
                        std::vector<Aabb>& boxes, PairLadder& ladder) {
  scene_ = &scene;
  X_WE_ = &X_WE;
  boxes_ = &boxes;
  ladder_ = &ladder;
}

bool VoxelSearch::isWithin(const BoxPair& pair, const OccupiedVoxels& voxels, double reach) {
  setBox(pair, voxels);
  return voxels.anyWithin(box_, reach);
}

void VoxelSearch::setBox(const BoxPair& pair, const OccupiedVoxels& voxels) {
  const bool cloud_is_first = scene_->cloudOf(pair.first) >= 0;
  of_cloud_ = cloud_is_first ? pair.first : pair.second;
  of_link_ = cloud_is_first ? pair.second : pair.first;
  const double padding = scene_->elements()[of_cloud_].box_padding;
  rounding_ = ROUNDING * (sizeOf(voxels.bounds()) + padding);
  box_ = grown((*boxes_)[of_link_], padding + rounding_);
}

void VoxelSearch::start(const BoxPair& pair, const OccupiedVoxels& voxels, Fidelity rung,
                        double max_distance) {
  pair_ = pair;
  voxels_ = &voxels;
  setBox(pair, voxels);
  const SceneElement& element = scene_->elements()[of_link_];
  padding_ = scene_->padding(pair.first, pair.second) + rounding_;
  rung_ = rung;
  size_ = element.box_half.norm();
  has_triangles_ = ladder_->needsTriangles(pair, rung);
  // At rungs that are larger than the element's box, the box is no bound.
  const Rung& shape = element.rung(rung);
  has_oriented_ = rung >= Fidelity::CONVEX && !shape.loose && std::isfinite(element.box_half[0]);
  if (has_oriented_) {
    const Isometry3d& X_WE = (*X_WE_)[of_link_];
    oriented_ = {X_WE.linear(), X_WE * element.box_center, element.box_half};
    padding_ += ROUNDING * oriented_.center.lpNorm<1>();
  }
  limit_ = max_distance;
  best_ = INF;
  nearest_ = contact_ = {};
  nearest_.answer.found.certainty = contact_.answer.found.certainty = Certainty::BEYOND;
  nhat_E_.setZero();
  reach_along_ = INF;
  normals_.clear();
  heap_.clear();
  outside_.clear();
  cells_ = voxels.cellsWithin(box_, std::min(max_distance, 1e100));
  Entry root{0.0, voxels.rootCorner(), 0, static_cast<std::int8_t>(voxels.levels().size() - 1),
             Bound::ALIGNED_BOXES};
  root.bound = boundOfAlignedBoxes(root);
  push(root);
}

void VoxelSearch::push(Entry entry) {
  heap_.push_back(entry);
  std::push_heap(heap_.begin(), heap_.end());
}

VoxelSearch::Entry VoxelSearch::pop() {
  std::pop_heap(heap_.begin(), heap_.end());
  const Entry entry = heap_.back();
  heap_.pop_back();
  return entry;
}

bool VoxelSearch::refine(Entry& entry) {
  if (isHopeless(boundOfPlane(entry))) return true;
  while (has_oriented_ && entry.by != Bound::TRIANGLES) {
    entry.by = static_cast<Bound>(static_cast<int>(entry.by) + 1);
    if (!isWorth(entry.by, entry)) continue;
    const double finer = entry.by == Bound::BOXES   ? boundOfOrientedBoxes(entry)
                         : entry.by == Bound::HULLS ? boundOfHulls(entry)
                                                    : boundOfTriangles(entry);
    if (!(finer > entry.bound)) continue;
    entry.bound = finer;
    if (!isHopeless(finer)) push(entry);
    return true;
  }
  return false;
}

// A cube larger than the element mostly contains it.
bool VoxelSearch::isWorth(Bound by, const Entry& entry) const {
  if (by == Bound::BOXES) return true;
  if (entry.level < 0 && !has_triangles_ && limit_ <= 0.0) return false;
  const Aabb box = boxOf(entry);
  const bool is_small = entry.level <= 0 || (box.max - box.min).norm() <= 2.0 * size_;
  return is_small && (by == Bound::HULLS || has_triangles_);
}

void VoxelSearch::expand(const Entry& entry) {
  const auto level = static_cast<std::size_t>(entry.level);
  const OccupiedVoxels::Cube& cube = voxels_->levels()[level][entry.index];
  std::uint64_t left = cube.occupied & OccupiedVoxels::childrenIn(cells_, level, entry.corner);
  for (; left != 0; left &= left - 1) {
    const int bit = __builtin_ctzll(left);
    Entry child = entry;
    child.corner += OccupiedVoxels::childEdge(level) * OccupiedVoxels::childOffset(bit);
    child.level = static_cast<std::int8_t>(entry.level - 1);
    child.index = level > 0 ? OccupiedVoxels::childOf(cube, bit) : 0;
    child.by = Bound::ALIGNED_BOXES;
    child.bound = std::max(entry.bound, boundOfAlignedBoxes(child));
    if (!isHopeless(child.bound)) push(child);
  }
}

Aabb VoxelSearch::boxOf(const Entry& entry) const {
  if (entry.level < 0) return voxels_->boxOf(entry.corner, Vector3i::Ones());
  const auto level = static_cast<std::size_t>(entry.level);
  return voxels_->boxOfCube(level, entry.index, entry.corner);
}

double VoxelSearch::boundOfAlignedBoxes(const Entry& entry) const {
  const Aabb box = boxOf(entry);
  return signedGap((box.min - box_.max).cwiseMax(box_.min - box.max));
}

double VoxelSearch::boundOfPlane(const Entry& entry) const {
  if (reach_along_ == INF) return -INF;  // none yet
  const Aabb box = boxOf(entry);
  const double half = 0.5 * nhat_W_.cwiseAbs().dot(box.max - box.min);
  return nhat_W_.dot(box.center()) - half - reach_along_ - padding_;
}

double VoxelSearch::boundOfOrientedBoxes(const Entry& entry) const {
  const Aabb box = boxOf(entry);
  const Vector3d half = 0.5 * (box.max - box.min);
  const Vector3d p_A = oriented_.R.transpose() * (box.center() - oriented_.center);
  const Vector3d reach = oriented_.half + oriented_.R.transpose().cwiseAbs() * half;
  return signedGap(p_A.cwiseAbs() - reach) - padding_;
}

double VoxelSearch::boundOfHulls(const Entry& entry) {
  const Aabb box = boxOf(entry);
  const double gap =
      ladder_->hullsApart(of_link_, rung_, coreOf(box), poseOf(box), reach(), nhat_E_);
  return gap > 0.0 ? gap - padding_ : -INF;
}

double VoxelSearch::boundOfTriangles(const Entry& entry) {
  const Aabb box = boxOf(entry);
  const double gap = ladder_->surfaceApart(of_link_, coreOf(box), poseOf(box), reach(), normals_);
  if (!(gap > 0.0) || !isOutside(entry, box)) return -INF;
  outside_.push_back(box);
  return gap - padding_;
}

// For a box that does not intersect the triangles. It is entirely inside or entirely outside, and
// so are boxes that touch it and do not intersect them either. So the expensive query is rarely
// needed.
bool VoxelSearch::isOutside(const Entry& entry, const Aabb& box) const {
  if (entry.bound + padding_ > 0.0) return true;  // the hull, or that of its parent, is apart
  const auto touchesBox = [&](const Aabb& other) {
    return (box.min.array() <= other.max.array() && other.min.array() <= box.max.array()).all();
  };
  return std::any_of(outside_.begin(), outside_.end(), touchesBox) ||
         !ladder_->holds(of_link_, box.center());
}

void VoxelSearch::placeVoxel(const VoxelCell& cell) {
  Isometry3d& X_WV = (*X_WE_)[of_cloud_];
  X_WV = scene_->poseOfVoxel(of_cloud_, cell);
  (*boxes_)[of_cloud_] = scene_->elements()[of_cloud_].boxAt(X_WV);
}

// A voxel that is apart must not hide a contact.
double VoxelSearch::slackOf(double bound) const { return bound > 0.0 || best_ <= 0.0 ? SAME : 0.0; }

void VoxelSearch::keepBest(const PairLadder::Answer& answer, const VoxelCell& cell) {
  const PairDistance& found = answer.found;
  if (found.certainty == Certainty::BEYOND) return;
  const bool is_certain = found.certainty != Certainty::DEGRADED;
  if (found.distance < nearest_.answer.found.distance) {
    nearest_ = {answer, cell};
    if (has_oriented_ && found.distance > 0.0) {
      nhat_W_ = (pair_.first == of_link_ ? 1.0 : -1.0) * found.nhat_AB_A.normalized();
      const Aabb voxel = voxels_->boxOf(cell, Vector3i::Ones());
      reach_along_ = ladder_->reachAlong(nhat_W_, of_link_, rung_, coreOf(voxel));
    }
  }
  if (is_certain && found.touches() && found.distance < contact_.answer.found.distance) {
    contact_ = {answer, cell};
  }
  // If contact of the nearest is not certain, others may still be in contact.
  const bool is_sought = nearest_.answer.found.touches() && !contact_.answer.found.touches();
  best_ = is_sought ? INF : nearest_.answer.found.distance;
  if (is_sought) limit_ = std::min(limit_, 0.0);
}

VoxelSearch::Found VoxelSearch::result() const {
  const PairDistance& nearest = nearest_.answer.found;
  const bool is_uncertain = nearest.certainty == Certainty::DEGRADED;
  return is_uncertain && contact_.answer.found.touches() ? contactWithin(nearest.distance)
                                                         : nearest_;
}

VoxelSearch::Found VoxelSearch::contactWithin(double lower) const {
  Found contact = contact_;
  PairDistance& found = contact.answer.found;
  if (lower < found.distance) {
    found.distance = lower;
    found.certainty = Certainty::BOUND;
  }
  return contact;
}

VoxelSearch::Found VoxelSearch::unfinished(const Entry& entry) {
  const double lower = std::min(entry.bound, nearest_.answer.found.distance);
  if (contact_.answer.found.touches()) return contactWithin(lower);
  Entry first = entry;
  while (first.level >= 0) {
    const auto level = static_cast<std::size_t>(first.level);
    const OccupiedVoxels::Cube& cube = voxels_->levels()[level][first.index];
    first.corner += OccupiedVoxels::childEdge(level) *
                    OccupiedVoxels::childOffset(__builtin_ctzll(cube.occupied));
    first.index = cube.first_child;
    --first.level;
  }
  placeVoxel(first.corner);
  (*boxes_)[of_cloud_] = grown(boxOf(entry), scene_->elements()[of_cloud_].box_padding);
  PairLadder::Answer answer = ladder_->boundOfAlignedBoxes(pair_, INF);
  answer.found.distance = lower;
  return {answer, first.corner};
}

VoxelSearch::Found VoxelSearch::boundOfBoxes(const BoxPair& pair, const OccupiedVoxels& voxels,
                                             double max_distance) {
  start(pair, voxels, Fidelity::AABB, max_distance);
  while (!heap_.empty()) {
    const Entry entry = pop();
    if (isHopeless(entry.bound)) break;
    if (entry.level < 0) return unfinished(entry);
    expand(entry);
  }
  return result();
}

VoxelSearch::Found VoxelSearch::touches(const BoxPair& pair, const OccupiedVoxels& voxels,
                                        Fidelity top, const Deadline& deadline) {
  start(pair, voxels, ladder_->rungOf(pair, top), 0.0);
  while (!heap_.empty()) {
    Entry entry = pop();
    if (refine(entry)) continue;
    if (deadline.spent()) return unfinished(entry);
    if (entry.level >= 0) {
      expand(entry);
      continue;
    }
    placeVoxel(entry.corner);
    const PairLadder::Answer answer = ladder_->touches(pair, top);
    if (answer.found.certainty == Certainty::BEYOND) continue;
    nearest_ = {answer, entry.corner};
    if (answer.found.certainty == Certainty::BOUND) return nearest_;
  }
  return nearest_;
}

void VoxelSearch::measureVoxel(const VoxelCell& cell, Fidelity top, double max_distance) {
  placeVoxel(cell);
  // Rungs larger than the element use the better of two bounds, so their search distance must not
  // depend on what else is near.
  const double reach = has_oriented_ ? std::max(std::min(limit_, best_), 0.0) : max_distance;
  keepBest(ladder_->climb(pair_, top, reach), cell);
}

// Once any distance is known, nothing further needs finer bounds.
void VoxelSearch::measureOneOf(const Entry& cube, Fidelity top, double max_distance) {
  Entry nearest = cube;
  double least = INF;
  for (std::uint64_t left = voxels_->levels()[0][cube.index].occupied; left != 0;
       left &= left - 1) {
    Entry voxel = cube;
    voxel.corner += OccupiedVoxels::childOffset(__builtin_ctzll(left));
    voxel.level = -1;
    const double bound = boundOfOrientedBoxes(voxel);
    if (bound >= least) continue;
    least = bound;
    nearest = voxel;
  }
  measureVoxel(nearest.corner, top, max_distance);
}

VoxelSearch::Found VoxelSearch::nearest(const BoxPair& pair, const OccupiedVoxels& voxels,
                                        Fidelity top, double max_distance,
                                        const Deadline& deadline) {
  const Fidelity rung = ladder_->rungOf(pair, top);
  start(pair, voxels, rung, max_distance);
  while (!heap_.empty()) {
    Entry entry = pop();
    if (isHopeless(entry.bound)) break;
    if (refine(entry)) {
      const bool is_first =
          has_triangles_ && best_ == INF && entry.level == 0 && entry.by >= Bound::HULLS;
      if (is_first && !isHopeless(entry.bound)) measureOneOf(entry, top, max_distance);
      continue;
    }
    if (deadline.spent()) return unfinished(entry);
    if (entry.level >= 0) {
      expand(entry);
      continue;
    }
    measureVoxel(entry.corner, top, max_distance);
  }
  return result();
}

}  // namespace collision_pairs
