#include <gtest/gtest.h>

#include "closed_forms.h"
#include "collision_pairs/narrow_phase.h"
#include "random_inputs.h"

namespace collision_pairs::test_closed_forms {

constexpr double INF = std::numeric_limits<double>::infinity();

PairDistance distanceOf(const Shape& a, const Shape& b, const Eigen::Isometry3d& X_AB) {
  NarrowPhase narrow_phase;
  return narrow_phase.distance(*prepareShape(a), *prepareShape(b), X_AB, INF);
}

Eigen::Isometry3d at(double x, double y, double z) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = Eigen::Vector3d(x, y, z);
  return X;
}

TEST(ClosedForms, SpheresThatTouchExactlyHaveANormal) {
  const PairDistance result = distanceOf(Sphere{0.25}, Sphere{0.5}, at(0.0, 0.75, 0.0));
  EXPECT_EQ(result.distance, 0.0);
  EXPECT_TRUE(result.touches());
  EXPECT_EQ(result.nhat_AB_A, Eigen::Vector3d(0.0, 1.0, 0.0));
}

// Also where the square of the distance is no number.
TEST(ClosedForms, PointsHaveTheirDirectionHoweverNearOrFar) {
  RandomInputs random;
  for (const double length : {1e-300, 1e-170, 1e-99, 1e-3, 1.0, 1e3, 1e99, 1e170}) {
    const Eigen::Vector3d n = random.rotation() * Eigen::Vector3d::UnitX(), p = length * n;
    const PairDistance result = distanceOf(Sphere{0.0}, Sphere{0.0}, at(p[0], p[1], p[2]));
    EXPECT_NEAR(result.distance / length, 1.0, 1e-14) << length;
    EXPECT_LE((result.nhat_AB_A - n).norm(), 1e-14) << length;
  }
}

TEST(ClosedForms, ConcentricSpheresSeparateByBothRadii) {
  const PairDistance result = distanceOf(Sphere{0.25}, Sphere{0.5}, at(0.0, 0.0, 0.0));
  EXPECT_EQ(result.distance, -0.75);
  EXPECT_EQ(result.nhat_AB_A.norm(), 1.0);
}

TEST(ClosedForms, SphereOnABoxCornerIsMeasuredFromTheCorner) {
  const PairDistance result = distanceOf(Box{{2.0, 2.0, 2.0}}, Sphere{0.5}, at(4.0, 5.0, 1.0));
  EXPECT_DOUBLE_EQ(result.distance, 4.5);
  EXPECT_EQ(result.p_ACa, Eigen::Vector3d(1.0, 1.0, 1.0));
}

TEST(ClosedForms, SphereInABoxLeavesByTheNearestFace) {
  const PairDistance result = distanceOf(Box{{2.0, 4.0, 6.0}}, Sphere{0.1}, at(-0.7, 0.2, 0.3));
  EXPECT_DOUBLE_EQ(result.distance, -0.4);
  EXPECT_EQ(result.nhat_AB_A, Eigen::Vector3d(-1.0, 0.0, 0.0));
}

TEST(ClosedForms, SphereOverACylindersRimIsMeasuredFromTheRim) {
  const PairDistance result = distanceOf(Cylinder{1.0, 2.0}, Sphere{0.5}, at(0.0, 4.0, 5.0));
  EXPECT_DOUBLE_EQ(result.distance, 4.5);
}

TEST(ClosedForms, CrossedCapsulesHaveTheNormalAcrossBothAxes) {
  Eigen::Isometry3d X_AB = Eigen::Isometry3d::Identity();
  X_AB.linear() = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const PairDistance result = distanceOf(Capsule{0.1, 1.0}, Capsule{0.2, 1.0}, X_AB);
  EXPECT_NEAR(result.distance, -0.3, 1e-16);
  EXPECT_NEAR(std::abs(result.nhat_AB_A[0]), 1.0, 1e-15);
}

TEST(ClosedForms, CapsulesThatCrossBeyondTheirEndsAreMeasuredFromTheEnds) {
  Eigen::Isometry3d X_AB = Eigen::Isometry3d::Identity();
  X_AB.linear() = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX()).toRotationMatrix();
  for (const double y : {-2.0, 0.0, 2.0}) {  // B lies along y, a metre beside A, which lies along z
    for (const double z : {-2.0, 0.0, 2.0}) {
      X_AB.translation() = Eigen::Vector3d(1.0, y, z);
      const double beyond_a = z == 0.0 ? 0.0 : 1.5, beyond_b = y == 0.0 ? 0.0 : 1.5;
      const PairDistance result = distanceOf(Capsule{0.1, 1.0}, Capsule{0.2, 1.0}, X_AB);
      EXPECT_NEAR(result.distance, Eigen::Vector3d(1.0, beyond_b, beyond_a).norm() - 0.3, 1e-15);
    }
  }
}

TEST(ClosedForms, BoxesThatOverlapTouchWhateverRoundingLeavesInTheRotation) {
  NarrowPhase narrow_phase;
  const auto small = prepareShape(Box{{0.2, 0.2, 0.2}}), large = prepareShape(Box{{2.0, 2.0, 2.0}});
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      Eigen::Isometry3d X_AB = at(0.9, 0.9, 0.9);
      if (row != column) X_AB.linear()(row, column) = 1e-16;
      EXPECT_TRUE(narrow_phase.touches(*small, *large, X_AB)) << row << column;
      X_AB.translation() *= -1.0;
      EXPECT_TRUE(narrow_phase.touches(*small, *large, X_AB)) << row << column;
    }
  }
}

TEST(ClosedForms, ParallelAndOverlappingCapsulesAgree) {
  EXPECT_DOUBLE_EQ(distanceOf(Capsule{0.1, 1.0}, Capsule{0.2, 1.0}, at(0.5, 0.0, 0.3)).distance,
                   0.2);
  const PairDistance same = distanceOf(Capsule{0.1, 1.0}, Capsule{0.1, 1.0}, at(0.0, 0.0, 0.0));
  EXPECT_DOUBLE_EQ(same.distance, -0.2);
  EXPECT_DOUBLE_EQ(same.nhat_AB_A.norm(), 1.0);
}

TEST(ClosedForms, EveryShapeStandsOnTheFloorByItsLowestPoint) {
  const PairDistance box = distanceOf(HalfSpace{}, Box{{1.0, 1.0, 1.0}}, at(3.0, 4.0, 0.75));
  EXPECT_EQ(box.distance, 0.25);
  EXPECT_EQ(box.nhat_AB_A, Eigen::Vector3d(0.0, 0.0, 1.0));
  EXPECT_EQ(distanceOf(HalfSpace{}, Sphere{1.0}, at(0.0, 0.0, 1.0)).distance, 0.0);
  EXPECT_EQ(distanceOf(HalfSpace{}, Cylinder{1.0, 1.0}, at(0.0, 0.0, 0.25)).distance, -0.25);
  EXPECT_EQ(distanceOf(Capsule{1.0, 1.0}, HalfSpace{}, at(0.0, 0.0, -2.0)).distance, 0.5);
}

TEST(ClosedForms, HalfSpacesMeetUnlessTheyFaceEachOther) {
  Eigen::Isometry3d X_AB = at(0.0, 0.0, 2.0);
  EXPECT_TRUE(distanceOf(HalfSpace{}, HalfSpace{}, X_AB).touches());
  X_AB.linear() = Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
  EXPECT_EQ(distanceOf(HalfSpace{}, HalfSpace{}, X_AB).distance, 2.0);
}

}  // namespace collision_pairs::test_closed_forms
