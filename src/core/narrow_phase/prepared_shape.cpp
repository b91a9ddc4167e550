#include "prepared_shape.h"

#include <algorithm>

#include "collision_pairs/input_error.h"
#include "mesh_solid.h"

namespace collision_pairs {
namespace {

using Eigen::Vector3d;

// Relative volume by which a convex mesh may be smaller than its hull.
constexpr double CONVEX_VOLUME_TOLERANCE = 1e-9;

ConvexCore solidCore(ConvexCore::Kind kind, const Vector3d& half, double radius) {
  ConvexCore core;
  core.kind = kind;
  core.half = half;
  core.radius = radius;
  core.extent = half.norm();
  if (kind == ConvexCore::Kind::CYLINDER) core.extent = std::hypot(half[0], half[2]);
  return core;
}

ConvexCore hullCore(const ConvexHull& hull) {
  ConvexCore core;
  core.kind = ConvexCore::Kind::POINTS;
  core.points = hull.points.vertices.data();
  core.nb_points = static_cast<int>(hull.points.vertices.size());
  core.edges = &hull.points;
  if (!hull.points.blocks.empty()) core.blocks = hull.points.blocks.data();
  Vector3d low = core.points[0], high = low;
  for (const Vector3d& p : hull.points.vertices) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  core.center = 0.5 * (low + high);
  core.half = 0.5 * (high - low);
  for (const Vector3d& p : hull.points.vertices) {
    core.extent = std::max(core.extent, (p - core.center).norm());
  }
  return core;
}

std::unique_ptr<PreparedMesh> prepareMesh(const Mesh& shape, double hull_volume,
                                          double& missing_share) {
  MeshSolid solid = findSolid(*shape.mesh);
  missing_share = solid.missing_share;
  if (solid.locally_convex && solid.volume > 0.0 &&
      std::abs(solid.volume - hull_volume) <= CONVEX_VOLUME_TOLERANCE * hull_volume) {
    return nullptr;
  }
  auto mesh = std::make_unique<PreparedMesh>();
  mesh->triangles = shape.mesh;
  mesh->tree = TriangleTree(*shape.mesh);
  mesh->solid = WindingNumber(shape.mesh->vertices, std::move(solid.outward));
  mesh->part_points = std::move(solid.part_points);
  return mesh;
}

// The vertices used by triangles, each once.
std::vector<Vector3d> cornersOf(const TriangleMesh& mesh) {
  std::vector<char> used(mesh.vertices.size(), 0);
  for (const auto& t : mesh.triangles) used[t[0]] = used[t[1]] = used[t[2]] = 1;
  std::vector<Vector3d> corners;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i]) corners.push_back(mesh.vertices[i]);
  }
  return corners;
}

struct MakeCore {
  using Kind = ConvexCore::Kind;
  ConvexCore operator()(const Box& box) const { return solidCore(Kind::BOX, box.size / 2.0, 0.0); }
  ConvexCore operator()(const Sphere& sphere) const {
    return solidCore(Kind::POINT, Vector3d::Zero(), sphere.radius);
  }
  ConvexCore operator()(const Cylinder& c) const {
    return solidCore(Kind::CYLINDER, {c.radius, c.radius, c.length / 2.0}, 0.0);
  }
  ConvexCore operator()(const Capsule& c) const {
    return solidCore(Kind::SEGMENT, {0.0, 0.0, c.length / 2.0}, c.radius);
  }
  ConvexCore operator()(const HalfSpace&) const { return {}; }
  ConvexCore operator()(const Convex& convex) const {
    hull = convexHull(convex.mesh->vertices);
    return hullCore(hull);
  }
  ConvexCore operator()(const Mesh& shape) const {
    hull = convexHull(cornersOf(*shape.mesh));
    mesh = prepareMesh(shape, hull.volume, missing_share);
    return hullCore(hull);
  }
  ConvexHull& hull;
  std::unique_ptr<const PreparedMesh>& mesh;
  double& missing_share;
};

}  // namespace

Prepared::Prepared(const Shape& the_shape, NarrowPhaseMethod the_method)
    : PreparedShape(the_shape), method(the_method) {
  core = std::visit(MakeCore{hull, mesh, missing_share_}, the_shape);
  box = boxAround(core);
  if (method == NarrowPhaseMethod::FCL) fcl = makeFclShape(the_shape, hull, mesh == nullptr);
}

std::shared_ptr<const PreparedShape> prepareShape(const Shape& shape, NarrowPhaseMethod method) {
  validateShape(shape);
  return std::make_shared<Prepared>(shape, method);
}

const char* narrowPhaseName(NarrowPhaseMethod method) {
  return method == NarrowPhaseMethod::FCL ? "fcl" : "native";
}

NarrowPhaseMethod parseNarrowPhase(const std::string& name) {
  for (const auto method : {NarrowPhaseMethod::NATIVE, NarrowPhaseMethod::FCL}) {
    if (name == narrowPhaseName(method)) return method;
  }
  throw InputError("unknown narrow phase '" + name + "'; known are native and fcl");
}

}  // namespace collision_pairs
