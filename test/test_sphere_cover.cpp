#include <cmath>

#include <gtest/gtest.h>

#include "every_shape.h"
#include "sphere_cover.h"
#include "sphere_distance.h"

namespace collision_pairs::test_sphere_cover {

using Eigen::Vector3d;

constexpr double ROUNDING = 1e-9;  // m

bool isWithin(const PlacedSphere& sphere, const Vector3d& p) {
  return (p - sphere.center).norm() <= sphere.radius + ROUNDING;
}

SphereCover coverOf(const Shape& shape, std::size_t most_spheres = 127) {
  return coverBySpheres(static_cast<const Prepared&>(*prepareShape(shape)), most_spheres);
}

std::vector<PlacedSphere> leavesOf(const SphereCover& cover) {
  std::vector<PlacedSphere> leaves;
  for (const OuterSphere& sphere : cover.outer) {
    if (sphere.first_child == 0) leaves.push_back(sphere);
  }
  return leaves;
}

/// Membership by definition, of solids of which it is simple.
bool holds(const Shape& shape, const Vector3d& p) {
  if (const auto* box = std::get_if<Box>(&shape)) {
    return (p.cwiseAbs() - 0.5 * box->size).maxCoeff() <= 0.0;
  }
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return p.norm() <= sphere->radius;
  if (const auto* c = std::get_if<Cylinder>(&shape)) {
    return p.head<2>().norm() <= c->radius && std::abs(p[2]) <= 0.5 * c->length;
  }
  const auto& capsule = std::get<Capsule>(shape);
  const double half = 0.5 * capsule.length;
  return (p - Vector3d(0, 0, std::clamp(p[2], -half, half))).norm() <= capsule.radius;
}

bool isPrimitive(const Shape& shape) { return shape.index() <= 3; }

/// Points of the solid: of a primitive any, of a cylinder also its rims, of points their mixtures,
/// of a mesh its surface.
Vector3d pointOf(RandomInputs& random, const Shape& shape, double size) {
  const auto* cylinder = std::get_if<Cylinder>(&shape);
  if (cylinder && random.integer(0, 1) == 0) {
    const double angle = random.uniform(0.0, 2.0 * M_PI);
    const double z = (random.integer(0, 1) - 0.5) * cylinder->length;
    return {cylinder->radius * std::cos(angle), cylinder->radius * std::sin(angle), z};
  }
  if (isPrimitive(shape)) {
    while (true) {
      const Vector3d p = random.vector(-2.0 * size, 2.0 * size);
      if (holds(shape, p)) return p;
    }
  }
  const auto* convex = std::get_if<Convex>(&shape);
  const TriangleMesh& mesh = convex ? *convex->mesh : *std::get<Mesh>(shape).mesh;
  Eigen::Array3d share(random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1));
  share /= share.sum();
  Vector3d p = Vector3d::Zero();
  const auto last = static_cast<int>(mesh.vertices.size()) - 1;
  const int triangle = convex ? 0 : random.integer(0, static_cast<int>(mesh.triangles.size()) - 1);
  for (int k = 0; k < 3; ++k) {
    p += share[k] * mesh.vertices[convex ? random.integer(0, last) : mesh.triangles[triangle][k]];
  }
  return p;
}

TEST(EnclosingSphere, HoldsAllPointsAndIsHardlyLargerThanTheSmallest) {
  RandomInputs random;
  for (int round = 0; round < 200; ++round) {
    const Vector3d center = random.vector(-5, 5);
    const double radius = std::pow(10.0, random.uniform(-3, 2));
    std::vector<Vector3d> points;
    for (int i = 0; i < 60; ++i) {  // opposite points on a sphere: no smaller sphere has them
      const Vector3d p = radius * (random.rotation() * Vector3d::UnitX());
      points.push_back(center + p);
      points.push_back(center - p);
      points.push_back(center + random.uniform(0, 1) * p);
    }
    const PlacedSphere sphere = enclosingSphere(points);
    for (const Vector3d& p : points)
      ASSERT_LE((p - sphere.center).norm(), sphere.radius * (1 + 1e-14));
    EXPECT_LE(sphere.radius, 1.01 * radius);
  }
  const PlacedSphere one = enclosingSphere({Vector3d(1, 2, 3)});
  EXPECT_EQ(one.radius, 0.0);
  EXPECT_EQ(one.center, Vector3d(1, 2, 3));
}

/// Is the point in a leaf, on the way to which all spheres hold it?
bool leadsToLeaf(const std::vector<OuterSphere>& tree, int at, const Vector3d& p) {
  const OuterSphere& sphere = tree[static_cast<std::size_t>(at)];
  if (!isWithin(sphere, p)) return false;
  return sphere.first_child == 0 || leadsToLeaf(tree, sphere.first_child, p) ||
         leadsToLeaf(tree, sphere.first_child + 1, p);
}

