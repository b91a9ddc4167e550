#include "box_gap.h"

#include <algorithm>

namespace collision_pairs {

#ifdef COLLISION_PAIRS_X86_KERNELS
extern const BoxGapLoops BOX_GAPS_AVX2;
#endif

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

typedef double TwoDoubles __attribute__((vector_size(16)));
typedef long long TwoIntegers __attribute__((vector_size(16)));

BoxGapLoops bestLoops() {
#ifdef COLLISION_PAIRS_X86_KERNELS
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return BOX_GAPS_AVX2;
#endif
  return BoxGapLoop<TwoDoubles, TwoIntegers, 2>::ALL;
}

const BoxGapLoops& loops() {
  static const BoxGapLoops LOOPS = bestLoops();
  return LOOPS;
}

double squaredExcess(const Vector3d& apart, const Vector3d& reach) {
  return (apart.cwiseAbs() - reach).cwiseMax(0.0).squaredNorm();
}

}  // namespace

double squaredBoxGap(const OrientedBox& a, const OrientedBox& b) {
  const Matrix3d R_ab = a.R.transpose() * b.R;
  const Vector3d t = a.R.transpose() * (b.center - a.center);
  const Matrix3d reach = R_ab.cwiseAbs();
  const double along_a = squaredExcess(t, a.half + reach * b.half);
  const double along_b = squaredExcess(R_ab.transpose() * t, b.half + reach.transpose() * a.half);
  return std::max(along_a, along_b);
}

OrientedBox boxInLane(const BoxBlock& block, int lane) {
  OrientedBox box;
  for (int i = 0; i < 9; ++i) box.R.data()[i] = block.R[i][lane];
  for (int i = 0; i < 3; ++i) box.center[i] = block.center[i][lane];
  for (int i = 0; i < 3; ++i) box.half[i] = block.half[i][lane];
  return box;
}

void setLane(const OrientedBox& box, int lane, BoxBlock& block) {
  for (int i = 0; i < 9; ++i) block.R[i][lane] = box.R.data()[i];
  for (int i = 0; i < 3; ++i) block.center[i][lane] = box.center[i];
  for (int i = 0; i < 3; ++i) block.half[i][lane] = box.half[i];
}

FourGaps squaredBoxGaps(const BoxBlock& block, const OrientedBox& box) {
  FourGaps squared;
  loops().box(block, box.R.data(), box.center.data(), box.half.data(), squared.of);
  return squared;
}

FourGaps squaredBoxGaps(const BoxBlock& block, const BoxBlock& other, int lane,
                        const Eigen::Isometry3d& X) {
  FourGaps squared;
  loops().moved_box(block, other, lane, X.data(), squared.of);
  return squared;
}

FourGaps squaredPointGaps(const BoxBlock& block, const Vector3d& point) {
  FourGaps squared;
  loops().point(block, point.data(), squared.of);
  return squared;
}

}  // namespace collision_pairs
