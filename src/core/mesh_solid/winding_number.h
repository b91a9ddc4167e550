// Point containment for closed surfaces.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

namespace collision_pairs {

/// Generalised winding number of a set of triangles, with distant clusters approximated by dipoles.
/// Barill et al., "Fast winding numbers for soups and clouds" (2018). Deviation: near 1/2, where
/// the error of the dipoles could change the result, all solid angles are summed.
class WindingNumber {
 public:
  WindingNumber() = default;
  /// Corners in mesh frame M, metres. Cost: O(n log n).
  WindingNumber(const std::vector<Eigen::Vector3d>& vertices,
                std::vector<std::array<std::uint32_t, 3>> outward);

  bool empty() const { return corners_.empty(); }
  /// True if the absolute winding number at the point p_MQ is at least 1/2. Overlapping bodies add
  /// up, so what is inside any of them is inside, and cavities are excluded. Cost: O(log n) away
  /// from the surface, O(n) at worst.
  bool holds(const Eigen::Vector3d& p_MQ) const;

 private:
  struct Node {
    Eigen::Vector3d center, dipole;  // dipole: sum of area times normal
    double radius;                   // of a sphere around the centre that encloses the triangles
    std::uint32_t begin, end;        // its triangles
    std::uint32_t skip;              // the node after this one's subtree
  };
  void build(std::uint32_t begin, std::uint32_t end);
  double exact(const Eigen::Vector3d& p_MQ, std::uint32_t begin, std::uint32_t end) const;

  std::vector<std::array<Eigen::Vector3d, 3>> corners_;
  std::vector<Node> nodes_;  // depth first
  Eigen::Vector3d low_ = Eigen::Vector3d::Zero(), high_ = Eigen::Vector3d::Zero();
};

}  // namespace collision_pairs
