#include "surface_query.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solids.h"

namespace collision_pairs {
namespace {

using Eigen::Vector3d;

constexpr double INF = std::numeric_limits<double>::infinity();

}  // namespace

SurfaceQuery::Nodes SurfaceQuery::begin(const PreparedShape& mesh, const Eigen::Isometry3d& X_WM) {
  shape_ = &mesh;
  nearest_ = NONE;
  mesh_ = static_cast<const Prepared&>(mesh).mesh.get();
  X_WM_ = X_WM;
  nodes_.assign(1, 0);
  return {0, 1};
}

SurfaceQuery::Query SurfaceQuery::queryFor(const Aabb& box, double reach) const {
  Query query;
  query.p_BM = X_WM_.translation() - box.center();
  query.box.R = X_WM_.linear().transpose();
  query.box.center = -(query.box.R * query.p_BM);
  query.box.half = 0.5 * (box.max - box.min);
  query.reach = reach;
  return query;
}

double SurfaceQuery::keepNear(const Aabb& box, double reach, const Nodes& larger, Nodes& near) {
  const Query query = queryFor(box, reach);
  near.begin = static_cast<std::uint32_t>(nodes_.size());
  double least = INF;
  for (std::uint32_t i = larger.begin; i < larger.end; ++i) {
    least = std::min(least, keepNear(query, nodes_[i]));
  }
  near.end = static_cast<std::uint32_t>(nodes_.size());
  return least;
}

double SurfaceQuery::keepNear(const Query& query, std::uint32_t index) {
  const TriangleTree::Node& node = mesh_->tree.node(index);
  if (node.isLeaf()) {
    const double gap = std::sqrt(squaredBoxGap(mesh_->tree.box(index), query.box));
    if (gap <= query.reach) nodes_.push_back(index);
    return gap;
  }
  const FourGaps gaps = squaredBoxGaps(mesh_->tree.childBoxes(node), query.box);
  const std::size_t size_before = nodes_.size();
  double least = INF;
  bool are_all_small = true;
  for (std::uint32_t i = 0; i < node.nb_children; ++i) {
    const std::uint32_t child = node.children + i;
    const TriangleTree::Node& below = mesh_->tree.node(child);
    double gap = std::sqrt(gaps.of[i]);
    if (gap > query.reach) {
    } else if (below.isLeaf() || below.size <= query.box.size()) {
      nodes_.push_back(child);
    } else {
      gap = std::max(gap, keepNear(query, child));
      are_all_small = false;
    }
    least = std::min(least, gap);
  }
  if (are_all_small && nodes_.size() > size_before + 1) {  // four cost a search as much as one
    nodes_.resize(size_before);
    nodes_.push_back(index);
  }
  return least;
}

DistanceBounds SurfaceQuery::distance(const Aabb& box, double reach, double tolerance,
                                      const Nodes& nodes) {
  Query query = queryFor(box, reach);
  query.tolerance = tolerance;
  DistanceBounds best{INF};
  if (nearest_ != NONE) {
    best = distanceOfTriangle(query, nearest_, reach);
    if (best.lower > reach) best.upper = INF;
  }
  for (std::uint32_t i = nodes.begin; i < nodes.end; ++i) improve(query, nodes_[i], best);
  return best;
}

void SurfaceQuery::improve(const Query& query, std::uint32_t index, DistanceBounds& best) {
  const TriangleTree::Node& node = mesh_->tree.node(index);
  if (node.isLeaf()) {
    const double limit = std::min(query.reach, best.upper - query.tolerance);
    const DistanceBounds found = distanceOfTriangle(query, node.children, limit);
    best.lower = std::min(best.lower, found.lower);
    if (found.upper >= best.upper) return;
    best.upper = found.upper;
    best.nhat = found.nhat;
    nearest_ = node.children;
    return;
  }
  FourGaps gaps = squaredBoxGaps(mesh_->tree.childBoxes(node), query.box);
  for (int visited = 0; visited < node.nb_children; ++visited) {  // the nearest first
    const auto nearest = std::min_element(gaps.of, gaps.of + node.nb_children);
    const double gap = *nearest, limit = std::min(query.reach, best.upper - query.tolerance);
    if (gap > limit * limit) {
      best.lower = std::min(best.lower, std::sqrt(gap));
      return;
    }
    *nearest = INF;
    improve(query, node.children + static_cast<std::uint32_t>(nearest - gaps.of), best);
  }
}

DistanceBounds SurfaceQuery::distanceOfTriangle(const Query& query, std::uint32_t triangle,
                                                double limit) const {
  Corners corners = cornersOf(*mesh_->triangles, triangle);
  for (Vector3d& corner : corners) corner = X_WM_.linear() * corner + query.p_BM;
  return distanceFromBox(corners, query.box.half, limit);
}

bool SurfaceQuery::holds(const Vector3d& p_W) const {
  return meshHoldsPoint(static_cast<const Prepared&>(*shape_),
                        X_WM_.linear().transpose() * (p_W - X_WM_.translation()));
}

}  // namespace collision_pairs
