#include "solid_angle.h"

#include <cmath>

#include <Eigen/Geometry>

namespace collision_pairs {
namespace {

constexpr double TWO_PI = 6.283185307179586;
constexpr int MAX_FACTORS = 16;  // each is at most 4, so no overflow

}  // namespace

void SolidAngleSum::add(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                        const Eigen::Vector3d& c) {
  const Eigen::Vector3d x = a - p_, y = b - p_, z = c - p_;
  const double nx = x.norm(), ny = y.norm(), nz = z.norm(), scale = nx * ny * nz;
  if (!(scale > 0.0)) return;  // undefined at a corner
  const double real = 1.0 + (x.dot(y) * nz + y.dot(z) * nx + z.dot(x) * ny) / scale;
  const double imag = x.dot(y.cross(z)) / scale;
  if (!(real > 0.0)) {
    settled_ += std::atan2(imag, real);
    return;
  }
  // Two angles below a quarter turn: their sum is the angle of the product.
  const double product = real_ * real - imag_ * imag;
  imag_ = real_ * imag + imag_ * real;
  real_ = product;
  if (real_ > 0.0 && ++nb_factors_ < MAX_FACTORS) return;
  settled_ += std::atan2(imag_, real_);
  real_ = 1.0;
  imag_ = 0.0;
  nb_factors_ = 0;
}

double SolidAngleSum::total() const { return (settled_ + std::atan2(imag_, real_)) / TWO_PI; }

}  // namespace collision_pairs
