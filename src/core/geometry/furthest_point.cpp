#include "furthest_point.h"

#include <algorithm>

#include "furthest_point_loop.h"

namespace collision_pairs {

#ifdef COLLISION_PAIRS_X86_KERNELS
extern const FurthestPointLoop FURTHEST_POINT_AVX2;
#endif

namespace {

typedef double TwoDoubles __attribute__((vector_size(16)));
typedef long long TwoIntegers __attribute__((vector_size(16)));

FurthestPointLoop bestLoop() {
#ifdef COLLISION_PAIRS_X86_KERNELS
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return FURTHEST_POINT_AVX2;
#endif
  return &furthestPointLoop<TwoDoubles, TwoIntegers, 2>;
}

}  // namespace

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
  static const FurthestPointLoop LOOP = bestLoop();
  FurthestPoint furthest;
  furthest.index = LOOP(blocks, count, direction.data(), &furthest.height);
  return furthest;
}

}  // namespace collision_pairs
