#include "voxel_search.h"

#include <algorithm>
#include <cmath>

#include "infinity.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::Vector3i;

Aabb grown(const Aabb& box, double metres) {
  const Vector3d all = Vector3d::Constant(metres);
  return {box.min - all, box.max + all};
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
  const Aabb& all = voxels.bounds();
  rounding_ = ROUNDING * (all.min.cwiseAbs().cwiseMax(all.max.cwiseAbs()).maxCoeff() + padding);
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
  // At rungs that are larger than the element's box, the box is no bound.
  const Rung& shape = element.rung(rung);
  has_oriented_ = rung >= Fidelity::CONVEX && !shape.loose && std::isfinite(element.box_half[0]);
  if (has_oriented_) {
    const Isometry3d& X_WE = (*X_WE_)[of_link_];
    oriented_ = {X_WE.linear(), X_WE * element.box_center, element.box_half};
    padding_ += ROUNDING * oriented_.center.lpNorm<1>();
  }
  has_triangles_ = has_oriented_ && ladder_->needsTriangles(pair, rung);
  limit_ = max_distance;
  best_ = INF;
  nearest_ = contact_ = {};
  nearest_.answer.found.certainty = contact_.answer.found.certainty = Certainty::BEYOND;
  nhat_E_.setZero();
  planes_.clear();
  has_candidates_ = false;
  candidate_.bound = INF;
  heap_.clear();
  outside_.clear();
  cells_ = voxels.cellsWithin(box_, std::min(max_distance, 1e100));
  Entry root{0.0, voxels.rootCorner(), 0, {}, static_cast<std::int8_t>(voxels.levels().size() - 1)};
  if (has_triangles_) {
    root.nodes = surface_.begin(*shape.shape, (*X_WE_)[of_link_]);
    surface_error_ = errorOfSurface();
  }
  root.bound = boundOfBoxes(boxOf(root));
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
  if (!has_oriented_) return false;
  const Aabb box = boxOf(entry);
  const double before = entry.bound;
  entry.bound = std::max(before, boundOfPlanes(box));
  if (entry.bound > before) {
    if (!isPruned(entry.bound)) push(entry);
    return true;
  }
  if (!entry.is_fine && isWorthMore(entry, box)) {
    entry.is_fine = true;
    // A plane may be all that is needed.
    const bool wants_plane = planes_.empty() && entry.level == 0 && entry.bound + padding_ > 0.0;
    double gap = wants_plane || !has_triangles_ ? gapOfHulls(box) : -INF;
    if (has_triangles_ && !isPruned(gap - padding_)) {
      gap = std::max(gap, gapOfTriangles(entry, box));
    }
    entry.bound = std::max(entry.bound, gap - padding_);
  }
  if (!(entry.bound > before)) return false;
  if (!isPruned(entry.bound)) push(entry);
  return true;
}

void VoxelSearch::pushChildren(const Entry& entry) {
  const auto level = static_cast<std::size_t>(entry.level);
  const OccupiedVoxels::Cube& cube = voxels_->levels()[level][entry.index];
  std::uint64_t left = cube.occupied & OccupiedVoxels::childrenIn(cells_, level, entry.corner);
  for (; left != 0; left &= left - 1) {
    const int bit = __builtin_ctzll(left);
    Entry child = entry;
    child.corner += OccupiedVoxels::childEdge(level) * OccupiedVoxels::childOffset(bit);
    child.level = static_cast<std::int8_t>(entry.level - 1);
    child.index = OccupiedVoxels::childOf(cube, bit);
    child.is_fine = false;
    const Aabb box = boxOf(child);
    child.bound = std::max(entry.bound, boundOfBoxes(box));
    if (isPruned(child.bound)) continue;
    child.bound = std::max(child.bound, boundOfPlanes(box));
    if (!isPruned(child.bound)) push(child);
  }
}

void VoxelSearch::expand(const Entry& cube) {
  if (cube.level > 0) return pushChildren(cube);
  findVoxels(cube);
  if (has_triangles_) return takeVoxels(cube.nodes);
  for (const Entry& voxel : near_) push(voxel);
}

// Once any distance is known, nothing further needs finer bounds.
void VoxelSearch::takeNearestOf(const Entry& cube) {
  findVoxels(cube);
  const auto is_nearer = [](const Entry& a, const Entry& b) { return a.bound < b.bound; };
  const auto nearest = std::min_element(near_.begin(), near_.end(), is_nearer);
  if (nearest != near_.end()) takeVoxel(*nearest, 0.0);
}

