#include "box_gap.h"

namespace collision_pairs {

namespace {

using Eigen::Vector3d;

const GeometryKernel& kernel() {
  static const GeometryKernel KERNEL = geometryKernels().front();
  return KERNEL;
}

}  // namespace

double squaredBoxGap(const OrientedBox& a, const OrientedBox& b) {
  return squaredBoxGap(a.half, b.half, a.R.transpose() * b.R,
                       a.R.transpose() * (b.center - a.center));
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
  kernel().box_gaps(block, box.R.data(), box.center.data(), box.half.data(), squared.of);
  return squared;
}

FourGaps squaredBoxGaps(const BoxBlock& block, const BoxBlock& other, int lane,
                        const Eigen::Isometry3d& X) {
  FourGaps squared;
  kernel().moved_box_gaps(block, other, lane, X.data(), squared.of);
  return squared;
}

FourGaps squaredPointGaps(const BoxBlock& block, const Vector3d& point) {
  FourGaps squared;
  kernel().point_gaps(block, point.data(), squared.of);
  return squared;
}

}  // namespace collision_pairs
