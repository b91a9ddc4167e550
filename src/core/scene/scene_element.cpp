#include "scene_element.h"

#include <limits>

#include "covered_solid.h"
#include "in_parallel.h"
#include "mesh_bounds.h"
#include "sphere_cover.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double ROUNDING = 64.0 * std::numeric_limits<double>::epsilon();

/// The hull of an element, which encloses it if enlarged by `margin`.
struct Hull {
  Shape shape;
  double margin = 0.0;
  bool simplified = false;
};

Hull simplifiedHull(const std::vector<Vector3d>& corners, double margin, int max_vertices) {
  const std::size_t most =
      max_vertices == 0 ? corners.size() : static_cast<std::size_t>(max_vertices);
  FewerPoints fewer = atMostPoints(corners, most);
  auto kept = std::make_shared<TriangleMesh>();
  kept->vertices = std::move(fewer.points);
  return {Convex{kept}, margin + fewer.margin, corners.size() > most};
}

void setBox(const Vector3d& lower, const Vector3d& upper, double margin, SceneElement& element) {
  element.box_center = 0.5 * (lower + upper);
  element.box_half = 0.5 * (upper - lower);
  const double rounding = ROUNDING * (element.box_center.cwiseAbs() + element.box_half).sum();
  element.box_half.array() += margin + rounding;
}

/// Sets the boxes, which all rungs need.
Hull boundMesh(const Mesh& mesh, int max_hull_vertices, SceneElement& element) {
  const auto corners = hullVertices(*mesh.mesh);
  const double margin = hullMargin(*mesh.mesh);
  element.mesh_bounds = std::make_shared<MeshBounds>(corners->vertices, margin);
  const Aabb box = boxAround(corners->vertices);
  setBox(box.min, box.max, margin, element);
  return simplifiedHull(corners->vertices, margin, max_hull_vertices);
}

bool isOfTriangles(const Shape& shape) {
  return std::holds_alternative<Mesh>(shape) || std::holds_alternative<Convex>(shape);
}

Hull boundPrimitive(const Shape& shape, SceneElement& element) {
  const Aabb box = computeAabb(shape, Isometry3d::Identity());
  setBox(box.min, box.max, 0.0, element);
  if (std::holds_alternative<HalfSpace>(shape)) {
    element.box_center.setZero();
    element.box_half.setConstant(std::numeric_limits<double>::infinity());
  }
  return {shape};
}

}  // namespace

SceneElement makeElement(const Shape& shape, Fidelity needed, int max_hull_vertices,
                         NarrowPhaseMethod method, std::shared_ptr<const FineSpheres> spheres) {
  validateShape(shape);
  const Isometry3d identity = Isometry3d::Identity();
  SceneElement made;
  made.shape = shape;
  if (isOfTriangles(shape)) {
    made.spheres = spheres ? std::move(spheres) : std::make_shared<const FineSpheres>(shape);
  }
  const auto* mesh = std::get_if<Mesh>(&shape);
  const Hull hull = mesh ? boundMesh(*mesh, max_hull_vertices, made) : boundPrimitive(shape, made);
  Rung exact, convex, obb;
  const bool is_asked = needed == Fidelity::MESH || needed == Fidelity::SPHERES;
  if (is_asked || !mesh) exact = {prepareShape(shape, method), identity};
  if (needed >= Fidelity::CONVEX) {
    convex = mesh ? Rung{prepareShape(hull.shape, method), identity, hull.margin, hull.simplified}
                  : exact;
  }
  if (std::holds_alternative<HalfSpace>(shape)) {
    obb = exact;
  } else if (needed >= Fidelity::OBB) {
    const auto [box, X_EO] = enclosingBox(hull.shape);
    // The pose of its own frame is rounded once more than that of the element.
    const double rounding = ROUNDING * (box.size.sum() + X_EO.translation().lpNorm<1>());
    obb = {prepareShape(box, method), X_EO, hull.margin + rounding, true};
  }
  made.rungs = std::make_shared<const std::array<Rung, 5>>(
      std::array<Rung, 5>{Rung{}, Rung{}, obb, convex, exact});
  return made;
}

void makeSpheres(const std::vector<SceneElement>& elements) {
  inParallel(nbThreads(0, elements.size()), elements.size(), [&](std::size_t, std::size_t i) {
    if (elements[i].spheres) elements[i].spheres->get();
  });
}

Aabb SceneElement::boxAt(const Isometry3d& X_WE) const {
  Aabb box = mesh_bounds ? mesh_bounds->boxAt(X_WE) : computeAabb(shape, X_WE);
  if (box_padding > 0.0) {
    box.min.array() -= box_padding * (1.0 + ROUNDING);
    box.max.array() += box_padding * (1.0 + ROUNDING);
  }
  return box;
}

}  // namespace collision_pairs
