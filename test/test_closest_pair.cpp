#include <gtest/gtest.h>

#include "closest_pair.h"
#include "random_inputs.h"
#include "test_shapes.h"

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

/// A cylinder and another solid, a few millimetres to `reach` metres apart: its rim mostly.
template <class Solid>
void expectNearestToEachOther(const Solid& solid, double reach) {
  RandomInputs random;
  NarrowPhase narrow_phase;
  const Cylinder cylinder{0.05, 0.3};
  const auto A = prepareShape(cylinder), B = prepareShape(solid);
  int nb_apart = 0;
  for (int i = 0; i < 2000; ++i) {
    const Isometry3d X_AB = random.pose(reach);
    const PairDistance found = narrow_phase.distance(*A, *B, X_AB, 10.0);
    if (found.distance < 1e-3) continue;
    ++nb_apart;
    const Vector3d roughly = found.p_ACb + random.vector(-1e-6, 1e-6);
    const ClosestPair closest = closestPairNear(*A, *B, X_AB, roughly, narrow_phase);
    EXPECT_LT((nearestOf(cylinder, closest.p_ACb) - closest.p_ACa).norm(), 5e-15 * reach);
    const Vector3d back = X_AB * nearestOf(solid, X_AB.inverse() * closest.p_ACa);
    EXPECT_LT((back - closest.p_ACb).norm(), 7.5e-16 * reach);
    EXPECT_NEAR((closest.p_ACb - closest.p_ACa).norm(), found.distance, 1e-9);
  }
  EXPECT_GT(nb_apart, 500);
}

TEST(ClosestPair, OfACylinderAndABoxAreNearestToEachOther) {
  for (const double reach : {0.4, 5.0}) expectNearestToEachOther(Box{{0.2, 0.15, 0.25}}, reach);
}

TEST(ClosestPair, OfTwoCylindersAreNearestToEachOther) {
  for (const double reach : {0.4, 5.0}) expectNearestToEachOther(Cylinder{0.08, 0.2}, reach);
}

TEST(ClosestPair, IsFoundHoweverFarAwayTheHullIs) {
  RandomInputs random;
  NarrowPhase narrow_phase;
  const auto A = prepareShape(Cylinder{0.05, 0.3});
  const auto B = prepareShape(Convex{std::make_shared<TriangleMesh>(boxMesh({0.1, 0.2, 0.3}))});
  for (int i = 0; i < 300; ++i) {
    Isometry3d X_AB = random.pose(5.0);
    X_AB.translation().x() += 8.0;
    const PairDistance found = narrow_phase.distance(*A, *B, X_AB, 30.0);
    const ClosestPair closest = closestPairNear(*A, *B, X_AB, found.p_ACb, narrow_phase);
    EXPECT_LT((closest.p_ACa - found.p_ACa).norm(), 1e-6);
    EXPECT_LT((closest.p_ACb - found.p_ACb).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace collision_pairs
