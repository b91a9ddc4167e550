// Points packed for SIMD loops: support points and extents.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "geometry_kernel.h"

namespace collision_pairs {

/// Appends the points to `blocks`, the last block filled up with the last point. At least one.
void appendBlocks(const std::vector<Eigen::Vector3d>& points, std::vector<PointBlock>& blocks);

struct FurthestPoint {
  std::size_t index;  ///< if the last point is repeated to fill a block: of any of these
  double height;      ///< its coordinate along the direction
};

/// Among the points of `count` >= 1 blocks; `direction` need not be of unit length.
/// Cost: about 0.3 ns a point with AVX2, which is chosen at run time.
FurthestPoint furthestInBlocks(const PointBlock* blocks, std::size_t count,
                               const Eigen::Vector3d& direction);

/// Points as structure of arrays, in blocks, the last block filled up with the last point.
class PackedPoints {
 public:
  PackedPoints() = default;
  explicit PackedPoints(const std::vector<Eigen::Vector3d>& points);

  /// The smallest and largest coordinates of R p over all points p: along the rows of R. At least
  /// one point. Not finite where R is not. Cost: about 0.2 ns a point with
  /// AVX-512, chosen at run time.
  void extent(const Eigen::Matrix3d& R, Eigen::Vector3d& lower, Eigen::Vector3d& upper) const;

 private:
  std::vector<PointBlock> blocks_;
};

}  // namespace collision_pairs
