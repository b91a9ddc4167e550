#include "collision_pairs/shape.h"

#include <cmath>
#include <stdexcept>

namespace collision_pairs {
namespace {

void requireSize(double value, const char* shape, const char* what) {
  if (!(std::isfinite(value) && value >= 0.0)) {
    throw std::invalid_argument(std::string(shape) + ": " + what + " is " + std::to_string(value) +
                                ", but must be a finite number of metres, 0 or more");
  }
}

std::string named(const char* kind, const TriangleMesh& mesh) {
  return mesh.name.empty() ? std::string(kind) : std::string(kind) + " '" + mesh.name + "'";
}

void requireVertices(const char* kind, const TriangleMesh* mesh) {
  if (mesh == nullptr) throw std::invalid_argument(std::string(kind) + " has no data");
  if (mesh->vertices.empty()) throw std::invalid_argument(named(kind, *mesh) + " has no vertex");
  for (std::size_t i = 0; i < mesh->vertices.size(); ++i) {
    if (!mesh->vertices[i].allFinite()) {
      throw std::invalid_argument(named(kind, *mesh) + ": vertex " + std::to_string(i) +
                                  " is not finite");
    }
  }
}

struct Validator {
  void operator()(const Box& box) const {
    for (int i = 0; i < 3; ++i) requireSize(box.size[i], "box", "a size");
  }
  void operator()(const Sphere& sphere) const {
    requireSize(sphere.radius, "sphere", "the radius");
  }
  void operator()(const Cylinder& cylinder) const {
    requireSize(cylinder.radius, "cylinder", "the radius");
    requireSize(cylinder.length, "cylinder", "the length");
  }
  void operator()(const Capsule& capsule) const {
    requireSize(capsule.radius, "capsule", "the radius");
    requireSize(capsule.length, "capsule", "the length");
  }
  void operator()(const HalfSpace&) const {}
  void operator()(const Convex& convex) const { requireVertices("convex", convex.mesh.get()); }
  void operator()(const Mesh& mesh) const {
    requireVertices("mesh", mesh.mesh.get());
    if (mesh.mesh->triangles.empty()) {
      throw std::invalid_argument(named("mesh", *mesh.mesh) + " has no triangle");
    }
    for (std::size_t i = 0; i < mesh.mesh->triangles.size(); ++i) {
      for (const std::uint32_t vertex : mesh.mesh->triangles[i]) {
        if (vertex >= mesh.mesh->vertices.size()) {
          throw std::invalid_argument(
              named("mesh", *mesh.mesh) + ": triangle " + std::to_string(i) + " refers to vertex " +
              std::to_string(vertex) + " of " + std::to_string(mesh.mesh->vertices.size()));
        }
      }
    }
  }
};

}  // namespace

void validateShape(const Shape& shape) { std::visit(Validator{}, shape); }

}  // namespace collision_pairs
