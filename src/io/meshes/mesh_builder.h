// Builds a mesh with shared vertices from single polygons.
#pragma once

#include <array>
#include <cmath>
#include <cstring>
#include <unordered_map>
#include <vector>

#include <Eigen/Geometry>

#include "collision_pairs/shape.h"

namespace collision_pairs {

class MeshBuilder {
 public:
  using Corner = std::array<float, 3>;

  void addTriangle(const Corner& a, const Corner& b, const Corner& c) {
    mesh_.triangles.push_back({indexOf(a), indexOf(b), indexOf(c)});
  }
  /// Splits it into a fan. False, and nothing is added, if it is not convex.
  bool addPolygon(const std::vector<Corner>& polygon) {
    if (!isConvex(polygon)) return false;
    for (std::size_t i = 2; i < polygon.size(); ++i) {
      addTriangle(polygon[0], polygon[i - 1], polygon[i]);
    }
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

  /// True if all corners turn the same way about the polygon's normal, once around in total. False
  /// if it has no area.
  static bool isConvex(const std::vector<Corner>& polygon) {
    if (polygon.size() <= 3) return true;
    const auto toVector = [](const Corner& corner) {
      return Eigen::Vector3d(corner[0], corner[1], corner[2]);
    };
    const Eigen::Vector3d origin = toVector(polygon[0]);
    const auto at = [&](std::size_t i) -> Eigen::Vector3d {
      return toVector(polygon[i % polygon.size()]) - origin;
    };
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // Newell's
    for (std::size_t i = 0; i < polygon.size(); ++i) normal += at(i).cross(at(i + 1));
    if (normal.isZero(0.0)) return false;
    double turned = 0.0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Eigen::Vector3d before = at(i + 1) - at(i), after = at(i + 2) - at(i + 1);
      const double sine = before.cross(after).dot(normal);
      const double cosine = before.dot(after) * normal.norm();
      if (sine < 0.0) return false;
      turned += std::atan2(sine, cosine);
    }
    return turned < 3.0 * M_PI;  // 2 pi, up to rounding
  }

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
