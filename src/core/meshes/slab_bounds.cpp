#include "slab_bounds.h"

#include <limits>

namespace collision_pairs {
namespace {

constexpr double ROUNDING = 64.0 * std::numeric_limits<double>::epsilon();

double farthestFromFrame(const OrientedBox& box) { return box.center.norm() + box.half.norm(); }

}  // namespace

void SlabBounds::set(const PreparedMesh& A, const PreparedMesh& B, const Eigen::Isometry3d& X_AB,
                     const Eigen::Vector3d& nhat_AB_A) {
  A.tree.reaches(nhat_AB_A, reach_a_);
  B.tree.reaches(-(X_AB.linear().transpose() * nhat_AB_A), reach_b_);
  const double magnitude = farthestFromFrame(A.tree.box(0)) + farthestFromFrame(B.tree.box(0)) +
                           X_AB.translation().norm();
  offset_ = nhat_AB_A.dot(X_AB.translation()) - ROUNDING * magnitude;
}

}  // namespace collision_pairs
