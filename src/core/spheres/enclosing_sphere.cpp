#include "enclosing_sphere.h"

#include <cmath>

namespace collision_pairs {
namespace {

using Eigen::Vector3d;

constexpr int ROUNDS = 24;  // points of the core set
constexpr int STEPS = 200;  // on the core set, per round
constexpr double CLOSE_ENOUGH = 1.002;

const Vector3d& furthest(const std::vector<Vector3d>& points, const Vector3d& from) {
  const Vector3d* best = &points.front();
  double most = -1.0;
  for (const Vector3d& p : points) {
    const double squared = (p - from).squaredNorm();
    if (squared > most) most = squared, best = &p;
  }
  return *best;
}

}  // namespace

PlacedSphere enclosingSphere(const std::vector<Vector3d>& points) {
  std::vector<Vector3d> core{points.front(), furthest(points, points.front())};
  PlacedSphere best{core[0], (furthest(points, core[0]) - core[0]).norm()};
  Vector3d center = 0.5 * (core[0] + core[1]);
  for (int round = 0; round < ROUNDS; ++round) {
    for (int step = 1; step <= STEPS && round > 0; ++step) {
      center += (furthest(core, center) - center) / (step + 1.0);
    }
    const Vector3d& outermost = furthest(points, center);
    const double radius = (outermost - center).norm();
    if (radius < best.radius) best = {center, radius};
    if (radius <= CLOSE_ENOUGH * (furthest(core, center) - center).norm()) break;
    core.push_back(outermost);
  }
  return best;
}

}  // namespace collision_pairs
