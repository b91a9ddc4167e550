// What is done with a rotation that is not quite one: in a description, and by a query.
#pragma once

#include <cmath>

#include <Eigen/Geometry>

namespace collision_pairs {

/// For robots and objects: whether R is a rotation, but for a client's rounding.
inline bool isRotation(const Eigen::Matrix3d& R) {
  constexpr double ROUNDING = 1e-6;  // largest entry of R^T R - I
  const Eigen::Matrix3d excess = R.transpose() * R - Eigen::Matrix3d::Identity();
  return excess.cwiseAbs().maxCoeff() <= ROUNDING && R.determinant() > 0.0;
}

/// The same with a place.
inline bool isPose(const Eigen::Isometry3d& X) {
  return X.matrix().allFinite() && isRotation(X.linear());
}

constexpr double ORTHONORMAL = 1e-14;  // rotations better than this are used as they are
constexpr double MENDABLE = 1e-3;      // rotations worse than this are refused

/// Whether repairPose() would leave X as it is: most are, and this is quicker.
inline bool isSound(const Eigen::Isometry3d& X) {
  const Eigen::Vector3d x = X.linear().col(0), y = X.linear().col(1), z = X.linear().col(2);
  const auto isZero = [](double error) { return std::abs(error) <= ORTHONORMAL; };
  return isZero(x.squaredNorm() - 1.0) && isZero(y.squaredNorm() - 1.0) &&
         isZero(z.squaredNorm() - 1.0) && isZero(x.dot(y)) && isZero(y.dot(z)) &&
         isZero(z.dot(x)) && x.cross(y).dot(z) > 0.0 && X.translation().allFinite();
}

/// False if X has no meaning as a pose. A step of Newton's iteration for the polar decomposition
/// squares the error each time.
inline bool repairPose(Eigen::Isometry3d& X) {
  if (isSound(X)) return true;
  if (!X.matrix().allFinite()) return false;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Matrix3d excess =
        X.linear().transpose() * X.linear() - Eigen::Matrix3d::Identity();
    const double error = excess.cwiseAbs().maxCoeff();
    if (error > MENDABLE) return false;
    if (error <= ORTHONORMAL) break;
    X.linear() = X.linear() * (Eigen::Matrix3d::Identity() - 0.5 * excess);
  }
  return X.linear().determinant() > 0.0;
}

}  // namespace collision_pairs
