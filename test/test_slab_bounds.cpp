#include <gtest/gtest.h>

#include "mesh_query.h"
#include "prepared_shape.h"
#include "random_inputs.h"
#include "slab_bounds.h"
#include "surface_query.h"
#include "test_shapes.h"

namespace collision_pairs::test_slab_bounds {

using Eigen::Isometry3d;
using Eigen::Vector3d;

std::shared_ptr<const PreparedShape> bumpyShape(int n, double radius) {
  return prepareShape(meshShape(bumpyBall(n, radius)));
}

const PreparedMesh& meshOf(const std::shared_ptr<const PreparedShape>& shape) {
  return *static_cast<const Prepared&>(*shape).mesh;
}

/// The largest of d.v over all corners below the node.
double reachOf(const PreparedMesh& mesh, std::uint32_t index, const Vector3d& d) {
  const TriangleTree::Node& node = mesh.tree.node(index);
  double reach = -1e300;
  if (node.isLeaf()) {
    for (const Vector3d& v : triangleOf(*mesh.triangles, node.children).v) {
      reach = std::max(reach, d.dot(v));
    }
  }
  for (std::uint32_t i = 0; i < node.nb_children; ++i) {
    reach = std::max(reach, reachOf(mesh, node.children + i, d));
  }
  return reach;
}

/// Patches and the nodes above them.
std::vector<std::uint32_t> upperNodes(const PreparedMesh& mesh) {
  std::vector<std::uint32_t> open{0}, all;
  while (!open.empty()) {
    const std::uint32_t index = open.back();
    open.pop_back();
    all.push_back(index);
    const TriangleTree::Node& node = mesh.tree.node(index);
    if (node.isPatch()) continue;
    for (std::uint32_t i = 0; i < node.nb_children; ++i) open.push_back(node.children + i);
  }
  return all;
}

TEST(SlabBounds, AreTheGapsOfTheCornersAlongTheDirection) {
  RandomInputs random;
  const auto A = bumpyShape(10, 0.3), B = bumpyShape(8, 0.2);
  SlabBounds slabs;
  int apart = 0;
  for (int round = 0; round < 20; ++round) {
    const Isometry3d X_AB = random.pose(0.5);
    const Vector3d n =  // apart in many of every second round
        (round % 2 ? random.vector(-1.0, 1.0) : Vector3d(X_AB.translation())).normalized();
    const Vector3d n_B = X_AB.linear().transpose() * n;
    slabs.set(meshOf(A), meshOf(B), X_AB, n);
    for (const std::uint32_t a : upperNodes(meshOf(A))) {
      for (const std::uint32_t b : upperNodes(meshOf(B))) {
        const double gap =
            n.dot(X_AB.translation()) - reachOf(meshOf(A), a, n) - reachOf(meshOf(B), b, -n_B);
        ASSERT_NEAR(std::sqrt(slabs.squaredGap(a, b)), std::max(gap, 0.0), 1e-13);
        apart += gap > 0.0;
      }
    }
  }
  EXPECT_GT(apart, 100);
}

TEST(SlabBounds, AreNothingOnceCleared) {
  const auto A = bumpyShape(10, 0.3), B = bumpyShape(8, 0.2);
  Isometry3d X_AB = Isometry3d::Identity();
  X_AB.translation().x() = 2.0;
  SlabBounds slabs;
  slabs.set(meshOf(A), meshOf(B), X_AB, Vector3d::UnitX());
  EXPECT_GT(slabs.squaredGap(0, 0), 0.0);
  slabs.clear();
  EXPECT_EQ(slabs.squaredGap(0, 0), 0.0);
}

TEST(SlabBounds, ChangeNoDistanceWhateverTheirDirection) {
  RandomInputs random;
  const auto A = bumpyShape(10, 0.3), B = bumpyShape(8, 0.2);
  MeshQuery query;
  for (int round = 0; round < 300; ++round) {
    const Isometry3d X_AB = random.pose(0.7);
    const Vector3d n = random.vector(-1.0, 1.0).normalized();
    const SurfaceGap without = query.meshMesh(meshOf(A), meshOf(B), X_AB, 10.0, 1e-15);
    const SurfaceGap with = query.meshMesh(meshOf(A), meshOf(B), X_AB, 10.0, 1e-15, &n);
    ASSERT_EQ(with.beyond, without.beyond);
    ASSERT_NEAR(with.distance, without.distance, 1e-14);
  }
}

/// Of a triangle and a box around the origin, by the box's twelve triangles.
double distanceByTriangles(const Corners& t, const Vector3d& half) {
  const auto isInside = [&](const Vector3d& p) {
    return (p.cwiseAbs().array() <= half.array()).all();
  };
  if (isInside(t[0])) return 0.0;
  ClosestPoints best{std::numeric_limits<double>::infinity()};
  const TriangleMesh box = boxMesh(half);
  for (const auto& face : box.triangles) {
    const Triangle side(box.vertices[face[0]], box.vertices[face[1]], box.vertices[face[2]]);
    improveByTriangles(Triangle(t), side, best);
  }
  return std::sqrt(best.squared);
}

void expectDistanceFromBox(const Corners& t, const Vector3d& half) {
  constexpr double INF = std::numeric_limits<double>::infinity();
  double size = half.maxCoeff();
  for (const Vector3d& v : t) size = std::max(size, v.cwiseAbs().maxCoeff());
  const double wanted = distanceByTriangles(t, half), error = 1e-14 * size;
  const DistanceBounds found = distanceFromBox(t, half, INF);
  ASSERT_LE(found.lower, wanted + error);
  ASSERT_GE(found.upper, wanted - error);
  // The direction has few digits if the two nearly touch or the triangle is thin.
  const Vector3d first = t[1] - t[0], second = t[2] - t[0];
  const double area = first.cross(second).norm();
  const double thin = area / (first.squaredNorm() + second.squaredNorm());
  const double allowed = error / (thin > 1e-6 ? thin : 1.0);
  if (wanted == 0.0 && thin > 1e-6) {
    ASSERT_LE(found.upper, error);
  } else {
    ASSERT_LE(found.upper - found.lower, allowed * std::max(1.0, size / wanted));
  }
  for (const double share : {0.5, 0.999, 1.001}) {
    const DistanceBounds limited = distanceFromBox(t, half, share * wanted);
    ASSERT_LE(limited.lower, wanted + error);
    if (limited.lower > share * wanted) continue;
    ASSERT_EQ(limited.lower, found.lower);
    ASSERT_EQ(limited.upper, found.upper);
  }
}

TEST(DistanceFromBox, IsThatOfTheTrianglesOfTheBox) {
  RandomInputs random;
  for (int i = 0; i < 20000; ++i) {
    SCOPED_TRACE(i);
    Corners t;
    Vector3d half;
    for (int axis = 0; axis < 3; ++axis) half[axis] = random.integer(1, 2);
    const bool on_grid = i % 2 == 0;  // many touch, lie in a plane or have no area
    const double reach = i % 3 == 0 ? 3.0 : 30.0;
    for (Vector3d& v : t) {
      v = on_grid ? Vector3d(random.integer(-4, 4), random.integer(-4, 4), random.integer(-4, 4))
                  : random.vector(-reach, reach);
    }
    if (i % 10 == 3) t[2] = t[0] + random.uniform(0.0, 1.0) * (t[1] - t[0]);  // a sliver
    if (i % 10 == 5) t[1] = t[2] = t[0] + random.vector(-1e-9, 1e-9);         // a point
    if (i % 10 == 7) half *= 1e-6;
    if (i % 10 == 9) half *= 1e6, t[0] *= 1e6, t[1] *= 1e6, t[2] *= 1e6;
    expectDistanceFromBox(t, half);
    if (HasFatalFailure()) return;
  }
}

double distanceOfSurface(const PreparedMesh& mesh, const Isometry3d& X_WM, const Aabb& box) {
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < mesh.triangles->triangles.size(); ++i) {
    Corners t = moved(cornersOf(*mesh.triangles, i), X_WM);
    for (Vector3d& v : t) v -= box.center();
    least = std::min(least, distanceByTriangles(t, 0.5 * (box.max - box.min)));
  }
  return least;
}

