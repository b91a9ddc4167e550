// Sizes, offsets, gaps and shapes at the ends of what doubles can hold. Errors are relative to the
// size of the shapes or, where that is larger, to the last place of the coordinates given.
#include <gtest/gtest.h>

#include "random_inputs.h"
#include "signed_distance_oracle.h"
#include "test_shapes.h"

namespace collision_pairs::test_narrow_phase_extremes {

using Eigen::Isometry3d;
using Eigen::Vector3d;
constexpr double INF = std::numeric_limits<double>::infinity();

PairDistance distanceOf(const Shape& a, const Shape& b, const Isometry3d& X_AB) {
  NarrowPhase narrow_phase;
  const PairDistance result = narrow_phase.distance(*prepareShape(a), *prepareShape(b), X_AB, INF);
  EXPECT_NEAR(result.nhat_AB_A.norm(), 1.0, 1e-12);
  EXPECT_TRUE(result.p_ACa.allFinite() && result.p_ACb.allFinite());
  return result;
}

Isometry3d at(double x, double y, double z) {
  Isometry3d X = Isometry3d::Identity();
  X.translation() = Vector3d(x, y, z);
  return X;
}

std::vector<Shape> shapesOfSize(double size) {
  auto hull = std::make_shared<TriangleMesh>(bumpyBall(5, 0.5 * size));
  return {Box{{size, 0.5 * size, 0.7 * size}}, Sphere{0.5 * size}, Cylinder{0.3 * size, size},
          Capsule{0.3 * size, 0.5 * size}, Convex{hull}};
}

void holdTruth(const Shape& a, const Shape& b, const Isometry3d& X_AB, double tolerance) {
  const PairDistance result = distanceOf(a, b, X_AB);
  const AnswerError error = judge(oracleBody(a), oracleBody(b), X_AB, result, tolerance);
  ASSERT_FALSE(error.wrong_verdict);
  // A bound of the depth is all that is promised where the interval did not close.
  if (result.certainty == Certainty::EXACT) {
    ASSERT_LE(error.distance, tolerance);
  }
  ASSERT_LE(error.normal, tolerance);
}

TEST(Extremes, SizesFromAMicrometreToAThousandKilometres) {
  RandomInputs random;
  for (double size = 1e-6; size < 2e6; size *= 100.0) {
    for (const Shape& a : shapesOfSize(size)) {
      for (const Shape& b : shapesOfSize(size)) {
        SCOPED_TRACE(std::string(shapeName(a)) + "-" + shapeName(b) + " " + std::to_string(size));
        for (int i = 0; i < 4; ++i) holdTruth(a, b, random.pose(1.2 * size), 1e-6 * size);
      }
    }
  }
}

TEST(Extremes, OffsetsToAHundredThousandKilometres) {
  for (double offset = 1.0; offset < 2e8; offset *= 100.0) {
    for (const Shape& a : shapesOfSize(0.2)) {
      for (const Shape& b : shapesOfSize(0.2)) {
        SCOPED_TRACE(std::string(shapeName(a)) + "-" + shapeName(b) + " " + std::to_string(offset));
        holdTruth(a, b, at(offset, 0.3 * offset, 0.0), 1e-14 * offset + 1e-10);
      }
    }
  }
}

TEST(Extremes, GapsFromAFewFemtometresUpwardsAreSeen) {
  for (double gap = 0x1p-48; gap < 1.0; gap *= 8.0) {
    const Isometry3d X_AB = at(1.0 + gap, 0.0, 0.0);  // exact, and so is the gap
    EXPECT_NEAR(distanceOf(Sphere{0.5}, Sphere{0.5}, X_AB).distance, gap, 1e-16);
    EXPECT_NEAR(distanceOf(Box{{1, 1, 1}}, Sphere{0.5}, X_AB).distance, gap, 1e-16);
    EXPECT_NEAR(distanceOf(Box{{1, 1, 1}}, Box{{1, 1, 1}}, X_AB).distance, gap, 1e-14);
    EXPECT_NEAR(distanceOf(Cylinder{0.5, 1.0}, Cylinder{0.5, 1.0}, X_AB).distance, gap, 1e-9);
    EXPECT_NEAR(distanceOf(Capsule{0.5, 1.0}, Capsule{0.5, 1.0}, X_AB).distance, gap, 1e-16);
  }
  // Of bodies of very different sizes, too.
  EXPECT_EQ(distanceOf(Box{{2.0, 2.0, 2.0}}, Sphere{0x1p-20}, at(1.0 + 0x1p-19, 0, 0)).distance,
            0x1p-20);
}

TEST(Extremes, ExactTouchIsATouchWithARealNormal) {
  for (const double size : {1e-6, 1.0, 1e6}) {
    const Shape mesh =
        meshShape(joined(boxMesh(Vector3d::Constant(0.5 * size)),
                         movedBy(boxMesh(Vector3d::Constant(0.1 * size)), {0.0, 0.0, 2.0 * size})));
    const std::vector<Shape> shapes{Box{{size, size, size}}, Sphere{0.5 * size},
                                    Capsule{0.5 * size, size}, Cylinder{0.5 * size, size}, mesh};
    for (const Shape& a : shapes) {
      for (const Shape& b : shapes) {
        SCOPED_TRACE(std::string(shapeName(a)) + "-" + shapeName(b));
        const PairDistance result = distanceOf(a, b, at(size, 0.0, 0.0));
        EXPECT_NEAR(result.distance, 0.0, 1e-12 * size);
        EXPECT_NEAR(result.nhat_AB_A[0], 1.0, 1e-6);
      }
    }
  }
}

TEST(Extremes, AspectRatiosToAMillion) {
  RandomInputs random;
  for (const double thin : {1e-2, 1e-4, 1e-6}) {
    const std::vector<Shape> shapes{Box{{1.0, thin, 1.0}}, Box{{thin, thin, 1.0}},
                                    Cylinder{thin, 1.0}, Cylinder{0.5, thin}, Capsule{thin, 1.0}};
    for (const Shape& a : shapes) {
      for (const Shape& b : shapes) {
        SCOPED_TRACE(std::string(shapeName(a)) + "-" + shapeName(b) + " " + std::to_string(thin));
        for (int i = 0; i < 10; ++i) holdTruth(a, b, random.pose(0.5), 1e-6);
      }
    }
  }
}

TEST(Extremes, ShapesWithoutThicknessHaveDistancesAndTouch) {
  const Shape plate = Box{{1.0, 1.0, 0.0}}, rod = Box{{0.0, 0.0, 1.0}}, point = Box{{0, 0, 0}},
              disc = Cylinder{0.5, 0.0}, line = Cylinder{0.0, 1.0}, dot = Sphere{0.0};
  for (const Shape& flat : {plate, rod, point, disc, line, dot}) {
    for (const Shape& other : {plate, rod, point, disc, line, dot}) {
      SCOPED_TRACE(std::string(shapeName(flat)) + "-" + shapeName(other));
      EXPECT_NEAR(distanceOf(flat, other, at(3.0, 0.0, 0.0)).distance,
                  3.0 - (distanceOf(flat, dot, at(9.0, 0.0, 0.0)).distance - 9.0) * -1.0 -
                      (distanceOf(other, dot, at(9.0, 0.0, 0.0)).distance - 9.0) * -1.0,
                  1e-9);
      EXPECT_TRUE(distanceOf(flat, other, at(0.0, 0.0, 0.0)).touches());
      const auto A = prepareShape(flat), B = prepareShape(other);
      EXPECT_TRUE(NarrowPhase().touches(*A, *B, at(0.0, 0.0, 0.0)));
    }
  }
}

TEST(Extremes, ABodyUponItselfHasADepthThatSeparates) {
  NarrowPhase narrow_phase;
  for (const Shape& shape : shapesOfSize(0.2)) {
    const auto A = prepareShape(shape);
    const PairDistance result = narrow_phase.distance(*A, *A, Isometry3d::Identity(), INF);
    EXPECT_LT(result.distance, -0.09) << shapeName(shape);
    Isometry3d X = Isometry3d::Identity();
    X.translation() = (1e-9 - result.distance) * result.nhat_AB_A;
    EXPECT_FALSE(narrow_phase.touches(*A, *A, X)) << shapeName(shape);
  }
}

TEST(Extremes, TheSmallestRotationsOfParallelBodies) {
  for (double angle = 1e-16; angle < 1e-2; angle *= 10.0) {
    for (const Vector3d& axis : {Vector3d(0, 0, 1), Vector3d(1, 1, 1).normalized()}) {
      for (const Shape& a : shapesOfSize(0.2)) {
        for (const double x : {0.1, 0.2, 0.25}) {
          SCOPED_TRACE(std::string(shapeName(a)) + " " + std::to_string(angle));
          Isometry3d X_AB = at(x, 0.0, 0.01);
          X_AB.linear() = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
          holdTruth(a, a, X_AB, 1e-7);
        }
      }
    }
  }
}

TEST(Extremes, AMeshOfOneTriangleAndOneWithoutAreaAreSurfaces) {
  TriangleMesh triangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, ""};
  TriangleMesh needle{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}, ""};
  EXPECT_NEAR(distanceOf(meshShape(triangle), Sphere{0.5}, at(0.2, 0.2, 1.0)).distance, 0.5, 1e-15);
  EXPECT_NEAR(distanceOf(meshShape(needle), Sphere{0.5}, at(1.5, 1.0, 0.0)).distance, 0.5, 1e-15);
  EXPECT_NEAR(distanceOf(meshShape(needle), meshShape(triangle), at(0, 0, 1)).distance, 1.0, 1e-15);
  EXPECT_TRUE(distanceOf(meshShape(needle), meshShape(triangle), at(1, 0, 0)).touches());
  EXPECT_TRUE(distanceOf(meshShape(triangle), Box{{1, 1, 1}}, at(0, 0, 0.4)).touches());
  EXPECT_FALSE(distanceOf(meshShape(needle), meshShape(needle), at(0, 1e-3, 0)).touches());
}

