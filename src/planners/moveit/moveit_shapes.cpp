#include "moveit_shapes.h"

#include <algorithm>

#include <octomap/OcTree.h>

#include "collision_pairs/input_error.h"
#include "cone.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;

/// Null: none was given.
const octomap::OcTree* treeOf(const shapes::Shape& shape) {
  return static_cast<const shapes::OcTree&>(shape).octree.get();
}

void appendLeaves(const shapes::Shape& shape, const Isometry3d& X_ME,
                  std::vector<Element>& elements) {
  const octomap::OcTree* tree = treeOf(shape);
  if (tree) appendBoxes(tree->getResolution(), occupiedLeaves(*tree), X_ME, elements);
}

bool isSame(const shapes::Sphere& a, const shapes::Sphere& b) { return a.radius == b.radius; }
bool isSame(const shapes::Cylinder& a, const shapes::Cylinder& b) {
  return a.radius == b.radius && a.length == b.length;
}
bool isSame(const shapes::Cone& a, const shapes::Cone& b) {
  return a.radius == b.radius && a.length == b.length;
}
bool isSame(const shapes::Box& a, const shapes::Box& b) {
  return std::equal(a.size, a.size + 3, b.size);
}
bool isSame(const shapes::Mesh& a, const shapes::Mesh& b) {
  return a.vertex_count == b.vertex_count && a.triangle_count == b.triangle_count &&
         std::equal(a.vertices, a.vertices + 3 * a.vertex_count, b.vertices) &&
         std::equal(a.triangles, a.triangles + 3 * a.triangle_count, b.triangles);
}
bool isSame(const shapes::OcTree& a, const shapes::OcTree& b) { return a.octree == b.octree; }

template <class Type>
bool areSame(const shapes::Shape& a, const shapes::Shape& b) {
  return isSame(static_cast<const Type&>(a), static_cast<const Type&>(b));
}

}  // namespace

bool areAlike(const shapes::ShapeConstPtr& a, const shapes::ShapeConstPtr& b) {
  if (a == b) return true;
  if (a->type != b->type) return false;
  switch (a->type) {
    case shapes::SPHERE:
      return areSame<shapes::Sphere>(*a, *b);
    case shapes::CYLINDER:
      return areSame<shapes::Cylinder>(*a, *b);
    case shapes::CONE:
      return areSame<shapes::Cone>(*a, *b);
    case shapes::BOX:
      return areSame<shapes::Box>(*a, *b);
    case shapes::MESH:
      return areSame<shapes::Mesh>(*a, *b);
    case shapes::OCTREE:
      return areSame<shapes::OcTree>(*a, *b);
    default:
      return false;
  }
}

std::vector<std::pair<double, std::vector<OctreeLeaf>>> leavesOf(
    const std::vector<shapes::ShapeConstPtr>& parts) {
  std::vector<std::pair<double, std::vector<OctreeLeaf>>> all;
  for (const auto& part : parts) {
    if (part->type != shapes::OCTREE) continue;
    all.emplace_back();
    if (const auto* tree = treeOf(*part))
      all.back() = {tree->getResolution(), occupiedLeaves(*tree)};
  }
  return all;
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
