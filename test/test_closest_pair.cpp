#include <gtest/gtest.h>

#include "closest_pair.h"
#include "random_inputs.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

Vector3d nearestOf(const Box& box, const Vector3d& p) {
  return p.cwiseMax(-0.5 * box.size).cwiseMin(0.5 * box.size);
}

Vector3d nearestOf(const Cylinder& cylinder, const Vector3d& p) {
  const double off_axis = std::max(p.head<2>().norm() / cylinder.radius, 1.0);
  return {p[0] / off_axis, p[1] / off_axis,
          std::clamp(p[2], -0.5 * cylinder.length, 0.5 * cylinder.length)};
}

/// A cylinder and another solid, a few millimetres to decimetres apart: its rim mostly.
template <class Solid>
void expectNearestToEachOther(const Solid& solid) {
  RandomInputs random;
  NarrowPhase narrow_phase;
  const Cylinder cylinder{0.05, 0.3};
  const auto A = prepareShape(cylinder), B = prepareShape(solid);
  int nb_apart = 0;
  for (int i = 0; i < 2000; ++i) {
    const Isometry3d X_AB = random.pose(0.4);
    const PairDistance found = narrow_phase.distance(*A, *B, X_AB, 10.0);
    if (found.distance < 1e-3) continue;
    ++nb_apart;
    const Vector3d roughly = found.p_ACb + random.vector(-1e-6, 1e-6);
    const ClosestPair closest = closestPairNear(*A, *B, X_AB, roughly, narrow_phase);
    EXPECT_LT((nearestOf(cylinder, closest.p_ACb) - closest.p_ACa).norm(), 2e-15);
    const Vector3d back = X_AB * nearestOf(solid, X_AB.inverse() * closest.p_ACa);
    EXPECT_LT((back - closest.p_ACb).norm(), 3e-16);
    EXPECT_NEAR((closest.p_ACb - closest.p_ACa).norm(), found.distance, 1e-9);
  }
  EXPECT_GT(nb_apart, 500);
}

TEST(ClosestPair, OfACylinderAndABoxAreNearestToEachOther) {
  expectNearestToEachOther(Box{{0.2, 0.15, 0.25}});
}

TEST(ClosestPair, OfTwoCylindersAreNearestToEachOther) {
  expectNearestToEachOther(Cylinder{0.08, 0.2});
}

}  // namespace
}  // namespace collision_pairs
