#include "scene_element.h"

#include <limits>
#include <mutex>

#include "enclosing_box.h"
#include "in_parallel.h"
#include "mesh_bounds.h"
#include "sphere_cover.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double ROUNDING = 64.0 * std::numeric_limits<double>::epsilon();
constexpr std::uint64_t KEPT_ROUNDS = 16;  // a mesh that this many scenes did not use is dropped

/// The hull of an element, which encloses it if enlarged by `margin`.
struct Hull {
  Shape shape;
  double margin = 0.0;
  bool simplified = false;
};

Hull simplifiedHull(const std::vector<Vector3d>& corners, double margin, int max_vertices) {
  if (max_vertices == 0 || corners.size() <= static_cast<std::size_t>(max_vertices)) {
    auto all = std::make_shared<TriangleMesh>();
    all->vertices = corners;
    return {Convex{all}, margin, false};
  }
  FewerPoints fewer = atMostPoints(corners, static_cast<std::size_t>(max_vertices));
  auto kept = std::make_shared<TriangleMesh>();
  kept->vertices = std::move(fewer.points);
  return {Convex{kept}, margin + fewer.margin, true};
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
  Vector3d lower = corners->vertices.front(), upper = lower;
  for (const Vector3d& p : corners->vertices) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  setBox(lower, upper, margin, element);
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
    obb = {prepareShape(box, method), X_EO, hull.margin, true};
  }
  made.rungs = {Rung{}, Rung{}, obb, convex, exact};
  return made;
}

void makeSpheres(const std::vector<SceneElement>& elements) {
  inParallel(nbThreads(0, elements.size()), elements.size(), [&](std::size_t, std::size_t i) {
    if (elements[i].spheres) elements[i].spheres->get();
  });
}

void ElementMaker::prepare(const std::vector<std::pair<const Shape*, Fidelity>>& wanted,
                           const SceneSettings& settings) {
  ++round_;
  max_hull_vertices_ = settings.max_hull_vertices;
  method_ = settings.narrow_phase;
  std::vector<std::tuple<const Shape*, Fidelity, SceneElement*>> open;
  for (const auto& [shape, needed] : wanted) {
    const auto* mesh = std::get_if<Mesh>(shape);
    if (mesh == nullptr) continue;
    const auto [slot, is_new] =
        of_meshes_.try_emplace(Key(mesh->mesh.get(), needed, max_hull_vertices_, method_));
    slot->second.last_round = round_;
    if (!is_new) continue;
    slot->second.element.spheres = spheresOf(*shape);
    open.emplace_back(shape, needed, &slot->second.element);
  }
  std::mutex telling;
  std::size_t done = 0;
  try {
    inParallel(nbThreads(0, open.size()), open.size(), [&](std::size_t, std::size_t i) {
      const auto& [shape, needed, element] = open[i];
      *element = makeElement(*shape, needed, max_hull_vertices_, method_, element->spheres);
      if (!settings.progress) return;
      const std::lock_guard<std::mutex> lock(telling);
      settings.progress(++done, open.size());
    });
  } catch (...) {
    of_meshes_.clear();  // some are not made
    throw;
  }
  for (auto i = of_meshes_.begin(); i != of_meshes_.end();) {
    i = i->second.last_round + KEPT_ROUNDS < round_ ? of_meshes_.erase(i) : std::next(i);
  }
}

std::shared_ptr<const FineSpheres> ElementMaker::spheresOf(const Shape& shape) const {
  const TriangleMesh* mesh = std::get<Mesh>(shape).mesh.get();
  auto i = of_meshes_.lower_bound(Key(mesh, Fidelity::AABB, 0, NarrowPhaseMethod::NATIVE));
  for (; i != of_meshes_.end() && std::get<0>(i->first) == mesh; ++i) {
    if (i->second.element.spheres) return i->second.element.spheres;
  }
  return std::make_shared<const FineSpheres>(shape);
}

SceneElement ElementMaker::make(const Shape& shape, Fidelity needed) const {
  if (const auto* mesh = std::get_if<Mesh>(&shape)) {
    const auto found = of_meshes_.find(Key(mesh->mesh.get(), needed, max_hull_vertices_, method_));
    if (found != of_meshes_.end()) return found->second.element;
  }
  return makeElement(shape, needed, max_hull_vertices_, method_);
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
