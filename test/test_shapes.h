// Names of shapes and small meshes for tests.
#pragma once

#include <algorithm>
#include <memory>

#include "collision_pairs/shape.h"

namespace collision_pairs {

inline const char* shapeName(const Shape& shape) {
  constexpr const char* NAMES[] = {"box",        "sphere", "cylinder", "capsule",
                                   "half-space", "convex", "mesh"};
  return NAMES[shape.index()];
}

/// A box from -half to half, 12 triangles facing outwards.
inline TriangleMesh boxMesh(const Eigen::Vector3d& half) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back(i & 1 ? half[0] : -half[0], i & 2 ? half[1] : -half[1],
                               i & 4 ? half[2] : -half[2]);
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// The bodies of both, not welded.
inline TriangleMesh joined(TriangleMesh a, const TriangleMesh& b) {
  const auto shift = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& t : b.triangles) {
    a.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  }
  return a;
}

inline TriangleMesh movedBy(TriangleMesh mesh, const Eigen::Vector3d& by) {
  for (auto& v : mesh.vertices) v += by;
  return mesh;
}

inline TriangleMesh insideOut(TriangleMesh mesh) {
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

inline Shape meshShape(TriangleMesh mesh) {
  return Mesh{std::make_shared<const TriangleMesh>(std::move(mesh))};
}

/// Two boxes as one L: not convex. `pieces` are the boxes it is the union of, centred at
/// `piece_centers`.
struct LShape {
  Eigen::Vector3d piece_halves[2] = {{0.15, 0.05, 0.05}, {0.05, 0.05, 0.15}};
  Eigen::Vector3d piece_centers[2] = {{0.0, 0.0, 0.0}, {0.1, 0.0, 0.1}};
  TriangleMesh mesh() const {
    return joined(movedBy(boxMesh(piece_halves[0]), piece_centers[0]),
                  movedBy(boxMesh(piece_halves[1]), piece_centers[1]));
  }
};

/// Rings of a surface of revolution around z with n^2 * 2 triangles: a bumpy, closed, star-shaped
/// body of about the given radius.
inline TriangleMesh bumpyBall(int n, double radius) {
  TriangleMesh mesh;
  mesh.vertices.emplace_back(0.0, 0.0, radius);
  for (int i = 1; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double t = M_PI * i / n, p = 2.0 * M_PI * j / n;
      const double r = radius * (1.0 + 0.1 * std::sin(5.0 * t) * std::cos(3.0 * p));
      mesh.vertices.emplace_back(r * std::sin(t) * std::cos(p), r * std::sin(t) * std::sin(p),
                                 r * std::cos(t));
    }
  }
  mesh.vertices.emplace_back(0.0, 0.0, -radius);
  const auto at = [n](int i, int j) { return static_cast<std::uint32_t>(1 + (i - 1) * n + j % n); };
  const auto last = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  for (int j = 0; j < n; ++j) {
    mesh.triangles.push_back({0, at(1, j), at(1, j + 1)});
    for (int i = 1; i + 1 < n; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
    mesh.triangles.push_back({last, at(n - 1, j + 1), at(n - 1, j)});
  }
  return mesh;
}

/// A prism of `corners` sides as files store one: its flat faces are of many triangles, whose
/// corners were rounded to float. So it is convex but for that, and its hull nearly is its surface.
inline TriangleMesh storedPrism(int corners, double radius, double height,
                                const Eigen::Matrix3d& R) {
  TriangleMesh mesh;
  for (int i = 0; i < 3 * corners; ++i) {
    const double angle = 2.0 * M_PI * (i / 3) / corners;
    const Eigen::Vector3d corner(radius * std::cos(angle), radius * std::sin(angle),
                                 (i % 3 - 1) * height);
    mesh.vertices.push_back((R * corner).cast<float>().cast<double>());
  }
  const auto at = [&](int i, int ring) {
    return static_cast<std::uint32_t>(i % corners * 3 + ring);
  };
  for (int i = 0; i < corners; ++i) {
    for (const int ring : {0, 1}) {
      mesh.triangles.push_back({at(i, ring), at(i + 1, ring), at(i + 1, ring + 1)});
      mesh.triangles.push_back({at(i, ring), at(i + 1, ring + 1), at(i, ring + 1)});
    }
    if (i == 0 || i + 1 == corners) continue;
    mesh.triangles.push_back({at(0, 2), at(i, 2), at(i + 1, 2)});
    mesh.triangles.push_back({at(0, 0), at(i + 1, 0), at(i, 0)});
  }
  return mesh;
}

}  // namespace collision_pairs
