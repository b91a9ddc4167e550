#include "packed_points.h"

#include <algorithm>

namespace collision_pairs {

void appendBlocks(const std::vector<Eigen::Vector3d>& points, std::vector<PointBlock>& blocks) {
  const std::size_t nb_blocks = (points.size() + POINT_LANES - 1) / POINT_LANES;
  for (std::size_t i = 0; i < nb_blocks * POINT_LANES; ++i) {
    if (i % POINT_LANES == 0) blocks.emplace_back();
    const Eigen::Vector3d& point = points[std::min(i, points.size() - 1)];
    for (int axis = 0; axis < 3; ++axis) blocks.back().xyz[axis][i % POINT_LANES] = point[axis];
  }
}

FurthestPoint furthestInBlocks(const PointBlock* blocks, std::size_t count,
                               const Eigen::Vector3d& direction) {
  static const auto LOOP = geometryKernels().front().furthest_point;
  FurthestPoint furthest;
  furthest.index = LOOP(blocks, count, direction.data(), &furthest.height);
  return furthest;
}

PackedPoints::PackedPoints(const std::vector<Eigen::Vector3d>& points) {
  appendBlocks(points, blocks_);
}

void PackedPoints::extent(const Eigen::Matrix3d& R, Eigen::Vector3d& lower,
                          Eigen::Vector3d& upper) const {
  static const auto LOOP = geometryKernels().front().extent;
  LOOP(blocks_.data(), blocks_.size(), R.data(), lower.data(), upper.data());
}

}  // namespace collision_pairs