TEST(SphereCover, EverySolidIsEnclosedOnTheWayToTheLeavesOfItsTree) {
  RandomInputs random;
  for (const std::string& kind : EVERY_KIND) {
    SCOPED_TRACE(kind);
    for (int round = 0; round < 5; ++round) {
      const double size = std::pow(10.0, random.uniform(-2, 1));
      const Shape shape = shapeOfKind(random, kind, size);
      for (const std::size_t most_spheres : {1, 127, 1001}) {
        const auto outer = coverOf(shape, most_spheres).outer;
        ASSERT_TRUE(outer.size() <= most_spheres || isPrimitive(shape));
        for (int i = 0; i < 2000; ++i) {
          ASSERT_TRUE(leadsToLeaf(outer, 0, pointOf(random, shape, size)));
        }
      }
    }
  }
}

// Each cell is divided in the middle, where these bodies have their corners.
TEST(SphereCover, CornersWhereACellIsDividedAreEnclosed) {
  RandomInputs random;
  for (int longest = 0; longest < 3; ++longest) {
    auto octahedron = std::make_shared<TriangleMesh>();
    for (int axis = 0; axis < 3; ++axis) {
      const double reach = axis == longest ? 1.0 : 0.5;
      for (const double sign : {-1.0, 1.0}) {
        octahedron->vertices.emplace_back(sign * reach * Vector3d::Unit(axis));
      }
    }
    const Shape shape = Convex{octahedron};
    for (const std::size_t most_spheres : {3, 7, 127}) {
      const auto outer = coverOf(shape, most_spheres).outer;
      for (const Vector3d& corner : octahedron->vertices) {
        ASSERT_TRUE(leadsToLeaf(outer, 0, corner));
      }
      for (int i = 0; i < 1000; ++i) {
        ASSERT_TRUE(leadsToLeaf(outer, 0, pointOf(random, shape, 1.0)));
      }
    }
  }
}

TEST(SphereCover, ATreeOfFewerSpheresIsTheBeginningOfOneOfMore) {
  const Shape shape = meshShape(LShape().mesh());
  const auto few = coverOf(shape, 63).outer, many = coverOf(shape, 501).outer;
  ASSERT_LT(few.size(), many.size());
  for (std::size_t i = 0; i < few.size(); ++i) {
    EXPECT_EQ(few[i].center, many[i].center);
    EXPECT_EQ(few[i].radius, many[i].radius);
    EXPECT_TRUE(few[i].first_child == 0 || few[i].first_child == many[i].first_child);
  }
}

TEST(SphereCover, MoreSpheresStickOutLess) {
  RandomInputs random;
  const Shape shape = meshShape(LShape().mesh());
  const SphereCover few = coverOf(shape, 31), many = coverOf(shape, 2047);
  int in_few = 0, in_many = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vector3d p = random.vector(-0.3, 0.3);
    in_few += leadsToLeaf(few.outer, 0, p);
    in_many += leadsToLeaf(many.outer, 0, p);
  }
  EXPECT_LT(in_many, in_few);
}

TEST(SphereCover, OfAMeshHoldsWhatTheMeshEncloses) {
  RandomInputs random;
  const LShape l;
  const auto cover = coverOf(meshShape(l.mesh()));
  const auto leaves = leavesOf(cover);
  for (int i = 0; i < 20000; ++i) {
    const int piece = random.integer(0, 1);
    const Vector3d p =
        l.piece_centers[piece] + random.vector(-1, 1).cwiseProduct(l.piece_halves[piece]);
    ASSERT_TRUE(std::any_of(leaves.begin(), leaves.end(),
                            [&](const PlacedSphere& sphere) { return isWithin(sphere, p); }));
  }
}

TEST(SphereCover, InnerSpheresLieInTheSolid) {
  RandomInputs random;
  for (const std::string kind : {"box", "sphere", "cylinder", "capsule"}) {
    SCOPED_TRACE(kind);
    const Shape shape = shapeOfKind(random, kind, 0.3);
    const auto inner = coverOf(shape).inner;
    ASSERT_FALSE(inner.empty());
    for (const PlacedSphere& sphere : inner) {
      for (int i = 0; i < 1000; ++i) {
        const Vector3d direction = random.rotation() * Vector3d::UnitX();
        ASSERT_TRUE(holds(shape, sphere.center + (sphere.radius - ROUNDING) * direction));
      }
    }
  }
}

