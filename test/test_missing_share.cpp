// How much of a mesh that is not closed is missing: what tools and node say of it.
#include <gtest/gtest.h>

#include "mesh_solid.h"
#include "mesh_variants.h"
#include "winding_number.h"

namespace collision_pairs::test_missing_share {

using Eigen::Vector3d;

TEST(MissingShare, IsThatOfTheFacesThatABoxLacks) {
  RandomInputs random;
  for (int round = 0; round < 100; ++round) {
    const Vector3d half = random.vector(1.0, 2.0);  // no face is so small that it need not be there
    const int axis = random.integer(0, 2);
    const double face = 1.0 / half[axis] / (2.0 * half.cwiseInverse().sum());  // of the surface
    TriangleMesh box = boxMesh(half);
    for (int lacking = 0; lacking <= 2; ++lacking) {
      const double side = lacking == 1 ? 1.0 : -1.0;
      if (lacking > 0) box = without(box, [&](const Vector3d& v) { return v[axis] * side > 0.0; });
      for (const TriangleMesh& variant : {box, insideOut(box), asSoup(box, random)}) {
        EXPECT_NEAR(findSolid(movedBy(variant, random.vector(-5.0, 5.0))).missing_share,
                    lacking * face, 1e-12)
            << "round " << round;
      }
    }
  }
}

TEST(MissingShare, IsNoneForInternalWallsAndSheetsThatFaceBothWays) {
  TriangleMesh walled = boxMesh({1, 2, 3});
  walled.triangles.push_back({0, 3, 7});  // across the inside
  EXPECT_EQ(findSolid(walled).missing_share, 0.0);
  TriangleMesh sheet;
  sheet.vertices = {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}};
  sheet.triangles = {{0, 1, 2}};
  EXPECT_NEAR(findSolid(sheet).missing_share, 0.5, 1e-12);
  sheet.triangles.push_back({1, 0, 2});
  EXPECT_EQ(findSolid(sheet).missing_share, 0.0);
}

TEST(MissingShare, IsToldOfEveryBallWithAHoleThatDoesNotHoldItsCentre) {
  int open = 0;
  for (int rings = 20; rings <= 40; ++rings) {
    const TriangleMesh ball = rings == 40 ? bumpyBall(40, 1.0) : ballWithoutItsTop(rings);
    const MeshSolid solid = findSolid(ball);
    const bool holds_centre = WindingNumber(ball.vertices, solid.outward).holds({0.0, 0.1, 0.2});
    EXPECT_EQ(holds_centre, solid.missing_share == 0.0) << rings;
    EXPECT_TRUE(holds_centre || solid.missing_share > 0.01) << solid.missing_share;
    open += !holds_centre;
  }
  EXPECT_GT(open, 10);
  EXPECT_LT(open, 20);
}

}  // namespace collision_pairs::test_missing_share
