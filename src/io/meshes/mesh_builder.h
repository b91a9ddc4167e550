// Builds a mesh with shared vertices from single polygons.
#pragma once

#include <array>
#include <cstring>
#include <optional>
#include <unordered_map>
#include <vector>

#include "collision_pairs/shape.h"
#include "polygon.h"

namespace collision_pairs {

class MeshBuilder {
 public:
  using Corner = std::array<float, 3>;

  void addTriangle(const Corner& a, const Corner& b, const Corner& c) {
    mesh_.triangles.push_back({indexOf(a), indexOf(b), indexOf(c)});
  }
  /// Splits it into triangles. False, and nothing is added, if it crosses itself.
  bool addPolygon(const std::vector<Corner>& polygon) {
    const std::optional<PolygonTriangles> triangles = triangulated(polygon);
    if (!triangles) return false;
    for (const auto& [a, b, c] : *triangles) addTriangle(polygon[a], polygon[b], polygon[c]);
    return true;
  }
  TriangleMesh finish() { return std::move(mesh_); }

 private:
  struct BitsHash {
    std::size_t operator()(const Corner& corner) const {
      std::uint64_t hash = 0;
      for (const float coordinate : corner) {
        std::uint32_t bits;
        std::memcpy(&bits, &coordinate, sizeof bits);
        hash = (hash ^ bits) * 0x9E3779B97F4A7C15u;  // 2^64 / golden ratio: Knuth, TAOCP 6.4
        hash ^= hash >> 32;
      }
      return hash;
    }
  };
  // Compares bits, so that a NaN equals itself: a file full of them gives one vertex, which is
  // refused.
  struct SameBits {
    bool operator()(const Corner& a, const Corner& b) const {
      return std::memcmp(&a, &b, sizeof a) == 0;
    }
  };

  std::uint32_t indexOf(Corner corner) {
    for (float& coordinate : corner) coordinate += 0.0f;  // -0 is 0
    const auto [known, is_new] =
        index_of_.emplace(corner, static_cast<std::uint32_t>(mesh_.vertices.size()));
    if (is_new) mesh_.vertices.emplace_back(corner[0], corner[1], corner[2]);
    return known->second;
  }

  TriangleMesh mesh_;
  std::unordered_map<Corner, std::uint32_t, BitsHash, SameBits> index_of_;
};

}  // namespace collision_pairs
