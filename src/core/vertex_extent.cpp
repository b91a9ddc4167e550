#include "vertex_extent.h"

#include <algorithm>

namespace collision_pairs {

#ifdef COLLISION_PAIRS_X86_KERNELS
extern const ExtentLoop EXTENT_AVX2;
#endif

namespace {

typedef double TwoDoubles __attribute__((vector_size(16)));

ExtentLoop bestLoop() {
#ifdef COLLISION_PAIRS_X86_KERNELS
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return EXTENT_AVX2;
#endif
  return &extentLoop<TwoDoubles, 2>;
}

}  // namespace

PackedPoints::PackedPoints(const std::vector<Eigen::Vector3d>& points)
    : blocks_((points.size() + POINT_LANES - 1) / POINT_LANES) {
  for (std::size_t i = 0; i < blocks_.size() * POINT_LANES; ++i) {
    const Eigen::Vector3d& point = points[std::min(i, points.size() - 1)];
    for (int axis = 0; axis < 3; ++axis) {
      blocks_[i / POINT_LANES].xyz[axis][i % POINT_LANES] = point[axis];
    }
  }
}

void PackedPoints::extent(const Eigen::Matrix3d& R, Eigen::Vector3d& lower,
                          Eigen::Vector3d& upper) const {
  static const ExtentLoop LOOP = bestLoop();
  LOOP(blocks_.data(), blocks_.size(), R.data(), lower.data(), upper.data());
}

}  // namespace collision_pairs