TEST(SphereCover, InnerSpheresLieInOneOfTheBodiesOfAMesh) {
  LShape l;
  // Also with what is inside opposite, across the origin, to what is outside.
  for (const Vector3d& shift : {Vector3d(0, 0, 0), Vector3d(0, 0, -0.1), Vector3d(2, -1, 3)}) {
    for (Vector3d& center : l.piece_centers) center += shift;
    const auto inner = coverOf(meshShape(l.mesh())).inner;
    ASSERT_FALSE(inner.empty());
    for (const PlacedSphere& sphere : inner) {
      bool is_inside = false;
      for (int k = 0; k < 2; ++k) {
        const Vector3d p = (sphere.center - l.piece_centers[k]).cwiseAbs();
        is_inside |= (p - l.piece_halves[k]).maxCoeff() + sphere.radius <= ROUNDING;
      }
      EXPECT_TRUE(is_inside);
    }
  }
}

TEST(SphereCover, HollowsAndOpenMeshesHoldNoInnerSphere) {
  const TriangleMesh shell =
      joined(boxMesh({0.2, 0.2, 0.2}), insideOut(boxMesh({0.15, 0.15, 0.15})));
  for (const PlacedSphere& sphere : coverOf(meshShape(shell)).inner) {
    EXPECT_GE(sphere.center.cwiseAbs().maxCoeff() - sphere.radius, 0.15 - ROUNDING);
  }
  TriangleMesh open = boxMesh({0.2, 0.2, 0.2});
  open.triangles.resize(10);
  EXPECT_TRUE(coverOf(meshShape(open)).inner.empty());
}

// A hole of less than 3 % counts as closed: what is behind it is inside, and in the spheres.
TEST(SphereCover, OfANearlyClosedMeshEnclosesItsHull) {
  RandomInputs random;
  TriangleMesh sphere = bumpyBall(24, 0.2);
  sphere.triangles.erase(sphere.triangles.begin() + 300, sphere.triangles.begin() + 306);
  const auto cover = coverOf(meshShape(sphere));
  EXPECT_TRUE(cover.inner.empty());
  const auto leaves = leavesOf(cover);
  for (int i = 0; i < 20000; ++i) {
    const Shape hull = Convex{std::make_shared<const TriangleMesh>(sphere)};
    const Vector3d p = pointOf(random, hull, 0.2);
    ASSERT_TRUE(std::any_of(leaves.begin(), leaves.end(),
                            [&](const PlacedSphere& b) { return isWithin(b, p); }));
  }
}

TEST(SphereDistance, ThatIsExactlyTheRequestedOneIsNotBeyondIt) {
  RandomInputs random;
  for (int round = 0; round < 1000; ++round) {
    const auto sphere = [&] {
      return std::vector<OuterSphere>{{{random.vector(-1.0, 1.0), random.uniform(0.1, 0.5)}, 0}};
    };
    const std::vector<OuterSphere> a = sphere(), b = sphere();
    const Eigen::Isometry3d X_AB(
        Eigen::Translation3d(random.rotation() * Eigen::Vector3d(5.0, 0.0, 0.0)));
    const auto found = [&](double max_distance) {
      return sphereDistance({&a, nullptr}, {&b, nullptr}, X_AB, max_distance, 0.0);
    };
    const double distance = found(100.0).distance;
    EXPECT_NEAR(distance, (X_AB * b[0].center - a[0].center).norm() - a[0].radius - b[0].radius,
                1e-12);
    EXPECT_EQ(found(distance).certainty, Certainty::EXACT);
    EXPECT_EQ(found(distance).distance, distance);
    EXPECT_EQ(found(std::nextafter(distance, 0.0)).certainty, Certainty::BEYOND);
  }
}

TEST(SphereDistance, OfASolidInItselfHasADirection) {
  RandomInputs random;
  for (const std::string& kind : EVERY_KIND) {
    const auto prepared = prepareShape(shapeOfKind(random, kind, 0.2));
    const auto& solid = static_cast<const Prepared&>(*prepared);
    const auto outer = coverBySpheres(solid, 127).outer;
    const PairDistance found =
        sphereDistance({&outer, nullptr}, {&outer, nullptr}, Eigen::Isometry3d::Identity(), 1.0, 0);
    EXPECT_LT(found.distance, 0.0) << kind;
    EXPECT_NEAR(found.nhat_AB_A.norm(), 1.0, 1e-12) << kind;
    EXPECT_TRUE(found.p_ACa.allFinite() && found.p_ACb.allFinite()) << kind;
  }
}

TEST(SphereCover, OfSolidsWithoutVolumeIsWhole) {
  for (const Shape& shape :
       {Shape(Box{{0.2, 0.3, 0.0}}), Shape(Box{{0, 0, 0}}), Shape(Cylinder{0.0, 0.3}),
        Shape(Cylinder{0.2, 0.0}), Shape(Sphere{0.0}), Shape(Capsule{0.1, 0.0})}) {
    const auto outer = coverOf(shape).outer;
    ASSERT_FALSE(outer.empty());
    EXPECT_TRUE(std::isfinite(outer[0].radius));
  }
}

}  // namespace collision_pairs::test_sphere_cover
