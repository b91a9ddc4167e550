// How near to the element may the voxels in a box be?
#include <algorithm>
#include <cmath>
#include <limits>

#include "convex_core.h"
#include "infinity.h"
#include "voxel_search.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::Vector3i;

/// A lower bound of the signed distance of two boxes with the same axes, and of what they enclose:
/// their gap, or minus the smallest translation along an axis that separates them.
double signedGap(const Vector3d& between) {
  const double widest = between.maxCoeff();
  return widest > 0.0 ? between.cwiseMax(0.0).norm() : widest;
}

/// A box as a convex shape around its centre, and its pose; enlarged by rounding.
ConvexCore coreOf(const Aabb& box) {
  constexpr double ROUNDING = 64.0 * std::numeric_limits<double>::epsilon();
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

}  // namespace

// The bounds are those of boundOfBoxes() and boundOfPlanes(), of the four voxels along x at a time:
// all are of one size, so that few numbers differ.
void VoxelSearch::findVoxels(const Entry& cube) {
  using Lanes = Eigen::Array4d;
  const double size = voxels_->voxelSize();
  const Vector3d half = Vector3d::Constant(0.5 * size);
  const Vector3d corner = size * cube.corner.cast<double>();
  const Lanes along_x(0.0, size, 2.0 * size, 3.0 * size);
  const auto signedGaps = [](const Lanes& x, const Lanes& y, const Lanes& z) -> Lanes {
    const Lanes widest = x.max(y).max(z);
    const Lanes squared = x.max(0.0).square() + y.max(0.0).square() + z.max(0.0).square();
    return (widest > 0.0).select(squared.sqrt(), widest);
  };
  const Vector3d p_A = oriented_.R.transpose() * (corner + half - oriented_.center);
  const Vector3d reach_A = oriented_.half + oriented_.R.cwiseAbs().transpose() * half;
  const std::uint64_t occupied = voxels_->levels()[0][cube.index].occupied &
                                 OccupiedVoxels::childrenIn(cells_, 0, cube.corner);
  near_.clear();
  for (int row = 0; row < 16; ++row) {
    unsigned left = occupied >> (4 * row) & 15;
    if (left == 0) continue;
    const Vector3d moved(0.0, size * (row & 3), size * (row >> 2));
    const Vector3d low = corner + moved, high = low + 2.0 * half;
    const Vector3d apart = (low - box_.max).cwiseMax(box_.min - high);
    const Lanes apart_x = (along_x + (low[0] - box_.max[0])).max((box_.min[0] - high[0]) - along_x);
    Lanes bounds = signedGaps(apart_x, Lanes::Constant(apart[1]), Lanes::Constant(apart[2]));
    if (has_oriented_) {
      const Vector3d q = p_A + oriented_.R.transpose() * moved;
      const auto excess = [&](int i) -> Lanes {
        return (q[i] + oriented_.R(0, i) * along_x).abs() - reach_A[i];
      };
      bounds = bounds.max(signedGaps(excess(0), excess(1), excess(2)) - padding_);
      const Vector3d center = low + half;
      for (const Plane& plane : planes_) {
        const double beyond = plane.reach + plane.nhat.cwiseAbs().dot(half) + padding_;
        bounds = bounds.max(plane.nhat[0] * along_x + (plane.nhat.dot(center) - beyond));
      }
    }
    for (; left != 0; left &= left - 1) {
      const int x = __builtin_ctz(left);
      const double bound = std::max(cube.bound, bounds[x]);
      if (isPruned(bound)) continue;
      const VoxelCell cell = cube.corner + VoxelCell(x, row & 3, row >> 2);
      if (candidate_.bound < INF && cell == candidate_.corner) continue;  // known already
      near_.push_back({bound, cell, 0, cube.nodes, -1});
    }
  }
}

Aabb VoxelSearch::boxOf(const Entry& entry) const {
  if (entry.level < 0) return voxels_->boxOf(entry.corner, Vector3i::Ones());
  const auto level = static_cast<std::size_t>(entry.level);
  return voxels_->boxOfCube(level, entry.index, entry.corner);
}

double VoxelSearch::boundOfBoxes(const Aabb& box) const {
  const double aligned = signedGap((box.min - box_.max).cwiseMax(box_.min - box.max));
  if (!has_oriented_ || isPruned(aligned)) return aligned;
  const Vector3d half = 0.5 * (box.max - box.min);
  const Vector3d p_A = oriented_.R.transpose() * (box.center() - oriented_.center);
  const Vector3d reach = oriented_.half + oriented_.R.transpose().cwiseAbs() * half;
  return std::max(aligned, signedGap(p_A.cwiseAbs() - reach) - padding_);
}

double VoxelSearch::boundOfPlanes(const Aabb& box) const {
  double furthest = -INF;
  const Vector3d center = box.center(), half = 0.5 * (box.max - box.min);
  for (const Plane& plane : planes_) {
    const double gap = plane.nhat.dot(center) - plane.nhat.cwiseAbs().dot(half) - plane.reach;
    furthest = std::max(furthest, gap);
  }
  return furthest - padding_;
}

void VoxelSearch::addPlane(const Vector3d& nhat_W, const Aabb& box) {
  constexpr std::size_t MOST = 8;
  if (planes_.size() == MOST) planes_.erase(planes_.begin());
  planes_.push_back({nhat_W, ladder_->reachAlong(nhat_W, of_link_, rung_, coreOf(box))});
}

double VoxelSearch::gapOfHulls(const Aabb& box) {
  const double gap =
      ladder_->hullsApart(of_link_, rung_, coreOf(box), poseOf(box), reach(), nhat_E_);
  if (!(gap > 0.0)) return -INF;
  addPlane((*X_WE_)[of_link_].linear() * nhat_E_, box);
  return gap;
}

double VoxelSearch::gapOfTriangles(Entry& entry, const Aabb& box) {
  const SurfaceQuery::Nodes larger = entry.nodes;
  const double gap = surface_.keepNear(box, searched(), larger, entry.nodes) - surface_error_;
  if (!(gap > 0.0) || !isOutside(entry, box)) return -INF;
  outside_.push_back(box);
  return gap;
}

// For a box that does not intersect the triangles. It is entirely inside or entirely outside, and
// so are boxes that touch it and do not intersect them either. So the expensive query is rarely
// needed.
bool VoxelSearch::isOutside(const Entry& entry, const Aabb& box) const {
  if (entry.bound + padding_ > 0.0) return true;  // the hull, or that of its parent, is apart
  const auto touchesBox = [&](const Aabb& other) {
    return (box.min.array() <= other.max.array() && other.min.array() <= box.max.array()).all();
  };
  return std::any_of(outside_.begin(), outside_.end(), touchesBox) || !surface_.holds(box.center());
}

double VoxelSearch::errorOfSurface() const {
  const Aabb& all = voxels_->bounds();
  return ladder_->errorOfSurface(of_link_, coreOf(all), poseOf(all));
}

}  // namespace collision_pairs
