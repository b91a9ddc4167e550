// Cones, which the core does not know.
#pragma once

#include <cmath>
#include <memory>

#include "collision_pairs/shape.h"

namespace collision_pairs {

/// The pyramid with 64 sides that circumscribes a cone; metres. Apex at z = height / 2, base at
/// z = -height / 2.
inline Shape pyramidAroundCone(double radius, double height) {
  constexpr int SIDES = 64;
  constexpr double PI = 3.14159265358979323846;
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->name = "cone";
  const double outer = radius / std::cos(PI / SIDES);
  for (int i = 0; i < SIDES; ++i) {
    const double angle = 2.0 * PI * i / SIDES;
    mesh->vertices.emplace_back(outer * std::cos(angle), outer * std::sin(angle), -0.5 * height);
  }
  mesh->vertices.emplace_back(0.0, 0.0, 0.5 * height);
  return Convex{mesh};
}

}  // namespace collision_pairs
