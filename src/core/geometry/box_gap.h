// Oriented boxes, singly and four at a time, and lower bounds of their distance.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry_kernel.h"

namespace collision_pairs {

/// A box with its own axes: centre and axes (the columns of R) in the frame of its owner.
struct OrientedBox {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Vector3d half = Eigen::Vector3d::Zero();

  double size() const { return half.maxCoeff(); }
  OrientedBox movedBy(const Eigen::Isometry3d& X) const {
    return {X.linear() * R, X * center, half};
  }
};

/// Square of a lower bound of the distance of two boxes along the axes of A and B: the larger of
/// the distances between each box and the other's enclosing box along its axes. Parameters: their
/// half sizes, and B's axes and centre relative to A's box. 0 does not mean that they overlap.
/// Cost: about 15 ns.
inline double squaredBoxGap(const Eigen::Vector3d& half_a, const Eigen::Vector3d& half_b,
                            const Eigen::Matrix3d& R_AB, const Eigen::Vector3d& p_AB) {
  const auto squaredExcess = [](const Eigen::Vector3d& apart, const Eigen::Vector3d& reach) {
    return (apart.cwiseAbs() - reach).cwiseMax(0.0).squaredNorm();
  };
  const Eigen::Matrix3d reach = R_AB.cwiseAbs();
  const double along_a = squaredExcess(p_AB, half_a + reach * half_b);
  const double along_b =
      squaredExcess(R_AB.transpose() * p_AB, half_b + reach.transpose() * half_a);
  return along_a > along_b ? along_a : along_b;
}
/// The same for two boxes in one frame. Cost: about 20 ns.
double squaredBoxGap(const OrientedBox& a, const OrientedBox& b);

/// Access to the single lanes of a block.
OrientedBox boxInLane(const BoxBlock& block, int lane);
void setLane(const OrientedBox& box, int lane, BoxBlock& block);

/// One number for each box of a block; any number for lanes that hold no box.
struct alignas(BOX_LANES * sizeof(double)) FourGaps {
  double of[BOX_LANES];
};

/// squaredBoxGap() of each box of the block and `box`. Cost: about 11 ns for all four with AVX2,
/// which is chosen at run time.
FourGaps squaredBoxGaps(const BoxBlock& block, const OrientedBox& box);
/// The same for the box in a lane of another block, moved by X. Cost: 5 ns more.
FourGaps squaredBoxGaps(const BoxBlock& block, const BoxBlock& other, int lane,
                        const Eigen::Isometry3d& X);
/// The squared distances of a point from the boxes.
FourGaps squaredPointGaps(const BoxBlock& block, const Eigen::Vector3d& point);

}  // namespace collision_pairs
