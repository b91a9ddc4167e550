#include "vertex_extent.h"

#include <limits>

// One binary for all x86-64: the loop is compiled twice and the processor picks. Elsewhere (arm64)
// the compiler's generic vectors are what there is.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__SANITIZE_ADDRESS__)
#define COLLISION_PAIRS_TARGETS __attribute__((target_clones("arch=haswell", "default")))
#else
#define COLLISION_PAIRS_TARGETS
#endif

namespace collision_pairs {
namespace {

typedef double Lanes __attribute__((vector_size(PackedPoints::LANES * sizeof(double))));

}  // namespace

PackedPoints::PackedPoints(const std::vector<Eigen::Vector3d>& points)
    : blocks_((points.size() + LANES - 1) / LANES) {
  for (std::size_t i = 0; i < blocks_.size() * LANES; ++i) {
    const Eigen::Vector3d& point = points[std::min(i, points.size() - 1)];
    for (int axis = 0; axis < 3; ++axis) blocks_[i / LANES].xyz[axis][i % LANES] = point[axis];
  }
}

void PackedPoints::extent(const Eigen::Matrix3d& R, Eigen::Vector3d& lower,
                          Eigen::Vector3d& upper) const {
  extentOf(blocks_.data(), blocks_.size(), R.data(), lower.data(), upper.data());
}

COLLISION_PAIRS_TARGETS
void PackedPoints::extentOf(const Block* blocks, std::size_t count, const double* R, double* lower,
                            double* upper) {
  const double infinity = std::numeric_limits<double>::infinity();
  Lanes low[3], high[3];
  for (int row = 0; row < 3; ++row) {
    low[row] = Lanes{} + infinity;
    high[row] = Lanes{} - infinity;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Lanes x = *reinterpret_cast<const Lanes*>(blocks[i].xyz[0]);
    const Lanes y = *reinterpret_cast<const Lanes*>(blocks[i].xyz[1]);
    const Lanes z = *reinterpret_cast<const Lanes*>(blocks[i].xyz[2]);
    for (int row = 0; row < 3; ++row) {  // R is column-major
      const Lanes along = R[row] * x + R[row + 3] * y + R[row + 6] * z;
      low[row] = along < low[row] ? along : low[row];
      high[row] = along > high[row] ? along : high[row];
    }
  }
  for (int row = 0; row < 3; ++row) {
    lower[row] = low[row][0];
    upper[row] = high[row][0];
    for (std::size_t lane = 1; lane < LANES; ++lane) {
      if (low[row][lane] < lower[row]) lower[row] = low[row][lane];
      if (high[row][lane] > upper[row]) upper[row] = high[row][lane];
    }
  }
}

}  // namespace collision_pairs