TEST(Extremes, AMeshOfAMillionTriangles) {
  NarrowPhase narrow_phase;
  const TriangleMesh ball = bumpyBall(708, 1.0);
  const auto large = prepareShape(meshShape(ball));
  const auto box = prepareShape(Box{{0.2, 0.2, 0.2}});
  double to_vertex = INF;
  for (const Vector3d& v : ball.vertices) {
    const Vector3d beyond = (v - Vector3d(0.0, 0.0, 1.6)).cwiseAbs().array() - 0.1;
    to_vertex = std::min(to_vertex, beyond.cwiseMax(0.0).norm());
  }
  const double distance = narrow_phase.distance(*large, *box, at(0.0, 0.0, 1.6), INF).distance;
  EXPECT_LE(distance, to_vertex + 1e-15);
  EXPECT_GE(distance, to_vertex - 1e-4);  // triangles are 5 mm long and as good as flat
  EXPECT_TRUE(narrow_phase.touches(*large, *box, at(0.0, 0.1, 0.2)));
  EXPECT_TRUE(narrow_phase.touches(*large, *large, at(1.0, 0.0, 0.0)));
  EXPECT_FALSE(narrow_phase.touches(*large, *large, at(2.5, 0.0, 0.0)));
}

}  // namespace collision_pairs::test_narrow_phase_extremes
