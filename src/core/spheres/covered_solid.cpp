#include "covered_solid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "mesh_solid.h"
#include "solids.h"

namespace collision_pairs {
namespace {

using Eigen::Vector3d;

constexpr double NEARLY = 1e-9;  // of the size: points this far outside count as inside

struct Plane {
  Vector3d normal;
  double height;
};

std::vector<Plane> outerPlanes(const ConvexHull& hull) {
  Vector3d middle = Vector3d::Zero();
  for (const Vector3d& p : hull.points.vertices) middle += p;
  middle /= static_cast<double>(hull.points.vertices.size());
  std::vector<Plane> planes;
  for (const auto& face : hull.faces) {
    const Vector3d& p = hull.points.vertices[face[0]];
    const Vector3d normal =
        (hull.points.vertices[face[1]] - p).cross(hull.points.vertices[face[2]] - p).normalized();
    if (!(normal.squaredNorm() > 0.5)) continue;  // a face without area
    const double sign = normal.dot(p - middle) < 0.0 ? -1.0 : 1.0;
    planes.push_back({sign * normal, sign * normal.dot(p)});
  }
  return planes;
}

double depthBelow(const std::vector<Plane>& planes, const Vector3d& p) {
  double depth = std::numeric_limits<double>::infinity();
  for (const Plane& plane : planes) depth = std::min(depth, plane.height - plane.normal.dot(p));
  return depth;
}

/// True if each edge is used equally often in both directions. The winding number of every point is
/// then an integer.
bool isClosed(const TriangleMesh& mesh, const std::vector<std::array<std::uint32_t, 3>>& outward) {
  using Point = std::array<double, 3>;
  std::map<std::pair<Point, Point>, int> sides;
  const auto at = [&](std::uint32_t i) {
    const Vector3d& v = mesh.vertices[i];
    return Point{v[0] + 0.0, v[1] + 0.0, v[2] + 0.0};
  };
  for (const auto& t : outward) {
    for (int k = 0; k < 3; ++k) {
      const Point a = at(t[k]), b = at(t[(k + 1) % 3]);
      a < b ? ++sides[{a, b}] : --sides[{b, a}];
    }
  }
  return std::all_of(sides.begin(), sides.end(), [](const auto& s) { return s.second == 0; });
}

}  // namespace

Aabb boxAround(const std::vector<Vector3d>& points) {
  Aabb box = noBox();
  for (const Vector3d& p : points) box = enclosing(box, {p, p});
  return box;
}

std::vector<Vector3d> cornersOf(const std::vector<Polygon>& polygons) {
  std::vector<Vector3d> corners;
  for (const Polygon& polygon : polygons) {
    corners.insert(corners.end(), polygon.begin(), polygon.end());
  }
  return corners;
}

CoveredSolid hullSolid(const ConvexHull& hull, double size) {
  CoveredSolid solid;
  for (const auto& face : hull.faces) {
    const auto& v = hull.points.vertices;
    solid.surface.push_back({v[face[0]], v[face[1]], v[face[2]]});
  }
  const auto planes = outerPlanes(hull);
  solid.may_hold = [planes, size](const Vector3d& p) {
    return depthBelow(planes, p) > -NEARLY * size;
  };
  solid.depth = [planes](const Vector3d& p) { return depthBelow(planes, p); };
  return solid;
}

CoveredSolid cylinderSolid(const Cylinder& cylinder, const ConvexHull& prism, double size) {
  CoveredSolid solid = hullSolid(prism, size);
  solid.depth = [cylinder](const Vector3d& p) {
    return std::min(cylinder.radius - p.head<2>().norm(), 0.5 * cylinder.length - std::abs(p[2]));
  };
  return solid;
}

CoveredSolid meshSolid(const Prepared& shape, double size) {
  const TriangleMesh& mesh = *shape.mesh->triangles;
  const auto outward = findSolid(mesh).outward;
  const bool closed = isClosed(mesh, outward);
  // The inside of a surface that is not quite closed is not bounded by triangles alone, but it lies
  // within the hull.
  CoveredSolid solid = closed ? CoveredSolid() : hullSolid(shape.hull, size);
  solid.is_exact = closed;
  for (const auto& t : mesh.triangles) {
    solid.surface.push_back({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]});
  }
  const auto toSurface = [&shape](const Vector3d& p) {
    return (closestOnMesh(*shape.mesh, p) - p).norm();
  };
  if (!closed) return solid;
  solid.may_hold = [&shape, toSurface, size](const Vector3d& p) {
    return toSurface(p) < NEARLY * size || meshHoldsPoint(shape, p);
  };
  solid.depth = toSurface;
  solid.holds = [&shape](const Vector3d& p) { return meshHoldsPoint(shape, p); };
  return solid;
}

}  // namespace collision_pairs