TEST(SurfaceQuery, FindsTheNearestTriangleFromTheNodesKeptForALargerBox) {
  RandomInputs random;
  const auto shape = bumpyShape(12, 0.3);
  const PreparedMesh& mesh = meshOf(shape);
  SurfaceQuery query;
  int nb_near = 0, nb_far = 0;
  for (int round = 0; round < 300; ++round) {
    SCOPED_TRACE(round);
    const Isometry3d X_WM = random.pose(1.0);
    const SurfaceQuery::Nodes all = query.begin(*shape, X_WM);
    const Vector3d low = X_WM.translation() + random.vector(-0.6, 0.4);
    const Aabb larger{low, low + random.vector(0.05, 0.4)};
    const double reach = random.uniform(0.0, 0.2);
    SurfaceQuery::Nodes near{};
    const double bound = query.keepNear(larger, reach, all, near);
    EXPECT_EQ(bound > reach, near.begin == near.end);
    for (int k = 0; k < 5; ++k) {
      const Vector3d size = larger.max - larger.min;
      const Vector3d from = random.vector(0.0, 0.5).cwiseProduct(size);
      const Aabb box{larger.min + from, larger.min + from + 0.3 * size};
      const double wanted = distanceOfSurface(mesh, X_WM, box);
      EXPECT_LE(bound, wanted + 1e-14);
      const DistanceBounds found = query.distance(box, reach, 1e-11, near);
      EXPECT_GE(found.upper, wanted - 1e-14);
      if (wanted <= reach) {
        EXPECT_NEAR(found.lower, wanted, 1.1e-11);
        EXPECT_NEAR(found.upper, wanted, 1.1e-11);
        ++nb_near;
      } else {
        EXPECT_GT(found.lower, reach - 1e-14);
        ++nb_far;
      }
    }
  }
  EXPECT_GT(nb_near, 100);
  EXPECT_GT(nb_far, 100);
}

