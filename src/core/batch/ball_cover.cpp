#include "ball_cover.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "collision_pairs/aabb.h"
#include "mesh_solid.h"
#include "solids.h"

namespace collision_pairs {
namespace {

using Eigen::Vector3d;

constexpr int MOST_DEPTH = 6;          // of the tree: 64 leaves
constexpr double LEAF_RADIUS = 0.025;  // m: about what leaves of smaller trees have
constexpr int CAPSULE_DEPTH = 2;       // 4 leaves along the segment
constexpr int PRISM_SIDES = 24;        // sticks out of a cylinder by 0.9 % of its radius
constexpr int GRID = 14;               // samples along each side of the box, for inner balls
constexpr int MOST_INNER = 12;         // balls
constexpr double WORTHWHILE = 0.08;    // of the largest inner ball: what the next one has to add
constexpr double NEARLY = 1e-9;        // of the size: what may be rounding counts as inside

using Polygon = std::vector<Vector3d>;

/// A solid, as the cover sees it.
struct Solid {
  /// Each extreme point of what is in a box is on these, or is a corner of the box.
  std::vector<Polygon> surface;
  /// Is the point inside, or nearly so?
  std::function<bool(const Vector3d&)> may_hold;
  /// A ball of this radius around a point that is inside is so, too; 0 or less where a point is
  /// not, unless `holds` is there to tell. Empty: it has no inner balls.
  std::function<double(const Vector3d&)> depth;
  std::function<bool(const Vector3d&)> holds;
};

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

/// What is on one side of a plane across an axis; sign 1: above `at`, -1: below. Sutherland,
/// Hodgman: "Reentrant polygon clipping" (1974).
Polygon clipped(const Polygon& polygon, int axis, double at, double sign) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector3d &p = polygon[i], &next = polygon[(i + 1) % polygon.size()];
    const double above = sign * (p[axis] - at), next_above = sign * (next[axis] - at);
    if (above >= 0.0) kept.push_back(p);
    if ((above < 0.0) == (next_above < 0.0) || above == 0.0 || next_above == 0.0) continue;
    kept.push_back(p + above / (above - next_above) * (next - p));
    kept.back()[axis] = at;
  }
  return kept;
}

/// Fills in a tree of outer balls.
class OuterTree {
 public:
  explicit OuterTree(const Solid& solid) : solid_(solid) {}

  std::vector<Ball> build() {
    std::vector<Vector3d> corners = cornersOf(solid_.surface);
    const Aabb box = boxAround(corners);
    const Ball whole = enclosingBall(corners);
    const double levels = 2.0 * std::log2(std::max(whole.radius, LEAF_RADIUS) / LEAF_RADIUS);
    depth_ = static_cast<int>(std::min(std::ceil(levels), 1.0 * MOST_DEPTH));
    balls_.resize((2u << depth_) - 1);
    build(0, 0, solid_.surface, box, whole);
    return std::move(balls_);
  }

 private:
  void build(std::size_t node, int depth, const std::vector<Polygon>& surface, const Aabb& cell,
             const Ball& of_parent) {
    std::vector<Vector3d> extremes = cornersOf(surface);
    for (int i = 0; i < 8; ++i) {
      const Vector3d corner((i & 1 ? cell.max : cell.min)[0], (i & 2 ? cell.max : cell.min)[1],
                            (i & 4 ? cell.max : cell.min)[2]);
      if (solid_.may_hold(corner)) extremes.push_back(corner);
    }
    balls_[node] = extremes.empty() ? of_parent : enclosingBall(extremes);
    if (depth == depth_) return;
    const Aabb box = extremes.empty() ? cell : boxAround(extremes);
    int axis = 0;
    (box.max - box.min).maxCoeff(&axis);
    const double middle = box.center()[axis];
    for (const bool upper : {false, true}) {
      std::vector<Polygon> part;
      for (const Polygon& polygon : surface) {
        Polygon kept = clipped(polygon, axis, middle, upper ? 1.0 : -1.0);
        if (!kept.empty()) part.push_back(std::move(kept));
      }
      Aabb half = box;
      (upper ? half.min : half.max)[axis] = middle;
      build(2 * node + (upper ? 2 : 1), depth + 1, part, half, balls_[node]);
    }
  }

