#include "vertex_extent.h"

#include "furthest_point.h"

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

PackedPoints::PackedPoints(const std::vector<Eigen::Vector3d>& points) {
  appendBlocks(points, blocks_);
}

void PackedPoints::extent(const Eigen::Matrix3d& R, Eigen::Vector3d& lower,
                          Eigen::Vector3d& upper) const {
  static const ExtentLoop LOOP = bestLoop();
  LOOP(blocks_.data(), blocks_.size(), R.data(), lower.data(), upper.data());
}

}  // namespace collision_pairs
