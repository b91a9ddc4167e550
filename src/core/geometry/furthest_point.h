// Which of a set of points is furthest along a direction.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "point_block.h"

namespace collision_pairs {

/// Appends the points to `blocks`, the last block filled up with the last point. At least one.
void appendBlocks(const std::vector<Eigen::Vector3d>& points, std::vector<PointBlock>& blocks);

struct FurthestPoint {
  std::size_t index;  ///< of points that fill a block up: of one of the equal ones
  double height;      ///< its coordinate along the direction
};

/// Among the points of `count` >= 1 blocks; `direction` need not be of unit length.
/// Cost: about 0.3 ns a point with AVX2, which is chosen at run time.
FurthestPoint furthestInBlocks(const PointBlock* blocks, std::size_t count,
                               const Eigen::Vector3d& direction);

}  // namespace collision_pairs