  const Solid& solid_;
  int depth_ = 0;
  std::vector<Ball> balls_;
};

/// Of samples with their distances from the surface those that are inside. A ball that does not
/// reach the surface is inside as its centre is: so few centres need be asked, the largest first.
std::vector<Ball> insideOf(const Solid& solid, std::vector<Ball> samples) {
  std::sort(samples.begin(), samples.end(),
            [](const Ball& a, const Ball& b) { return a.radius > b.radius; });
  enum { UNKNOWN, INSIDE, OUTSIDE };
  std::vector<int> where(samples.size(), UNKNOWN);
  std::vector<Ball> inside;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (where[i] == UNKNOWN) {
      const int here = solid.holds(samples[i].center) ? INSIDE : OUTSIDE;
      for (std::size_t j = i; j < samples.size(); ++j) {
        const double apart = (samples[j].center - samples[i].center).norm();
        if (j == i || apart < (1.0 - NEARLY) * samples[i].radius) where[j] = here;
      }
    }
    if (where[i] == INSIDE) inside.push_back(samples[i]);
  }
  return inside;
}

/// One after the other the ball that reaches furthest out of those before it, of samples on a grid.
std::vector<Ball> innerBalls(const Solid& solid) {
  const Aabb box = boxAround(cornersOf(solid.surface));
  std::vector<Ball> samples, chosen;
  for (int i = 0; i < GRID * GRID * GRID; ++i) {
    const Eigen::Array3d at = Eigen::Array3d(i % GRID, i / GRID % GRID, i / GRID / GRID) + 0.5;
    const Vector3d p = box.min.array() + at / GRID * (box.max - box.min).array();
    const double radius = solid.depth(p);
    if (radius > 0.0) samples.push_back({p, radius});
  }
  if (solid.holds) samples = insideOf(solid, std::move(samples));
  std::vector<double> outside(samples.size(), 0.0);  // of the chosen ones: of its centre
  while (!samples.empty() && chosen.size() < MOST_INNER) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < samples.size(); ++i) {
      const auto adds = [&](std::size_t s) { return samples[s].radius + outside[s]; };
      if (adds(i) > adds(best)) best = i;
    }
    const Ball ball = samples[best];
    if (!chosen.empty() && ball.radius + outside[best] < WORTHWHILE * chosen[0].radius) break;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double gap = (samples[i].center - ball.center).norm() - ball.radius;
      outside[i] = chosen.empty() ? gap : std::min(outside[i], gap);
    }
    chosen.push_back(ball);
  }
  std::sort(chosen.begin(), chosen.end(),
            [](const Ball& a, const Ball& b) { return a.radius > b.radius; });
  return chosen;
}

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

/// All that is below the hull's planes. With the hull's own triangles in `surface`.
Solid hullSolid(const ConvexHull& hull, double size) {
  Solid solid;
  for (const auto& face : hull.faces) {
    const auto& v = hull.points.vertices;
    solid.surface.push_back({v[face[0]], v[face[1]], v[face[2]]});
  }
  const auto planes = outerPlanes(hull);
  solid.may_hold = [planes, size](const Vector3d& p) {
    return depthBelow(planes, p) > -NEARLY * size;
  };
  solid.depth = [planes](const Vector3d& p) { return std::max(0.0, depthBelow(planes, p)); };
  return solid;
}

/// Does each edge have as many sides one way as the other? Then the surface winds a whole number
/// of times around every point.
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

Solid meshSolid(const Prepared& shape, double size) {
  const TriangleMesh& mesh = *shape.mesh->triangles;
  const auto outward = findSolid(mesh).outward;
  const bool closed = isClosed(mesh, outward);
  // What is held by a surface that is not quite closed is not bounded by triangles alone; but it
  // is within the hull.
  Solid solid = closed ? Solid() : hullSolid(shape.hull, size);
  for (const auto& t : mesh.triangles) {
    solid.surface.push_back({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]});
  }
  const auto toSurface = [&shape](const Vector3d& p) {
    return (closestOnMesh(*shape.mesh, p) - p).norm();
  };
  solid.depth = {};
  if (!closed) return solid;
  solid.may_hold = [&shape, toSurface, size](const Vector3d& p) {
    return toSurface(p) < NEARLY * size || meshHoldsPoint(shape, p);
  };
  solid.depth = toSurface;
  solid.holds = [&shape](const Vector3d& p) { return meshHoldsPoint(shape, p); };
  return solid;
}

