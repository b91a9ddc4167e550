#include "surface_query.h"

#include <algorithm>
#include <cmath>

#include "infinity.h"
#include "solids.h"

namespace collision_pairs {
namespace {

using Eigen::Vector3d;

}  // namespace

SurfaceQuery::Nodes SurfaceQuery::begin(const PreparedShape& mesh, const Eigen::Isometry3d& X_WM) {
  shape_ = &mesh;
  nearest_ = NONE;
  mesh_ = static_cast<const Prepared&>(mesh).mesh.get();
  X_WM_ = X_WM;
  nodes_.assign(1, {0, 0.0});
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
    const auto [node, gap] = nodes_[i];
    least = std::min(least, gap > reach ? gap : keepNear(query, node));
  }
  near.end = static_cast<std::uint32_t>(nodes_.size());
  return least;
}

double SurfaceQuery::keepNear(const Query& query, std::uint32_t index) {
  const TriangleTree::Node& node = mesh_->tree.node(index);
  if (node.isLeaf()) {
    const double gap = std::sqrt(squaredBoxGap(mesh_->tree.box(index), query.box));
    if (gap <= query.reach) nodes_.push_back({index, gap});
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
      nodes_.push_back({child, gap});
    } else {
      gap = std::max(gap, keepNear(query, child));
      are_all_small = false;
    }
    least = std::min(least, gap);
  }
  if (are_all_small && nodes_.size() > size_before + 1) {  // four cost a search as much as one
    nodes_.resize(size_before);
    nodes_.push_back({index, least});
  }
  return least;
}

FourGaps SurfaceQuery::keepNear(const std::array<Aabb, BOX_LANES>& boxes, std::size_t count,
                                double reach, const Nodes& larger,
                                std::array<Nodes, BOX_LANES>& near) {
  const Query query = queryFor(boxes[0], reach);
  BoxBlock block;
  for (std::size_t lane = 0; lane < BOX_LANES; ++lane) {
    OrientedBox box = query.box;
    if (lane < count) box.center += box.R * (boxes[lane].min - boxes[0].min);
    setLane(box, static_cast<int>(lane), block);
  }
  double skipped = INF;
  tried_.clear();
  for (std::uint32_t i = larger.begin; i < larger.end; ++i) {
    const auto [node, gap] = nodes_[i];
    if (gap > reach) {
      skipped = std::min(skipped, gap);
    } else {
      tried_.emplace_back(node, squaredBoxGaps(block, mesh_->tree.box(node)));
    }
  }
  FourGaps least;
  for (std::size_t lane = 0; lane < count; ++lane) {
    const auto begin = static_cast<std::uint32_t>(nodes_.size());
    least.of[lane] = INF;
    for (const auto& [node, gaps] : tried_) {
      const double squared = gaps.of[lane];
      least.of[lane] = std::min(least.of[lane], squared);
      if (squared <= reach * reach) nodes_.push_back({node, std::sqrt(squared)});
    }
    least.of[lane] = std::min(std::sqrt(least.of[lane]), skipped);
    near[lane] = {begin, static_cast<std::uint32_t>(nodes_.size())};
    std::sort(nodes_.begin() + begin, nodes_.end(), [](const NearNode& a, const NearNode& b) {
      return a.gap != b.gap ? a.gap < b.gap : a.node < b.node;
    });
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
  tried_first_ = nearest_;
  for (std::uint32_t i = nodes.begin; i < nodes.end; ++i) {
    const double limit = std::min(query.reach, best.upper - query.tolerance);
    if (nodes_[i].gap > limit) {
      best.lower = std::min(best.lower, nodes_[i].gap);
    } else {
      improve(query, nodes_[i].node, best);
    }
  }
  return best;
}

void SurfaceQuery::improve(const Query& query, std::uint32_t index, DistanceBounds& best) {
  const TriangleTree::Node& node = mesh_->tree.node(index);
  if (node.isLeaf()) {
    if (node.children == tried_first_) return;
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
