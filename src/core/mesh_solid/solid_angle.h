// Solid angles of a set of triangles seen from a point.
#pragma once

#include <Eigen/Core>

namespace collision_pairs {

/// Sum of the signed solid angles of triangles seen from a point, as a fraction of the full sphere:
/// over a closed surface that faces outwards it is 1 inside and 0 outside.
/// van Oosterom, Strackee, "The solid angle of a plane triangle" (1983): half the angle is that of
/// a complex number. Deviation: the numbers are multiplied as long as their angles cannot pass half
/// a turn, so that most triangles need no arctangent.
class SolidAngleSum {
 public:
  explicit SolidAngleSum(const Eigen::Vector3d& p) : p_(p) {}
  void add(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);
  double total() const;

 private:
  Eigen::Vector3d p_;
  double settled_ = 0.0;            // radians, sum of half angles
  double real_ = 1.0, imag_ = 0.0;  // the product of the other factors; real_ > 0
  int nb_factors_ = 0;
};

}  // namespace collision_pairs
