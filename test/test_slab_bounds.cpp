#include <gtest/gtest.h>

#include "mesh_query.h"
#include "prepared_shape.h"
#include "random_inputs.h"
#include "slab_bounds.h"
#include "test_shapes.h"

namespace collision_pairs {
namespace {

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
    const Vector3d n = random.vector(-1.0, 1.0).normalized();
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

}  // namespace
}  // namespace collision_pairs
