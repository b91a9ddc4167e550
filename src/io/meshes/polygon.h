// Triangles of a polygon.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace collision_pairs {

using PolygonTriangles = std::vector<std::array<std::size_t, 3>>;

/// A fan of a convex polygon; of others, seen along their normal, ears are cut off (Meisters, Amer.
/// Math. Monthly 82, 1975). Three corners at least. Nothing if it crosses itself, or has more than
/// 500 corners and is not convex.
std::optional<PolygonTriangles> triangulated(const std::vector<std::array<float, 3>>& polygon);

}  // namespace collision_pairs
