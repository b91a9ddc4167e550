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

// For closest points in the interior of both edges, by the common normal of the lines, which is
// mostly rounding if they are parallel: only the distance of two points counts. From the first two
// on, the normal errs in proportion to their gap. All other cases are corners against triangles.
bool improveByEdges(const Triangle& a, const Triangle& b, ClosestPoints& best) {
  bool improved = false;
  for (int i = 0; i < 3; ++i) {
    const Vector3d d_a = a.v[(i + 1) % 3] - a.v[i];
    for (int j = 0; j < 3; ++j) {
      const Vector3d &from_b = b.v[j], &to_b = b.v[(j + 1) % 3];
      const Vector3d d_b = to_b - from_b, n = d_a.cross(d_b), r = from_b - a.v[i];
      const double nn = n.squaredNorm(), across = r.dot(n);
      if (!(nn > 0.0) || across * across >= best.squared * nn) continue;
      const double s = r.cross(d_b).dot(n), t = r.cross(d_a).dot(n);
      if (s < 0.0 || s > nn || t < 0.0 || t > nn) continue;
      const auto pointOfA = [&](double share) { return Vector3d(a.v[i] + share * d_a); };
      Vector3d on_a = pointOfA(s / nn);
      const Vector3d gap = closestOnSegment(from_b, to_b, on_a) - on_a;
      on_a = pointOfA(std::clamp((s + gap.cross(d_b).dot(n)) / nn, 0.0, 1.0));
      const Vector3d on_b = closestOnSegment(from_b, to_b, on_a);
      const double squared = (on_b - on_a).squaredNorm();
      if (squared >= best.squared) continue;
      best = {squared, on_a, on_b};
      improved = true;
    }
  }
  return improved;
}

// From the box around the origin to the point p.
Vector3d fromBox(const Vector3d& p, const Vector3d& half) {
  return p - p.cwiseMax(-half).cwiseMin(half);
}

// From the box around the origin to the point of the segment from a to a + d that is nearest to it.
// The squared distance is convex, and quadratic between the planes of the box's faces: Newton's
// method, and halving where it leaves what is left to search.
Vector3d segmentFromBox(const Vector3d& a, const Vector3d& d, const Vector3d& half) {
  constexpr int MAX_STEPS = 16;
  constexpr double CLOSE = std::numeric_limits<double>::epsilon();
  const double squared = d.squaredNorm();
  double at = squared > 0.0 ? std::clamp(-a.dot(d) / squared, 0.0, 1.0) : 0.0;
  double low = -1.0, high = 2.0;  // what was tried; the ends were not yet
  Vector3d apart = fromBox(a + at * d, half);
  for (int i = 0; i < MAX_STEPS; ++i) {
    double slope = 0.0, curvature = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      slope += apart[axis] * d[axis];
      curvature += apart[axis] != 0.0 ? d[axis] * d[axis] : 0.0;
    }
    if (!(curvature > 0.0)) break;
    (slope > 0.0 ? high : low) = at;
    double next = std::clamp(at - slope / curvature, 0.0, 1.0);
    if (std::abs(next - at) <= CLOSE) break;
    if (next <= low || next >= high) next = 0.5 * (low + high);
    at = next;
    apart = fromBox(a + at * d, half);
  }
  return apart;
}

// True if the point, which is moved along n, comes to lie in the triangle of this normal.
bool isAbove(const Corners& t, const Vector3d& n, const Vector3d& p) {
  for (int i = 0; i < 3; ++i) {
    if ((t[(i + 1) % 3] - t[i]).cross(n).dot(p - t[i]) > 0.0) return false;
  }
  return true;
}

}  // namespace

Triangle::Triangle(const Vector3d& a, const Vector3d& b, const Vector3d& c)
    : v{a, b, c}, normal(Vector3d::Zero()) {
  const Vector3d ab = b - a, bc = c - b, ca = a - c;
  const double x = ab.squaredNorm(), y = bc.squaredNorm(), z = ca.squaredNorm();
  const bool is_ca = z >= x && z >= y, is_ab = !is_ca && x >= y;  // the longest edge
  const Vector3d longest = is_ca ? ca : is_ab ? ab : bc;
  Vector3d cross = is_ca ? ab.cross(bc) : is_ab ? bc.cross(ca) : ca.cross(ab);
  // Of a sliver it is mostly rounding, but any plane through its longest edge is as good.
  const double squared = longest.squaredNorm();
  if (squared > 0.0) cross -= (cross.dot(longest) / squared) * longest;
  const double length = cross.norm();
  if (length > 1e-15 * squared) normal = cross / length;
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

// Apart, the closest point of the triangle is on an edge, or in its middle: then a corner of the
// box is above it, and the distance is the corner's height.
DistanceBounds distanceFromBox(const Corners& t, const Vector3d& half, double limit) {
  constexpr double THIN = 1e-6;  // a triangle this thin has no normal that is worth using
  const Vector3d low = t[0].cwiseMin(t[1]).cwiseMin(t[2]);
  const Vector3d high = t[0].cwiseMax(t[1]).cwiseMax(t[2]);
  DistanceBounds bounds{(low - half).cwiseMax(-half - high).cwiseMax(0.0).norm()};
  if (bounds.lower > limit) return bounds;
  const Vector3d first = t[1] - t[0], second = t[2] - t[0], n = first.cross(second);
  const double length = n.norm();
  const bool is_thin = !(length > THIN * (first.squaredNorm() + second.squaredNorm()));
  const double h[] = {n.dot(t[0]), n.dot(t[1]), n.dot(t[2])}, reach = n.cwiseAbs().dot(half);
  const double side = h[0] < 0.0 ? -1.0 : 1.0;
  const double over = std::min({side * h[0], side * h[1], side * h[2]}) - reach;
  const double most = std::max({side * h[0], side * h[1], side * h[2]}) - reach;
  const Vector3d corner = (side * n.array() < 0.0).select(-half, half);  // of the box: the highest
  if (over > 0.0) {
    bounds.lower = std::max(bounds.lower, over / length);
    if (bounds.lower > limit) return bounds;
    if (!is_thin && isAbove(t, n, corner)) {
      bounds.upper = most / length;
      bounds.nhat = side / length * n;
      return bounds;
    }
  }
  Vector3d apart = Vector3d::Zero();
  double squared = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const Vector3d& from = t[i];
    const Vector3d& to = t[(i + 1) % 3];
    const Vector3d gap = (from.cwiseMin(to) - half).cwiseMax(-half - from.cwiseMax(to));
    if (gap.cwiseMax(0.0).squaredNorm() >= squared) continue;
    const Vector3d of_edge = segmentFromBox(from, to - from, half);
    if (of_edge.squaredNorm() >= squared) continue;
    apart = of_edge;
    squared = of_edge.squaredNorm();
  }
  bounds.upper = std::sqrt(squared);
  // No edge meets the box: if its diagonal meets the triangle's plane inside, so does the box.
  const bool is_pierced =
      !is_thin && over <= 0.0 && reach > 0.0 && isAbove(t, n, side * h[0] / reach * corner);
  if (!(bounds.upper > 0.0) || is_pierced) {
    bounds.lower = bounds.upper = 0.0;
    return bounds;
  }
  bounds.nhat = apart / bounds.upper;
  const auto along = [&](int i) { return bounds.nhat.dot(t[i]); };
  const double proved = std::min({along(0), along(1), along(2)}) - bounds.nhat.cwiseAbs().dot(half);
  bounds.lower = std::max(bounds.lower, proved);
  return bounds;
}

}  // namespace collision_pairs
