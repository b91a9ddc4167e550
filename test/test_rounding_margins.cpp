// Boxes and hulls enclose what they stand for to the last digit: beside an oracle with more digits.
#include <gtest/gtest.h>

#include "collision_pairs/aabb.h"
#include "mesh_bounds.h"
#include "random_inputs.h"
#include "scene_element.h"
#include "slab_bounds.h"
#include "solids.h"
#include "test_shapes.h"
#include "triangle_tree.h"

namespace collision_pairs::test_rounding_margins {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Long = Eigen::Matrix<long double, 3, 1>;

Long placed(const Isometry3d& X, const Vector3d& p) {
  const Eigen::Matrix<long double, 3, 3> R = X.linear().cast<long double>();
  return R * p.cast<long double>() + X.translation().cast<long double>();
}

bool holds(const Aabb& box, const Long& p) {
  return (box.min.cast<long double>().array() <= p.array()).all() &&
         (box.max.cast<long double>().array() >= p.array()).all();
}

TriangleMesh randomPoints(RandomInputs& random, int count, double size) {
  TriangleMesh mesh;
  for (int i = 0; i < count; ++i) mesh.vertices.push_back(random.vector(-size, size));
  mesh.triangles = {{0, 1, 2}, {1, 2, 3}};
  return mesh;
}

TEST(RoundingMargins, AlignedBoxesHoldEveryCornerAtAnyDistanceFromTheOrigin) {
  RandomInputs random;
  for (const double reach : {1.0, 1e3, 1e13}) {
    for (int round = 0; round < 300; ++round) {
      const Isometry3d X_WE = random.pose(reach);
      const Vector3d half = random.vector(0.0, 1.0);
      const Aabb of_box = computeAabb(Box{2.0 * half}, X_WE);
      for (const Vector3d& corner : boxMesh(half).vertices) {
        ASSERT_TRUE(holds(of_box, placed(X_WE, corner))) << reach;
      }
      const TriangleMesh mesh = randomPoints(random, 30, 1.0);
      const Aabb of_mesh = computeAabb(meshShape(mesh), X_WE);
      const MeshBounds bounds(hullVertices(mesh)->vertices, hullMargin(mesh));
      const Aabb of_bounds = bounds.boxAt(X_WE);
      for (const Vector3d& vertex : mesh.vertices) {
        ASSERT_TRUE(holds(of_mesh, placed(X_WE, vertex))) << reach;
        ASSERT_TRUE(holds(of_bounds, placed(X_WE, vertex))) << reach;
      }
    }
  }
}

TEST(RoundingMargins, BoxesAlongAnElementsAxesHoldEveryVertex) {
  RandomInputs random;
  for (int round = 0; round < 300; ++round) {
    TriangleMesh mesh = randomPoints(random, 30, 1.0);
    const Vector3d offset = random.vector(-10.0, 10.0);
    for (Vector3d& p : mesh.vertices) p += offset;
    const auto [box, X_EO] = enclosingBox(Convex{std::make_shared<TriangleMesh>(mesh)});
    const SceneElement element =
        makeElement(meshShape(mesh), Fidelity::OBB, 0, NarrowPhaseMethod::NATIVE);
    const Eigen::Matrix<long double, 3, 3> R_OE = X_EO.linear().cast<long double>().inverse();
    for (const Vector3d& p : mesh.vertices) {
      const Long p_O = R_OE * (p.cast<long double>() - X_EO.translation().cast<long double>());
      const Long own = (p.cast<long double>() - element.box_center.cast<long double>()).cwiseAbs();
      ASSERT_TRUE((p_O.cwiseAbs().array() <= 0.5L * box.size.cast<long double>().array()).all());
      ASSERT_TRUE((own.array() <= element.box_half.cast<long double>().array()).all());
    }
  }
}

/// A box with a dent in its lower face and, a last digit above its upper one, a vertex that qhull
/// takes for a point of that face.
TriangleMesh boxWithAVertexAboveItsFace() {
  TriangleMesh mesh = boxMesh({0.5, 0.5, 0.5});
  const auto dent = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.emplace_back(0.0, 0.0, -0.25);
  mesh.vertices.emplace_back(0.0, 0.0, std::nextafter(0.5, 1.0));
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (const auto& t : mesh.triangles) {
    bool below = true, above = true;
    for (const std::uint32_t i : t) {
      below = below && mesh.vertices[i].z() == -0.5;
      above = above && mesh.vertices[i].z() == 0.5;
    }
    if (!below && !above) {
      triangles.push_back(t);
      continue;
    }
    for (int k = 0; k < 3; ++k)
      triangles.push_back({t[k], t[(k + 1) % 3], below ? dent : dent + 1});
  }
  mesh.triangles = triangles;
  return mesh;
}

void collectTriangles(const TriangleTree& tree, std::uint32_t at, std::vector<std::uint32_t>& all) {
  const auto& node = tree.node(at);
  if (node.isLeaf()) all.push_back(node.children);
  for (std::uint32_t k = 0; k < node.nb_children; ++k) {
    collectTriangles(tree, node.children + k, all);
  }
}

void expectBoxesHoldTheirTriangles(const TriangleTree& tree, const TriangleMesh& mesh,
                                   std::uint32_t at) {
  const OrientedBox box = tree.box(at);
  const Eigen::Matrix<long double, 3, 3> R = box.R.cast<long double>(), R_BM = R.inverse();
  ASSERT_LT((R.transpose() * R).eval().cwiseAbs().sum() - 3.0L, 1e-14L) << "node " << at;
  ASSERT_GT(R.determinant(), 1.0L - 1e-14L) << "node " << at;
  std::vector<std::uint32_t> triangles;
  collectTriangles(tree, at, triangles);
  for (const std::uint32_t triangle : triangles) {
    for (const std::uint32_t vertex : mesh.triangles[triangle]) {
      const Long from_center =
          mesh.vertices[vertex].cast<long double>() - box.center.cast<long double>();
      const Long p_B = R_BM * from_center;
      ASSERT_TRUE((p_B.cwiseAbs().array() <= box.half.cast<long double>().array()).all())
          << "node " << at;
    }
  }
  for (std::uint32_t k = 0; k < tree.node(at).nb_children; ++k) {
    expectBoxesHoldTheirTriangles(tree, mesh, tree.node(at).children + k);
  }
}

TEST(RoundingMargins, EachNodeOfATreeHoldsItsTrianglesAtAnyDistanceFromTheOrigin) {
  RandomInputs random;
  for (const double reach : {0.0, 10.0, 1e6}) {
    for (int round = 0; round < 20; ++round) {
      TriangleMesh mesh = bumpyBall(6, 0.3);
      const Isometry3d X = random.pose(reach);
      for (Vector3d& p : mesh.vertices) p = X * p;
      const TriangleTree tree(mesh);
      expectBoxesHoldTheirTriangles(tree, mesh, 0);
    }
  }
}

TEST(RoundingMargins, AHullGrownByItsMarginHoldsTheVerticesThatQhullLeavesOut) {
  const TriangleMesh mesh = boxWithAVertexAboveItsFace();
  const auto hull = hullVertices(mesh);
  double highest = 0.0;
  for (const Vector3d& p : hull->vertices) highest = std::max(highest, p.z());
  ASSERT_EQ(highest, 0.5) << "qhull took it: then this test is about nothing";
  EXPECT_GE(highest + hullMargin(mesh), std::nextafter(0.5, 1.0));
}

TEST(RoundingMargins, BoundsFromHullsAllowForTheVerticesThatQhullLeavesOut) {
  const auto A = prepareShape(meshShape(boxWithAVertexAboveItsFace()));
  const auto B = prepareShape(Sphere{0.125});
  Isometry3d X_AB = Isometry3d::Identity();
  X_AB.translation().z() = 1.0;
  const auto &a = static_cast<const Prepared&>(*A), &b = static_cast<const Prepared&>(*B);
  ASSERT_TRUE(a.mesh) << "with its dent it is not convex";
  const HullBounds bounds = boundsFromHulls(a, b, X_AB, 0.375 - 1e-13, 0.0);
  ASSERT_EQ(bounds.outcome, HullBounds::Outcome::BEYOND);
  EXPECT_LE(bounds.hulls.distance, 0.875 - std::nextafter(0.5, 1.0));
}

TEST(RoundingMargins, AHullMissesNoPointOfItsOwnSurface) {
  RandomInputs random;
  int nb_points = 0;
  for (int round = 0; round < 50; ++round) {
    const TriangleMesh mesh = randomPoints(random, 20, 1.0);
    const auto shape = prepareShape(Convex{std::make_shared<TriangleMesh>(mesh)});
    const auto& prepared = static_cast<const Prepared&>(*shape);
    const auto& corners = prepared.hull.points.vertices;
    for (const auto& face : prepared.hull.faces) {
      const double s = random.uniform(0.0, 1.0), t = random.uniform(0.0, 1.0 - s);
      const Vector3d on_face =
          s * corners[face[0]] + t * corners[face[1]] + (1.0 - s - t) * corners[face[2]];
      ASSERT_FALSE(hullMisses(prepared, on_face));
      ++nb_points;
    }
  }
  EXPECT_GT(nb_points, 500);
}

TEST(RoundingMargins, SlabsAreNoFurtherApartThanTheCorners) {
  RandomInputs random;
  const auto A = prepareShape(meshShape(bumpyBall(6, 0.3)));
  const auto B = prepareShape(meshShape(bumpyBall(6, 0.2)));
  const auto& a = *static_cast<const Prepared&>(*A).mesh;
  const auto& b = *static_cast<const Prepared&>(*B).mesh;
  SlabBounds slabs;
  int nb_apart = 0;
  for (int round = 0; round < 300; ++round) {
    const Isometry3d X_AB = random.pose(3.0);
    const Vector3d n = X_AB.translation().normalized();
    slabs.set(a, b, X_AB, n);
    long double reach_a = -1e30L, reach_b = 1e30L;
    const Long direction = n.cast<long double>();
    for (const Vector3d& v : a.triangles->vertices) {
      reach_a = std::max(reach_a, direction.dot(v.cast<long double>()));
    }
    for (const Vector3d& v : b.triangles->vertices) {
      reach_b = std::min(reach_b, direction.dot(placed(X_AB, v)));
    }
    const long double gap = reach_b - reach_a;
    if (gap <= 0.0L) continue;
    ++nb_apart;
    EXPECT_LE(slabs.squaredGap(0, 0), static_cast<double>(gap * gap));
  }
  EXPECT_GT(nb_apart, 100);
}

}  // namespace collision_pairs::test_rounding_margins
