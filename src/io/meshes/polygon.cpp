#include "polygon.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Geometry>

namespace collision_pairs {
namespace {

using Corners = std::vector<Eigen::Vector3d>;

constexpr double ROUNDING = 1e-15;  // of twice an area, as a share of that of the square around
constexpr std::size_t MOST_CORNERS = 500;  // of which ears are cut off

/// Newell's: its length is twice the area.
Eigen::Vector3d normalOf(const Corners& corners) {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    normal += corners[i].cross(corners[(i + 1) % corners.size()]);
  }
  return normal;
}

/// All corners turn the same way about the normal, once around in total.
bool isConvex(const Corners& corners, const Eigen::Vector3d& normal) {
  const std::size_t count = corners.size();
  double turned = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d& corner = corners[(i + 1) % count];
    const Eigen::Vector3d before = corner - corners[i], after = corners[(i + 2) % count] - corner;
    const double sine = before.cross(after).dot(normal);
    const double cosine = before.dot(after) * normal.norm();
    if (sine < 0.0) return false;
    turned += std::atan2(sine, cosine);
  }
  return turned < 3.0 * M_PI;  // 2 pi, up to rounding
}

bool areInLine(const Corners& corners) {
  for (std::size_t i = 2; i < corners.size(); ++i) {
    const Eigen::Vector3d first = corners[i - 1] - corners[0], second = corners[i] - corners[0];
    if (!first.cross(second).isZero(0.0)) return false;
  }
  return true;
}

PolygonTriangles fan(std::size_t nb_corners) {
  PolygonTriangles triangles;
  for (std::size_t i = 2; i < nb_corners; ++i) triangles.push_back({0, i - 1, i});
  return triangles;
}

/// Cuts corners off that no other corner is in the way of.
class Ears {
 public:
  /// `rounding`: of twice an area.
  Ears(const Corners& corners, const Eigen::Vector3d& normal, double rounding)
      : left_(corners.size()), rounding_(rounding) {
    std::iota(left_.begin(), left_.end(), std::size_t{0});
    int axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    const int first = (axis + 1) % 3, second = (axis + 2) % 3;
    const double sign = normal[axis] < 0.0 ? -1.0 : 1.0;
    for (const Eigen::Vector3d& corner : corners) {
      seen_.emplace_back(corner[first], sign * corner[second]);
    }
  }

  std::optional<PolygonTriangles> cut() {
    PolygonTriangles triangles;
    if (crossesItself()) return std::nullopt;
    while (left_.size() > 3) {
      std::size_t at = 0;
      while (at < left_.size() && !isEar(at)) ++at;
      if (at == left_.size()) return std::nullopt;
      triangles.push_back(corner(at));
      left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(at));
    }
    triangles.push_back({left_[0], left_[1], left_[2]});
    return triangles;
  }

 private:
  std::array<std::size_t, 3> corner(std::size_t at) const {
    const std::size_t count = left_.size();
    return {left_[(at + count - 1) % count], left_[at], left_[(at + 1) % count]};
  }
  double side(std::size_t a, std::size_t b, std::size_t c) const {
    const Eigen::Vector2d ab = seen_[b] - seen_[a], ac = seen_[c] - seen_[a];
    return ab.x() * ac.y() - ab.y() * ac.x();
  }

  /// Whether c and d are on either side of the line through a and b.
  bool areApart(std::size_t a, std::size_t b, std::size_t c, std::size_t d) const {
    const double of_c = side(a, b, c), of_d = side(a, b, d);
    return std::min(of_c, of_d) < -rounding_ && std::max(of_c, of_d) > rounding_;
  }
  bool crossesItself() const {
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        const std::size_t i_end = (i + 1) % seen_.size(), k_end = (k + 1) % seen_.size();
        if (areApart(i, i_end, k, k_end) && areApart(k, k_end, i, i_end)) return true;
      }
    }
    return false;
  }

  // What lies on its sides is not in the way: corners of a bridge to a hole, for example.
  bool isEar(std::size_t at) const {
    const auto [a, b, c] = corner(at);
    if (side(a, b, c) < -rounding_) return false;
    return std::none_of(left_.begin(), left_.end(), [&, a = a, b = b, c = c](std::size_t other) {
      return side(a, b, other) > rounding_ && side(b, c, other) > rounding_ &&
             side(c, a, other) > rounding_;
    });
  }

  std::vector<Eigen::Vector2d> seen_;  ///< along the normal, counter-clockwise
  std::vector<std::size_t> left_;
  const double rounding_;
};

}  // namespace

std::optional<PolygonTriangles> triangulated(const std::vector<std::array<float, 3>>& polygon) {
  if (polygon.size() == 3) return fan(3);
  Corners corners;
  for (const auto& [x, y, z] : polygon) corners.emplace_back(x, y, z);
  const Eigen::Vector3d origin = corners[0];
  double size = 0.0;
  for (Eigen::Vector3d& corner : corners) {
    corner -= origin;
    size = std::max(size, corner.norm());
  }
  const Eigen::Vector3d normal = normalOf(corners);
  if (areInLine(corners)) return fan(corners.size());
  if (normal.isZero(0.0)) return std::nullopt;
  if (isConvex(corners, normal)) return fan(corners.size());
  if (corners.size() > MOST_CORNERS) return std::nullopt;
  return Ears(corners, normal, ROUNDING * size * size).cut();
}

}  // namespace collision_pairs
