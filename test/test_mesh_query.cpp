#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "demo_scene.h"
#include "mesh_query.h"
#include "prepared_shape.h"
#include "random_inputs.h"
#include "signed_distance_oracle.h"
#include "surface_contact.h"
#include "test_shapes.h"

namespace collision_pairs::test_mesh_query {

using Eigen::Isometry3d;
using Eigen::Vector3d;
constexpr double INF = std::numeric_limits<double>::infinity();

Isometry3d at(double x, double y, double z) {
  Isometry3d X = Isometry3d::Identity();
  X.translation() = Vector3d(x, y, z);
  return X;
}

bool touch(const Shape& a, const Shape& b, const Isometry3d& X_AB) {
  NarrowPhase narrow_phase;
  const auto A = prepareShape(a), B = prepareShape(b);
  const bool answer = narrow_phase.touches(*A, *B, X_AB);
  EXPECT_EQ(narrow_phase.touches(*B, *A, X_AB.inverse()), answer);
  EXPECT_EQ(narrow_phase.distance(*A, *B, X_AB, INF).touches(), answer);
  EXPECT_EQ(narrow_phase.distance(*A, *B, X_AB, 0.0).touches(), answer);
  return answer;
}

TEST(MeshQuery, AnOpenSheetHoldsNothingAndATornSeamDoes) {
  TriangleMesh bowl = boxMesh({1, 1, 1}), torn = bumpyBall(40, 1.0);
  bowl.triangles.resize(10);
  torn.triangles.erase(torn.triangles.begin() + 700);
  EXPECT_FALSE(touch(meshShape(bowl), Sphere{0.1}, at(-0.5, 0.0, 0.0)));
  EXPECT_TRUE(touch(meshShape(torn), meshShape(LShape().mesh()), at(0.0, 0.0, 0.0)));
}

TEST(MeshQuery, AMeshInsideAnotherIsAContactEitherWay) {
  const Shape outer = meshShape(bumpyBall(16, 1.0)), inner = meshShape(LShape().mesh());
  EXPECT_TRUE(touch(outer, inner, at(0.1, 0.0, 0.0)));
  EXPECT_TRUE(touch(inner, outer, at(0.1, 0.0, 0.0)));
  EXPECT_FALSE(touch(outer, inner, at(2.0, 0.0, 0.0)));
}

TEST(MeshQuery, APartOfAMeshInsideAnotherIsAContact) {
  const Shape outer = meshShape(bumpyBall(16, 1.0));
  const Shape two =
      meshShape(joined(movedBy(boxMesh({0.1, 0.1, 0.1}), {9, 0, 0}), boxMesh({0.1, 0.1, 0.1})));
  EXPECT_TRUE(touch(outer, two, at(0.0, 0.0, 0.0)));
  EXPECT_TRUE(touch(outer, two, at(-9.0, 0.0, 0.0)));
  EXPECT_FALSE(touch(outer, two, at(-4.5, 0.0, 0.0)));
}

/// A ball of 1 m with 99 fins, each joined to it along an edge of four triangles, and two triangles
/// within that oppose each other: 2,022 triangles.
TriangleMesh ballWithFins() {
  TriangleMesh ball = bumpyBall(29, 1.0);
  for (std::size_t i = 0; i < 99; ++i) {
    const auto a = ball.triangles[16 * i][0], b = ball.triangles[16 * i][1];
    const auto n = static_cast<std::uint32_t>(ball.vertices.size());
    ball.vertices.push_back(1.05 * ball.vertices[a]);
    ball.vertices.push_back(1.05 * ball.vertices[b]);
    for (const auto& t : {std::array{a, n, b}, {b, n, n + 1}, {a, n + 1, n}, {a, b, n + 1}}) {
      ball.triangles.push_back(t);
    }
  }
  ball.triangles.push_back({0, 200, 500});
  ball.triangles.push_back({500, 200, 0});
  return ball;
}

// Issue 12: a mesh of such edges was taken for open, and bodies in it were missed.
TEST(MeshQuery, NoBodyIsMissedInAMeshWithFinsAndOpposedTriangles) {
  RandomInputs random;
  const auto mesh = std::make_shared<const TriangleMesh>(ballWithFins());
  ASSERT_EQ(mesh->triangles.size(), 2022u);
  const std::map<std::string, Shape> bodies = {
      {"box", Box{{0.2, 0.3, 0.2}}},
      {"sphere", Sphere{0.2}},
      {"ball", meshShape(bumpyBall(8, 0.2))},
      {"l", meshShape(movedBy(LShape().mesh(), {-0.1, 0, 0}))}};
  for (const auto& [name, body] : bodies) {
    const auto robot = robotFrom(boxLink("a_mesh", 1.0) + boxLink("body", 1.0) +
                                 joint("j", "floating", "a_mesh", "body", "0 0 0", ""));
    const auto shaped = robot->withElements([&](const Link& link) {
      return std::vector<Element>{
          {link.name == "body" ? body : Mesh{mesh}, Isometry3d::Identity()}};
    });
    const auto scene = CollisionScene::build(shaped, Srdf{}, nullptr);
    CollisionDetector detector(scene);
    NarrowPhase narrow_phase;
    const auto A = prepareShape(Mesh{mesh}), B = prepareShape(body);
    for (int i = 0; i < 300; ++i) {
      const Isometry3d X = random.pose(0.3);
      ASSERT_TRUE(narrow_phase.touches(*A, *B, X)) << name << i;
      ASSERT_TRUE(narrow_phase.distance(*A, *B, X, 0.0).touches()) << name << i;
      BodyPoses poses;
      poses.resize(2);
      poses.X_WB[1] = X;
      for (const bool verdict_only : {false, true}) {
        CheckSettings settings;
        settings.verdict_only = verdict_only;
        ASSERT_TRUE(detector.detect(poses, settings).in_collision) << name << i;
      }
    }
  }
}

TEST(MeshQuery, PrimitivesInsideAMeshAreContacts) {
  const Shape ball = meshShape(bumpyBall(16, 1.0));
  for (const Shape& small : {Shape(Box{{0.1, 0.1, 0.1}}), Shape(Sphere{0.1}),
                             Shape(Cylinder{0.1, 0.1}), Shape(Capsule{0.1, 0.1})}) {
    EXPECT_TRUE(touch(ball, small, at(0.3, 0.0, 0.0))) << shapeName(small);
    EXPECT_FALSE(touch(ball, small, at(3.0, 0.0, 0.0))) << shapeName(small);
  }
}

// An L is the union of two boxes, so its distance is the smaller of theirs.
TEST(MeshQuery, DistanceOfAnLToAnyConvexIsThatOfItsNearerPiece) {
  RandomInputs random;
  NarrowPhase narrow_phase;
  const LShape l;
  const auto L = prepareShape(meshShape(l.mesh()));
  const auto hull = std::make_shared<TriangleMesh>(boxMesh({0.1, 0.05, 0.15}));
  for (const Shape& shape :
       {Shape(Box{{0.1, 0.2, 0.3}}), Shape(Sphere{0.1}), Shape(Cylinder{0.1, 0.2}),
        Shape(Capsule{0.1, 0.2}), Shape(Convex{hull}), meshShape(*hull)}) {
    const auto B = prepareShape(shape);
    for (int i = 0; i < 500; ++i) {
      const Isometry3d X_LB = random.pose(0.5);
      double expected = INF;
      for (int k = 0; k < 2; ++k) {
        const auto piece = prepareShape(Box{2.0 * l.piece_halves[k]});
        Isometry3d X_PB = X_LB;
        X_PB.translation() -= l.piece_centers[k];
        expected = std::min(expected, narrow_phase.distance(*piece, *B, X_PB, INF).distance);
      }
      const PairDistance result = narrow_phase.distance(*L, *B, X_LB, INF);
      ASSERT_EQ(result.touches(), expected <= 0.0) << shapeName(shape) << " pose " << i;
      ASSERT_EQ(narrow_phase.touches(*L, *B, X_LB), expected <= 0.0) << shapeName(shape);
      if (result.touches()) {
        ASSERT_LE(result.distance, expected + 1e-9);  // the depth's accuracy for cylinders
        ASSERT_EQ(result.certainty, Certainty::BOUND);
        continue;
      }
      ASSERT_NEAR(result.distance, expected, 1e-10) << shapeName(shape) << " pose " << i;
      ASSERT_NEAR((result.p_ACb - result.p_ACa).norm(), result.distance, 1e-12)
          << shapeName(shape) << " pose " << i;
      ASSERT_NEAR(result.nhat_AB_A.norm(), 1.0, 1e-12);
    }
  }
}

TEST(MeshQuery, DistanceOfMeshesIsThatOfTheirClosestTriangles) {
  RandomInputs random;
  NarrowPhase narrow_phase;
  const TriangleMesh m = bumpyBall(8, 0.2), n = LShape().mesh();
  const auto M = prepareShape(meshShape(m)), N = prepareShape(meshShape(n));
  for (int i = 0; i < 200; ++i) {
    const Isometry3d X = random.pose(0.5);
    ClosestPoints best{INF};
    for (std::uint32_t s = 0; s < m.triangles.size(); ++s) {
      for (std::uint32_t t = 0; t < n.triangles.size(); ++t) {
        const Triangle u = triangleOf(n, t);
        improveByTriangles(triangleOf(m, s), Triangle(X * u.v[0], X * u.v[1], X * u.v[2]), best);
      }
    }
    const PairDistance result = narrow_phase.distance(*M, *N, X, INF);
    if (best.squared > 0.0 && !result.touches()) {
      ASSERT_NEAR(result.distance, std::sqrt(best.squared), 1e-14);
      const PairDistance cut = narrow_phase.distance(*M, *N, X, 0.5 * result.distance);
      ASSERT_EQ(cut.certainty, Certainty::BEYOND);
      ASSERT_LE(cut.distance, result.distance);
    } else {
      ASSERT_TRUE(result.touches());
    }
    ASSERT_EQ(narrow_phase.touches(*M, *N, X), result.touches());
  }
}

/// Triangles that share the corner v; all others of their corners are on one side of it.
Shape fanFrom(RandomInputs& random, const Vector3d& v, double side) {
  TriangleMesh fan;
  fan.vertices.push_back(v);
  for (std::uint32_t i = 0; i < 9; ++i) {
    for (int k = 0; k < 2; ++k) {
      const Vector3d beside(side * random.uniform(0.1, 1.0), random.uniform(-1, 1),
                            random.uniform(-1, 1));
      fan.vertices.push_back(v + beside);
    }
    fan.triangles.push_back({0, 2 * i + 1, 2 * i + 2});
  }
  return meshShape(fan);
}

TEST(MeshQuery, MeshesThatShareOneCornerTouch) {
  RandomInputs random;
  for (int i = 0; i < 300; ++i) {
    const Vector3d v = random.vector(-1.0, 1.0) * std::pow(10.0, random.integer(-3, 3));
    EXPECT_TRUE(touch(fanFrom(random, v, -1.0), fanFrom(random, v, 1.0), Isometry3d::Identity()))
        << "scene " << i;
  }
}

TEST(MeshQuery, ADistanceOfExactlyTheLimitIsFound) {
  RandomInputs random;
  NarrowPhase narrow_phase;
  for (int i = 0; i < 100; ++i) {
    const auto A = prepareShape(fanFrom(random, Vector3d::Zero(), -1.0));
    const auto B = prepareShape(fanFrom(random, Vector3d::Zero(), 1.0));
    const PairDistance found = narrow_phase.distance(*A, *B, at(0.25, 0.0, 0.0), 0.25);
    ASSERT_NE(found.certainty, Certainty::BEYOND) << "scene " << i;
    ASSERT_NEAR(found.distance, 0.25, 1e-15);
  }
}

TEST(MeshQuery, SurfacesMeetWhereTwoOfTheirTrianglesDo) {
  RandomInputs random;
  const TriangleMesh m = bumpyBall(8, 0.2), n = LShape().mesh();
  const auto M = prepareShape(meshShape(m)), N = prepareShape(meshShape(n));
  const PreparedMesh& A = *static_cast<const Prepared&>(*M).mesh;
  const PreparedMesh& B = *static_cast<const Prepared&>(*N).mesh;
  SurfaceContact search;
  int met = 0;
  for (int i = 0; i < 300; ++i) {
    const Isometry3d X = random.pose(0.25);
    ClosestPoints best{INF};
    for (std::uint32_t s = 0; s < m.triangles.size(); ++s) {
      for (std::uint32_t t = 0; t < n.triangles.size(); ++t) {
        const Triangle u = triangleOf(n, t);
        improveByTriangles(triangleOf(m, s), Triangle(X * u.v[0], X * u.v[1], X * u.v[2]), best);
      }
    }
    ASSERT_EQ(search.surfacesMeet(A, B, X, 1e-15), best.squared == 0.0) << i;
    met += best.squared == 0.0;
  }
  EXPECT_GT(met, 50);
  EXPECT_LT(met, 280);
}

TEST(MeshQuery, TheDepthOfMeshesIsABoundThatSeparates) {
  RandomInputs random;
  NarrowPhase narrow_phase;
  const auto M = prepareShape(meshShape(bumpyBall(8, 0.2)));
  const auto N = prepareShape(meshShape(LShape().mesh()));
  for (int i = 0; i < 200; ++i) {
    Isometry3d X = random.pose(0.1);
    const PairDistance result = narrow_phase.distance(*M, *N, X, INF);
    ASSERT_TRUE(result.touches());
    ASSERT_EQ(result.certainty, Certainty::BOUND);
    X.translation() += (1e-9 - result.distance) * result.nhat_AB_A;
    ASSERT_FALSE(narrow_phase.touches(*M, *N, X)) << i;
  }
}

TEST(MeshQuery, AConvexMeshIsAnsweredExactlyAsItsHull) {
  RandomInputs random;
  NarrowPhase narrow_phase;
  const auto box = prepareShape(Box{{0.2, 0.4, 0.6}});
  const auto mesh = prepareShape(meshShape(insideOut(boxMesh({0.1, 0.2, 0.3}))));
  const auto other = prepareShape(Box{{0.3, 0.3, 0.3}});
  for (int i = 0; i < 500; ++i) {
    const Isometry3d X = random.pose(0.5);
    const PairDistance result = narrow_phase.distance(*mesh, *other, X, INF);
    ASSERT_NEAR(result.distance, narrow_phase.distance(*box, *other, X, INF).distance, 1e-14);
    ASSERT_EQ(result.certainty, Certainty::EXACT);
  }
}

}  // namespace collision_pairs::test_mesh_query
