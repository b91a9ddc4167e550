#include "triangle_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace collision_pairs {
namespace {

using Eigen::Vector3d;

// Far above the rounding error of a height, relative to its operands; squared.
constexpr double PLANE_ROUNDING = 1e-18;

Vector3d closestOnSegment(const Vector3d& a, const Vector3d& b, const Vector3d& p) {
  const Vector3d edge = b - a;
  const double along = edge.dot(p - a), squared = edge.squaredNorm();
  if (!(along > 0.0)) return a;
  if (along >= squared) return b;
  return a + (along / squared) * edge;
}

// Heights of b's corners over a's plane.
struct Heights {
  Heights(const Triangle& a, const Triangle& b) {
    for (int i = 0; i < 3; ++i) h[i] = a.normal.dot(b.v[i] - a.v[0]);
  }
  double low() const { return std::min({h[0], h[1], h[2]}); }
  double high() const { return std::max({h[0], h[1], h[2]}); }
  /// Distance that the plane alone guarantees between a and b.
  double apart() const { return std::max({0.0, low(), -high()}); }
  std::array<double, 3> h;
};

bool isInside(const Triangle& t, const Vector3d& p) {
  for (int i = 0; i < 3; ++i) {
    if ((t.v[(i + 1) % 3] - t.v[i]).cross(t.normal).dot(p - t.v[i]) > 0.0) return false;
  }
  return true;
}

// An edge of b that pierces a.
bool pierces(const Triangle& a, const Triangle& b, const Heights& heights, ClosestPoints& best) {
  if (heights.low() > 0.0 || heights.high() < 0.0 || a.normal.isZero(0.0)) return false;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const double from = heights.h[i], to = heights.h[j];
    if ((from > 0.0) == (to > 0.0) && from != 0.0 && to != 0.0) continue;
    if (from == to) continue;
    const double t = std::clamp(from / (from - to), 0.0, 1.0);
    const Vector3d p = b.v[i] + t * (b.v[j] - b.v[i]);
    if (!isInside(a, p)) continue;
    best.squared = 0.0;
    best.on_a = best.on_b = p;
    return true;
  }
  return false;
}

// Corners of b against a; if the roles are swapped, the caller swaps on_a and on_b.
bool improveByCorners(const Triangle& a, const Triangle& b, const Heights& heights, double& squared,
                      Vector3d& on_a, Vector3d& on_b) {
  bool improved = false;
  for (int i = 0; i < 3; ++i) {
    if (heights.h[i] * heights.h[i] >= squared) continue;
    const Vector3d foot = closestOnTriangle(a, b.v[i]);
    const double found = (foot - b.v[i]).squaredNorm();
    if (found >= squared) continue;
    squared = found;
    on_a = foot;
    on_b = b.v[i];
    improved = true;
  }
  return improved;
}

// For closest points in the interior of both edges, by the common normal of the lines: accurate for
// nearly parallel edges too. All other cases are corners against triangles.
bool improveByEdges(const Triangle& a, const Triangle& b, ClosestPoints& best) {
  bool improved = false;
  for (int i = 0; i < 3; ++i) {
    const Vector3d d_a = a.v[(i + 1) % 3] - a.v[i];
    for (int j = 0; j < 3; ++j) {
      const Vector3d d_b = b.v[(j + 1) % 3] - b.v[j];
      const Vector3d n = d_a.cross(d_b), r = b.v[j] - a.v[i];
      const double nn = n.squaredNorm(), across = r.dot(n);
      if (!(nn > 0.0) || across * across >= best.squared * nn) continue;
      const double s = r.cross(d_b).dot(n), t = r.cross(d_a).dot(n);
      if (s < 0.0 || s > nn || t < 0.0 || t > nn) continue;
      best.on_a = a.v[i] + (s / nn) * d_a;
      best.on_b = b.v[j] + (t / nn) * d_b;
      best.squared = across * across / nn;
      improved = true;
    }
  }
  return improved;
}

}  // namespace

Triangle::Triangle(const Vector3d& a, const Vector3d& b, const Vector3d& c)
    : v{a, b, c}, normal(Vector3d::Zero()) {
  const Vector3d ab = b - a, bc = c - b, ca = a - c;
  const double x = ab.squaredNorm(), y = bc.squaredNorm(), z = ca.squaredNorm();
  const Vector3d cross = z >= x && z >= y ? ab.cross(bc) : (x >= y ? bc.cross(ca) : ca.cross(ab));
  const double length = cross.norm();
  // Below this the cross product is mostly rounding and defines no plane.
  if (length > 1e-15 * std::max({x, y, z})) normal = cross / length;
}

Vector3d closestOnTriangle(const Triangle& triangle, const Vector3d& p) {
  const auto& v = triangle.v;
  Vector3d closest = v[0];
  double squared = -1.0;
  const bool flat = triangle.normal.isZero(0.0);
  for (int i = 0; i < 3; ++i) {
    const Vector3d edge = v[(i + 1) % 3] - v[i];
    if (!flat && edge.cross(triangle.normal).dot(p - v[i]) <= 0.0) continue;
    const Vector3d foot = closestOnSegment(v[i], v[(i + 1) % 3], p);
    const double found = (p - foot).squaredNorm();
    if (squared >= 0.0 && found >= squared) continue;
    squared = found;
    closest = foot;
  }
  if (squared >= 0.0) return closest;
  return p - triangle.normal.dot(p - v[0]) * triangle.normal;
}

bool planeKeepsApart(const Corners& a, const Corners& b, double squared_limit) {
  const Vector3d first = a[1] - a[0], second = a[2] - a[0], normal = first.cross(second);
  double low = std::numeric_limits<double>::infinity(), high = -low, squared_reach = 0.0;
  for (const Vector3d& corner : b) {
    const Vector3d r = corner - a[0];
    low = std::min(low, normal.dot(r));
    high = std::max(high, normal.dot(r));
    squared_reach = std::max(squared_reach, r.squaredNorm());
  }
  const double apart = std::max(low, -high);
  // By the edges' lengths, not the normal's: the normal of a sliver is mostly rounding.
  const double scale = first.squaredNorm() * second.squaredNorm();
  return apart > 0.0 && apart * apart > scale * (PLANE_ROUNDING * squared_reach + squared_limit);
}

bool improveByTriangles(const Triangle& a, const Triangle& b, ClosestPoints& best) {
  const Heights over_a(a, b);
  if (over_a.apart() * over_a.apart() >= best.squared) return false;
  const Heights over_b(b, a);
  if (over_b.apart() * over_b.apart() >= best.squared) return false;
  if (pierces(a, b, over_a, best) || pierces(b, a, over_b, best)) return true;
  bool improved = improveByCorners(a, b, over_a, best.squared, best.on_a, best.on_b);
  improved |= improveByCorners(b, a, over_b, best.squared, best.on_b, best.on_a);
  improved |= improveByEdges(a, b, best);
  return improved;
}

}  // namespace collision_pairs
