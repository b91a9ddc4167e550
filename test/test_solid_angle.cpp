#include <gtest/gtest.h>

#include "random_inputs.h"
#include "solid_angle.h"
#include "test_shapes.h"

namespace collision_pairs::test_solid_angle {

using Eigen::Vector3d;
using Corners = std::array<Vector3d, 3>;

double angleOfOne(const Vector3d& p, const Corners& t) {
  SolidAngleSum sum(p);
  sum.add(t[0], t[1], t[2]);
  return sum.total();
}

TEST(SolidAngle, OfAnOctantIsAnEighthAndOfItsBackMinusThat) {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  EXPECT_NEAR(angleOfOne(Vector3d::Zero(), {x, y, z}), 0.125, 1e-15);
  EXPECT_NEAR(angleOfOne(Vector3d::Zero(), {x, z, y}), -0.125, 1e-15);
}

TEST(SolidAngle, OfManyTrianglesIsTheSumOfEach) {
  RandomInputs random;
  for (int round = 0; round < 300; ++round) {
    const double scale = std::pow(10.0, random.uniform(-6.0, 6.0));
    const Vector3d p = scale * random.vector(-0.3, 0.3);
    SolidAngleSum all(p);
    double expected = 0.0;
    for (int i = 0; i < 60; ++i) {
      Corners t;
      for (Vector3d& v : t) v = scale * random.vector(-1.0, 1.0);
      all.add(t[0], t[1], t[2]);
      expected += angleOfOne(p, t);
    }
    ASSERT_NEAR(all.total(), expected, 1e-13);
  }
}

TEST(SolidAngle, OfPartsIsThatOfTheWhole) {
  RandomInputs random;
  for (int round = 0; round < 1000; ++round) {
    const Vector3d p = random.vector(-0.3, 0.3);
    Corners t;
    for (Vector3d& v : t) v = random.vector(-1.0, 1.0);
    const Vector3d middle = (t[0] + t[1] + t[2]) / 3.0;
    SolidAngleSum parts(p);
    for (int k = 0; k < 3; ++k) parts.add(t[k], t[(k + 1) % 3], middle);
    ASSERT_NEAR(parts.total(), angleOfOne(p, t), 1e-13);
  }
}

TEST(SolidAngle, OfAClosedSurfaceIsOneInsideAndNothingOutside) {
  RandomInputs random;
  const TriangleMesh box = boxMesh(Vector3d(0.1, 0.2, 0.3));
  for (int round = 0; round < 1000; ++round) {
    const Vector3d p = random.vector(-0.4, 0.4);
    const bool inside = (p.cwiseAbs() - Vector3d(0.1, 0.2, 0.3)).maxCoeff() < 0.0;
    SolidAngleSum sum(p);
    for (const auto& t : box.triangles) {
      sum.add(box.vertices[t[0]], box.vertices[t[1]], box.vertices[t[2]]);
    }
    ASSERT_NEAR(sum.total(), inside ? 1.0 : 0.0, 1e-13);
  }
}

TEST(SolidAngle, SeenFromACornerIsNothingAndSpoilsNothing) {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  SolidAngleSum sum(Vector3d::Zero());
  sum.add(Vector3d::Zero(), x, y);
  sum.add(x, y, z);
  EXPECT_NEAR(sum.total(), 0.125, 1e-15);
}

}  // namespace collision_pairs::test_solid_angle
