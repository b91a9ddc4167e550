// Meshes as files have them: triangles that share no vertex, and surfaces with a hole.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "random_inputs.h"
#include "test_shapes.h"

namespace collision_pairs {

/// No two triangles share a vertex, and none stands where it stood.
inline TriangleMesh asSoup(const TriangleMesh& mesh, RandomInputs& random) {
  TriangleMesh soup;
  std::vector<std::array<std::uint32_t, 3>> triangles = mesh.triangles;
  std::shuffle(triangles.begin(), triangles.end(), random.engine());
  for (const auto& t : triangles) {
    const auto n = static_cast<std::uint32_t>(soup.vertices.size());
    const int first = random.integer(0, 2);
    for (int k = 0; k < 3; ++k) soup.vertices.push_back(mesh.vertices[t[(first + k) % 3]]);
    soup.triangles.push_back({n, n + 1, n + 2});
  }
  return soup;
}

/// Without the triangles whose three vertices are all there: isThere(vertex).
template <class IsThere>
TriangleMesh without(TriangleMesh mesh, const IsThere& isThere) {
  const auto areAllThere = [&](const auto& t) {
    return std::all_of(t.begin(), t.end(),
                       [&](std::uint32_t i) { return isThere(mesh.vertices[i]); });
  };
  auto& triangles = mesh.triangles;
  triangles.erase(std::remove_if(triangles.begin(), triangles.end(), areAllThere),
                  triangles.end());
  return mesh;
}

/// Without the triangles around its north pole, a ball that has `rings` of 40 left.
inline TriangleMesh ballWithoutItsTop(int rings) {
  const double z = std::cos(M_PI * (40 - rings + 0.5) / 40.0);
  return without(bumpyBall(40, 1.0),
                 [&](const Eigen::Vector3d& v) { return v.normalized()[2] > z; });
}

}  // namespace collision_pairs
