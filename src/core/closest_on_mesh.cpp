#include "closest_on_mesh.h"

#include <limits>

#include "mesh_query.h"

namespace collision_pairs {
namespace {

using Eigen::Vector3d;

class Search {
 public:
  Search(const PreparedMesh& mesh, const Vector3d& point, double limit)
      : mesh_(mesh), point_(point), squared_(limit * limit) {}

  // The tree is balanced to one in eight, so the recursion is about 5 log2(n) deep at most.
  void visit(std::uint32_t index) {
    const TriangleTree::Node& node = mesh_.tree.node(index);
    if (node.leaf) {
      take(closestOnTriangle(triangleOf(*mesh_.triangles, node.child), point_));
      return;
    }
    const double first = squaredGap(node.child), second = squaredGap(node.child + 1);
    const std::uint32_t nearer = node.child + (second < first ? 1 : 0);
    const std::uint32_t further = node.child + (second < first ? 0 : 1);
    if (std::min(first, second) < squared_) visit(nearer);
    if (std::max(first, second) < squared_) visit(further);
  }

  const Vector3d& found() const { return found_; }
  bool any() const { return any_; }

 private:
  double squaredGap(std::uint32_t index) const {
    const OrientedBox& box = mesh_.tree.node(index).box;
    const Vector3d local = box.R.transpose() * (point_ - box.center);
    return (local.cwiseAbs() - box.half).cwiseMax(0.0).squaredNorm();
  }

  void take(const Vector3d& candidate) {
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

Vector3d closestOnMesh(const PreparedMesh& mesh, const Vector3d& point) {
  Search search(mesh, point, std::numeric_limits<double>::infinity());
  search.visit(0);
  return search.found();
}

bool isOnMesh(const PreparedMesh& mesh, std::uint32_t root, const Vector3d& point,
              double tolerance) {
  Search search(mesh, point, tolerance);
  search.visit(root);
  return search.any();
}

}  // namespace collision_pairs
