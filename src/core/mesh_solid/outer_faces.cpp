#include "outer_faces.h"

#include <cmath>

#include <Eigen/Geometry>

namespace collision_pairs {
namespace {

using Eigen::Vector3d;

// Sorts the triangles by their angle around the edge, by the right-hand rule from low to high.
void sortAround(const TriangleMesh& mesh, const Surface& surface, Sides::iterator begin,
                Sides::iterator end) {
  const Vector3d& foot = mesh.vertices[begin->low];
  const Vector3d axis = (mesh.vertices[begin->high] - foot).normalized();
  const auto arm = [&](const Side& side) -> Vector3d {
    const Triangle3& t = surface[side.triangle];
    return mesh.vertices[t[0] + t[1] + t[2] - side.low - side.high] - foot;
  };
  const Vector3d v = axis.cross(arm(*begin)), u = v.cross(axis);
  std::vector<std::pair<double, Side>> around{{0.0, *begin}};
  for (auto side = begin + 1; side != end; ++side) {
    const Vector3d r = arm(*side);
    const double angle = std::atan2(r.dot(v), r.dot(u));
    around.emplace_back(angle < 0.0 ? angle + 2.0 * M_PI : angle, *side);
  }
  std::stable_sort(around.begin(), around.end(),
                   [](const auto& x, const auto& y) { return x.first < y.first; });
  for (const auto& entry : around) *begin++ = entry.second;
}

// Index of one of the two faces of a triangle: the one on the side of its normal, or the other.
std::uint32_t face(std::uint32_t triangle, bool front) { return 2 * triangle + (front ? 0 : 1); }

UnionFind regionsOf(const TriangleMesh& mesh, const Surface& surface, LooseEdges loose_edges) {
  Sides sides = sortedSides(surface);
  UnionFind regions(2 * surface.size());
  forEachEdge(sides, [&](Sides::iterator begin, Sides::iterator end) {
    if (end - begin == 1) {
      const std::uint32_t t = begin->triangle;
      if (loose_edges == LooseEdges::ARE_GAPS) regions.join(face(t, true), face(t, false));
      return;
    }
    if (end - begin > 2) sortAround(mesh, surface, begin, end);
    for (auto side = begin; side != end; ++side) {
      const Side& next = side + 1 == end ? *begin : *(side + 1);
      regions.join(face(side->triangle, side->forward), face(next.triangle, !next.forward));
    }
  });
  return regions;
}

}  // namespace

double signedVolume(const TriangleMesh& mesh, const Triangle3& t, const Vector3d& point) {
  const Vector3d a = mesh.vertices[t[0]] - point;
  return a.dot((mesh.vertices[t[1]] - point).cross(mesh.vertices[t[2]] - point)) / 6.0;
}

std::vector<int> outerFaces(const TriangleMesh& mesh, const Surface& surface,
                            LooseEdges loose_edges) {
  UnionFind regions = regionsOf(mesh, surface, loose_edges);
  // The surface of the outer region, seen from there, encloses a negative volume.
  std::vector<double> volumes(2 * surface.size(), 0.0);
  for (std::uint32_t t = 0; t < surface.size(); ++t) {
    const double volume = signedVolume(mesh, surface[t], mesh.vertices[surface[0][0]]);
    volumes[regions.find(face(t, true))] -= volume;
    volumes[regions.find(face(t, false))] += volume;
  }
  const auto outside = static_cast<std::uint32_t>(std::min_element(volumes.begin(), volumes.end()) -
                                                  volumes.begin());
  std::vector<int> result;
  for (std::uint32_t t = 0; t < surface.size(); ++t) {
    const bool front = regions.find(face(t, true)) == outside;
    const bool back = regions.find(face(t, false)) == outside;
    result.push_back(static_cast<int>(front) - static_cast<int>(back));
  }
  return result;
}

}  // namespace collision_pairs