// In the order of their gaps, as the nearest often leaves no other.
void VoxelSearch::takeVoxels(const SurfaceQuery::Nodes& nodes) {
  if (near_.size() == 1) return takeVoxel(near_[0], 0.0);
  std::array<Aabb, BOX_LANES> boxes;
  std::array<SurfaceQuery::Nodes, BOX_LANES> of_boxes;
  by_gap_.clear();
  for (std::size_t i = 0; i < near_.size(); i += BOX_LANES) {
    const std::size_t count = std::min<std::size_t>(BOX_LANES, near_.size() - i);
    for (std::size_t lane = 0; lane < count; ++lane) boxes[lane] = boxOf(near_[i + lane]);
    const FourGaps gaps = surface_.keepNear(boxes, count, searched(), nodes, of_boxes);
    for (std::size_t lane = 0; lane < count; ++lane) {
      near_[i + lane].nodes = of_boxes[lane];
      by_gap_.emplace_back(gaps.of[lane], i + lane);
    }
  }
  std::sort(by_gap_.begin(), by_gap_.end());
  for (const auto& [gap, i] : by_gap_) {
    Entry& voxel = near_[i];
    voxel.bound = std::max(voxel.bound, boundOfPlanes(boxOf(voxel)));  // some are new
    if (!isPruned(voxel.bound)) takeVoxel(voxel, gap);
  }
}

// A voxel that is inside, or too near for its distance to be known well enough, is left to the
// ladder.
void VoxelSearch::takeVoxel(Entry voxel, double known) {
  voxel.is_fine = true;
  const Aabb box = boxOf(voxel);
  DistanceBounds gap{known};
  if (known <= searched()) gap = surface_.distance(box, searched(), 0.2 * SAME, voxel.nodes);
  const double lower = gap.lower - surface_error_;
  if (lower > 0.0 && isOutside(voxel, box)) {
    outside_.push_back(box);
    voxel.bound = std::max(voxel.bound, lower - padding_);
    if (isPruned(voxel.bound)) return;
    const double upper = gap.upper + surface_error_ - scene_->padding(pair_.first, pair_.second);
    if (has_candidates_ && upper - voxel.bound <= 0.5 * SAME) {
      candidate_ = voxel;
      best_ = upper;
      cells_ = voxels_->cellsWithin(box_, std::max(std::min(limit_, best_), 0.0));
      addPlane(-gap.nhat, box);
      return;
    }
  }
  push(voxel);
}

void VoxelSearch::placeVoxel(const VoxelCell& cell) {
  Isometry3d& X_WV = (*X_WE_)[of_cloud_];
  X_WV = scene_->poseOfVoxel(of_cloud_, cell);
  (*boxes_)[of_cloud_] = scene_->elements()[of_cloud_].boxAt(X_WV);
}

void VoxelSearch::keepBest(const PairLadder::Answer& answer, const VoxelCell& cell) {
  const PairDistance& found = answer.found;
  if (found.certainty == Certainty::BEYOND) return;
  const bool is_certain = found.certainty != Certainty::DEGRADED;
  if (found.distance < nearest_.answer.found.distance) {
    nearest_ = {answer, cell};
    if (has_oriented_ && found.distance > 0.0) {
      const double side = pair_.first == of_link_ ? 1.0 : -1.0;
      addPlane(side * found.nhat_AB_A.normalized(), voxels_->boxOf(cell, Vector3i::Ones()));
    }
  }
  if (is_certain && found.touches() && found.distance < contact_.answer.found.distance) {
    contact_ = {answer, cell};
  }
  // If contact of the nearest is not certain, others may still be in contact.
  const bool is_sought = nearest_.answer.found.touches() && !contact_.answer.found.touches();
  best_ = is_sought ? INF : std::min(best_, nearest_.answer.found.distance);
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
    if (isPruned(entry.bound)) break;
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
  keepBest(ladder_->refine(pair_, top, reach), cell);
}

VoxelSearch::Found VoxelSearch::nearest(const BoxPair& pair, const OccupiedVoxels& voxels,
                                        Fidelity top, double max_distance,
                                        const Deadline& deadline) {
  const Fidelity rung = ladder_->rungOf(pair, top);
  for (const bool settles : {true, false}) {
    bool is_first = settles;
    start(pair, voxels, rung, max_distance);
    has_candidates_ = settles;
    while (!heap_.empty()) {
      Entry entry = pop();
      if (isPruned(entry.bound)) break;
      if (is_first && has_triangles_ && entry.level == 0) {
        is_first = false;
        takeNearestOf(entry);
      }
      if (refine(entry)) continue;
      if (deadline.spent()) return unfinished(entry);
      if (entry.level >= 0) {
        expand(entry);
        continue;
      }
      measureVoxel(entry.corner, top, max_distance);
    }
    if (!(candidate_.bound < nearest_.answer.found.distance)) break;
    if (deadline.spent()) return unfinished(candidate_);
    best_ += SAME;
    measureVoxel(candidate_.corner, top, max_distance);
    const Certainty certainty = nearest_.answer.found.certainty;
    if (nearest_.voxel == candidate_.corner && certainty == Certainty::EXACT) break;
  }
  return result();
}

}  // namespace collision_pairs
