#include "vertex_extent.h"

#include "furthest_point.h"

namespace collision_pairs {

#ifdef COLLISION_PAIRS_X86_KERNELS
extern const ExtentLoop EXTENT_AVX2;
extern const ExtentLoop EXTENT_AVX512;
#endif

namespace {

typedef double TwoDoubles __attribute__((vector_size(16)));

}  // namespace

const std::vector<ExtentLoop>& extentLoops() {
  static const std::vector<ExtentLoop> LOOPS = [] {
    std::vector<ExtentLoop> loops;
#ifdef COLLISION_PAIRS_X86_KERNELS
    // VBMI2 is not used: see sweepKernels().
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vbmi2")) {
      loops.push_back(EXTENT_AVX512);
    }
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
      loops.push_back(EXTENT_AVX2);
    }
#endif
    loops.push_back(&extentLoop<TwoDoubles, 2>);
    return loops;
  }();
  return LOOPS;
}

PackedPoints::PackedPoints(const std::vector<Eigen::Vector3d>& points) {
  appendBlocks(points, blocks_);
}

void PackedPoints::extent(const Eigen::Matrix3d& R, Eigen::Vector3d& lower,
                          Eigen::Vector3d& upper) const {
  static const ExtentLoop LOOP = extentLoops().front();
  LOOP(blocks_.data(), blocks_.size(), R.data(), lower.data(), upper.data());
}

}  // namespace collision_pairs