TEST(SurfaceQuery, KeepsForEachOfFourBoxesWhatIsNearThatOne) {
  RandomInputs random;
  const auto shape = bumpyShape(12, 0.3);
  SurfaceQuery query;
  int nb_near = 0, nb_far = 0, nb_bounded = 0;
  for (int round = 0; round < 200; ++round) {
    SCOPED_TRACE(round);
    const Isometry3d X_WM = random.pose(1.0);
    const Vector3d low = X_WM.translation() + random.vector(-0.6, 0.4);
    const Vector3d size = random.vector(0.05, 0.4);
    const double reach = random.uniform(0.0, 0.2);
    SurfaceQuery::Nodes larger{};
    query.keepNear({low, low + size}, 2.0 * reach, query.begin(*shape, X_WM), larger);
    const auto count = static_cast<std::size_t>(random.integer(1, BOX_LANES));
    std::array<Aabb, BOX_LANES> boxes;
    for (std::size_t i = 0; i < count; ++i) {
      const Vector3d from = low + random.vector(0.0, 0.7).cwiseProduct(size);
      boxes[i] = {from, from + 0.3 * size};
    }
    std::array<SurfaceQuery::Nodes, BOX_LANES> near;
    const FourGaps bounds = query.keepNear(boxes, count, reach, larger, near);
    for (std::size_t i = 0; i < count; ++i) {
      SCOPED_TRACE(i);
      const double wanted = distanceOfSurface(meshOf(shape), X_WM, boxes[i]);
      if (wanted <= 2.0 * reach) {
        EXPECT_LE(bounds.of[i], wanted + 1e-14);
      }
      EXPECT_EQ(bounds.of[i] > reach, near[i].begin == near[i].end);
      const DistanceBounds found = query.distance(boxes[i], reach, 1e-11, near[i]);
      (wanted <= reach ? nb_near : nb_far) += 1;
      nb_bounded += bounds.of[i] > 0.5 * wanted && wanted > 0.0;
      EXPECT_GE(found.upper, wanted - 1e-14);
      EXPECT_GT(found.lower, std::min(wanted - 1.1e-11, reach - 1e-14));
      if (wanted <= reach) {
        EXPECT_NEAR(found.upper, wanted, 1.1e-11);
      }
    }
  }
  EXPECT_GT(nb_near, 100);
  EXPECT_GT(nb_far, 100);
  EXPECT_GT(nb_bounded, 100);
}

}  // namespace collision_pairs::test_slab_bounds
