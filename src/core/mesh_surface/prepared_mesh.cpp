#include "prepared_mesh.h"

#include <algorithm>
#include <limits>

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

class Search {
 public:
  Search(const PreparedMesh& mesh, const Vector3d& point, double limit)
      : mesh_(mesh), point_(point), squared_(limit * limit) {}

  // Each side of a split has at least an eighth of the triangles, so the recursion is at most about
  // 3 log2(n) deep.
  void visit(std::uint32_t index) {
    const TriangleTree::Node& node = mesh_.tree.node(index);
    if (node.isLeaf()) {
      keepNearer(closestOnTriangle(triangleOf(*mesh_.triangles, node.children), point_));
      return;
    }
    FourGaps gaps = squaredPointGaps(mesh_.tree.childBoxes(node), point_);
    for (int visited = 0; visited < node.nb_children; ++visited) {  // the nearest first
      const auto nearest = std::min_element(gaps.of, gaps.of + node.nb_children);
      if (!(*nearest < squared_)) return;
      *nearest = std::numeric_limits<double>::infinity();
      visit(node.children + static_cast<std::uint32_t>(nearest - gaps.of));
    }
  }

  const Vector3d& found() const { return found_; }
  bool any() const { return any_; }

 private:
  void keepNearer(const Vector3d& candidate) {
    const double squared = (candidate - point_).squaredNorm();
    if (squared >= squared_) return;
    squared_ = squared;
    found_ = candidate;
    any_ = true;
  }

  const PreparedMesh& mesh_;
  const Vector3d& point_;
  double squared_;
  Vector3d found_ = Vector3d::Zero();
  bool any_ = false;
};

}  // namespace

Corners cornersOf(const TriangleMesh& mesh, std::uint32_t index) {
  const auto& t = mesh.triangles[index];
  return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
}

Corners moved(const Corners& corners, const Isometry3d& X) {
  return {X * corners[0], X * corners[1], X * corners[2]};
}

Triangle triangleOf(const TriangleMesh& mesh, std::uint32_t index) {
  return Triangle(cornersOf(mesh, index));
}

ConvexCore cornersCore(const Corners& corners) {
  ConvexCore core;
  core.kind = ConvexCore::Kind::POINTS;
  core.points = corners.data();
  core.nb_points = 3;
  core.center = (corners[0] + corners[1] + corners[2]) / 3.0;
  for (const Vector3d& v : corners) core.extent = std::max(core.extent, (v - core.center).norm());
  return core;
}

Vector3d closestOnMesh(const PreparedMesh& mesh, const Vector3d& point) {
  Search search(mesh, point, std::numeric_limits<double>::infinity());
  search.visit(0);
  return search.found();
}

std::optional<Vector3d> closestOnPart(const PreparedMesh& mesh, std::uint32_t root,
                                      const Vector3d& point, double within) {
  Search search(mesh, point, within);
  search.visit(root);
  return search.any() ? std::optional(search.found()) : std::nullopt;
}

}  // namespace collision_pairs
