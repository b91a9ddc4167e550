#include "moveit_shapes.h"

#include <octomap/OcTree.h>

#include "collision_pairs/input_error.h"
#include "cone.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;

std::vector<OctreeLeaf> leavesOf(const shapes::Shape& shape) {
  const auto& octree = static_cast<const shapes::OcTree&>(shape).octree;
  return octree ? occupiedLeaves(*octree) : std::vector<OctreeLeaf>();
}

void appendLeaves(const shapes::Shape& shape, const Isometry3d& X_ME,
                  std::vector<Element>& elements) {
  for (const OctreeLeaf& leaf : leavesOf(shape)) {
    const Shape box = Box{Eigen::Vector3d::Constant(leaf.size)};
    elements.push_back({box, X_ME * Eigen::Translation3d(leaf.x, leaf.y, leaf.z)});
  }
}

}  // namespace

std::vector<OctreeLeaf> occupiedLeaves(const octomap::OcTree& tree) {
  std::vector<OctreeLeaf> leaves;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    if (!tree.isNodeOccupied(*leaf)) continue;
    leaves.push_back({leaf.getX(), leaf.getY(), leaf.getZ(), leaf.getSize()});
  }
  return leaves;
}

LeavesOfOctrees leavesOfOctrees(const std::vector<shapes::ShapeConstPtr>& parts) {
  LeavesOfOctrees leaves;
  for (const auto& part : parts) {
    if (part->type == shapes::OCTREE) leaves.push_back(leavesOf(*part));
  }
  return leaves;
}

void MoveitShapes::append(const shapes::ShapeConstPtr& shape, double scale, const Isometry3d& X_ME,
                          std::vector<Element>& elements) {
  const auto add = [&](Shape made) { elements.push_back({std::move(made), X_ME}); };
  switch (shape->type) {
    case shapes::SPHERE:
      return add(Sphere{scale * static_cast<const shapes::Sphere&>(*shape).radius});
    case shapes::CYLINDER: {
      const auto& cylinder = static_cast<const shapes::Cylinder&>(*shape);
      return add(Cylinder{scale * cylinder.radius, scale * cylinder.length});
    }
    case shapes::CONE: {
      const auto& cone = static_cast<const shapes::Cone&>(*shape);
      return add(pyramidAroundCone(scale * cone.radius, scale * cone.length));
    }
    case shapes::BOX: {
      const auto& size = static_cast<const shapes::Box&>(*shape).size;
      return add(Box{scale * Eigen::Vector3d(size[0], size[1], size[2])});
    }
    case shapes::MESH:
      return add(Mesh{trianglesOf(shape, scale)});
    case shapes::OCTREE:
      return appendLeaves(*shape, X_ME, elements);
    default:
      throw InputError("a shape of type " + std::to_string(shape->type) +
                       (shape->type == shapes::PLANE ? " (a plane)" : "") +
                       " cannot be checked; use a box, sphere, cylinder, cone, mesh or octree");
  }
}

std::shared_ptr<const TriangleMesh> MoveitShapes::trianglesOf(const shapes::ShapeConstPtr& shape,
                                                              double scale) {
  const std::lock_guard<std::mutex> lock(mutex_);
  auto& known = meshes_[{shape, scale}];
  if (known) return known;
  auto scaled = std::unique_ptr<shapes::Mesh>(static_cast<const shapes::Mesh&>(*shape).clone());
  if (scale != 1.0) scaled->scaleAndPadd(scale, 0.0);  // about its centroid, as MoveIt does
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->name = "of MoveIt";
  for (unsigned i = 0; i < scaled->vertex_count; ++i) {
    const double* v = scaled->vertices + 3 * i;
    mesh->vertices.emplace_back(v[0], v[1], v[2]);
  }
  for (unsigned i = 0; i < scaled->triangle_count; ++i) {
    const unsigned* t = scaled->triangles + 3 * i;
    mesh->triangles.push_back({t[0], t[1], t[2]});
  }
  known = mesh;
  if (meshes_.size() > nb_swept_) {
    for (auto it = meshes_.begin(); it != meshes_.end();) {
      it = it->first.shape.expired() ? meshes_.erase(it) : std::next(it);
    }
    nb_swept_ = 2 * meshes_.size() + 64;
  }
  return mesh;
}

}  // namespace collision_pairs
