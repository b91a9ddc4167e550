// Random numbers for tests. The seed is fixed unless COLLISION_PAIRS_SEED is set (scripts/test
// --seed), and printed.
#pragma once

#include <cstdlib>
#include <iostream>
#include <random>

#include <Eigen/Geometry>

namespace collision_pairs {

inline unsigned givenSeed() {
  const char* given = std::getenv("COLLISION_PAIRS_SEED");
  const unsigned seed = given ? static_cast<unsigned>(std::strtoul(given, nullptr, 10)) : 20240611;
  std::cout << "seed " << seed << " (COLLISION_PAIRS_SEED=" << seed << " repeats this run)\n";
  return seed;
}

class RandomInputs {
 public:
  RandomInputs() : RandomInputs(givenSeed()) {}
  /// Of one case of many, which can be repeated alone.
  explicit RandomInputs(unsigned seed) : engine_(seed) {}

  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  int integer(int low, int high) { return std::uniform_int_distribution<int>(low, high)(engine_); }
  Eigen::Vector3d vector(double low, double high) {
    return {uniform(low, high), uniform(low, high), uniform(low, high)};
  }
  /// Evenly distributed over all rotations.
  Eigen::Quaterniond rotation() {
    std::normal_distribution<double> normal;
    Eigen::Quaterniond q;  // one by one: compilers evaluate arguments in different orders
    for (const int i : {2, 1, 0, 3}) q.coeffs()[i] = normal(engine_);
    return q.normalized();
  }
  Eigen::Isometry3d pose(double reach) {
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    X.linear() = rotation().toRotationMatrix();
    X.translation() = vector(-reach, reach);
    return X;
  }
  std::mt19937& engine() { return engine_; }

 private:
  std::mt19937 engine_;
};

}  // namespace collision_pairs