BallCover coverOf(const Solid& solid) {
  return {OuterTree(solid).build(), solid.depth ? innerBalls(solid) : std::vector<Ball>()};
}

BallCover coverOfPoints(const std::vector<Vector3d>& points) {
  return {{enclosingBall(points)}, {}};
}

BallCover coverOfConvex(const ConvexHull& hull, double size) {
  return hull.faces.empty() ? coverOfPoints(hull.points.vertices) : coverOf(hullSolid(hull, size));
}

/// Of the part of the axis from `begin` to `end`.
void coverSegment(std::size_t node, double begin, double end, double radius, BallCover& cover) {
  if (node >= cover.outer.size()) return;
  const double middle = 0.5 * (begin + end);
  cover.outer[node] = {{0.0, 0.0, middle}, radius + 0.5 * (end - begin)};
  coverSegment(2 * node + 1, begin, middle, radius, cover);
  coverSegment(2 * node + 2, middle, end, radius, cover);
}

struct MakeCover {
  BallCover operator()(const Sphere& sphere) const {
    return {{{Vector3d::Zero(), sphere.radius}}, {{Vector3d::Zero(), sphere.radius}}};
  }
  BallCover operator()(const Capsule& capsule) const {
    BallCover cover;
    cover.outer.resize((2u << CAPSULE_DEPTH) - 1);
    const double half = 0.5 * capsule.length;
    coverSegment(0, -half, half, capsule.radius, cover);
    constexpr int NB_INNER = 1 << CAPSULE_DEPTH;
    for (int i = 0; i <= NB_INNER; ++i) {
      cover.inner.push_back({{0.0, 0.0, half * (2.0 * i / NB_INNER - 1.0)}, capsule.radius});
    }
    return cover;
  }
  BallCover operator()(const Box& box) const {
    std::vector<Vector3d> corners;
    for (int i = 0; i < 8; ++i) {
      const Eigen::Array3d sign(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
      corners.push_back(0.5 * sign * box.size.array());
    }
    return coverOfConvex(convexHull(corners), size());
  }
  BallCover operator()(const Cylinder& cylinder) const {
    std::vector<Vector3d> corners;
    const double outside = cylinder.radius / std::cos(M_PI / PRISM_SIDES);
    const double half = 0.5 * cylinder.length;
    for (int i = 0; i < PRISM_SIDES; ++i) {
      const double angle = 2.0 * M_PI * i / PRISM_SIDES;
      for (const double z : {-half, half}) {
        corners.emplace_back(outside * std::cos(angle), outside * std::sin(angle), z);
      }
    }
    const ConvexHull prism = convexHull(corners);
    if (prism.faces.empty()) return coverOfPoints(corners);
    Solid solid = hullSolid(prism, size());
    solid.depth = [cylinder, half](const Vector3d& p) {
      return std::max(0.0, std::min(cylinder.radius - p.head<2>().norm(), half - std::abs(p[2])));
    };
    return coverOf(solid);
  }
  BallCover operator()(const HalfSpace&) const { return {}; }
  BallCover operator()(const Convex&) const { return coverOfConvex(shape.hull, size()); }
  BallCover operator()(const Mesh&) const {
    if (!shape.mesh || shape.hull.faces.empty()) return coverOfConvex(shape.hull, size());
    return coverOf(meshSolid(shape, size()));
  }
  double size() const { return shape.core.extent + shape.core.center.norm(); }

  const Prepared& shape;
};

}  // namespace

BallCover coverByBalls(const Prepared& shape) {
  return std::visit(MakeCover{shape}, shape.shape());
}

}  // namespace collision_pairs
