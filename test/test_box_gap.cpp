#include <set>

#include <gtest/gtest.h>

#include "box_gap.h"
#include "random_inputs.h"
#include "triangle_tree.h"

namespace collision_pairs::test_box_gap {

using Eigen::Vector3d;

OrientedBox randomBox(RandomInputs& random, double reach) {
  OrientedBox box;
  box.R = random.rotation().toRotationMatrix();
  box.center = random.vector(-reach, reach);
  box.half = random.vector(0.0, 1.0);
  return box;
}

Vector3d corner(const OrientedBox& box, int i) {
  const Vector3d sign(i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0);
  return box.center + box.R * sign.cwiseProduct(box.half);
}

/// From box `a` to the box along a's axes around the corners of b.
double squaredGapToCorners(const OrientedBox& a, const OrientedBox& b) {
  Vector3d low = Vector3d::Constant(1e300), high = -low;
  for (int i = 0; i < 8; ++i) {
    const Vector3d p = a.R.transpose() * (corner(b, i) - a.center);
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return (low - a.half).cwiseMax(-high - a.half).cwiseMax(0.0).squaredNorm();
}

BoxBlock blockOf(const std::array<OrientedBox, BOX_LANES>& boxes) {
  BoxBlock block;
  for (int lane = 0; lane < BOX_LANES; ++lane) setLane(boxes[lane], lane, block);
  return block;
}

TEST(BoxGap, IsTheLargerOfTheGapsToTheOthersCorners) {
  RandomInputs random;
  int apart = 0;
  for (int round = 0; round < 2000; ++round) {
    std::array<OrientedBox, BOX_LANES> boxes;
    for (OrientedBox& box : boxes) box = randomBox(random, 2.0);
    const OrientedBox other = randomBox(random, 2.0);
    const BoxBlock block = blockOf(boxes);
    const FourGaps best = squaredBoxGaps(block, other);
    for (int lane = 0; lane < BOX_LANES; ++lane) {
      const double expected = std::max(squaredGapToCorners(boxes[lane], other),
                                       squaredGapToCorners(other, boxes[lane]));
      ASSERT_NEAR(squaredBoxGap(boxes[lane], other), expected, 1e-13);
      ASSERT_NEAR(best.of[lane], expected, 1e-13);
      for (const GeometryKernel& kernel : geometryKernels()) {
        FourGaps gaps;
        kernel.box_gaps(block, other.R.data(), other.center.data(), other.half.data(), gaps.of);
        ASSERT_NEAR(gaps.of[lane], expected, 1e-13) << kernel.name;
      }
      apart += expected > 0.0;
    }
  }
  EXPECT_GT(apart, 1000);
}

TEST(BoxGap, OfAMovedBoxIsThatOfTheBoxWhereItIsMovedTo) {
  RandomInputs random;
  for (int round = 0; round < 500; ++round) {
    std::array<OrientedBox, BOX_LANES> boxes, others;
    for (OrientedBox& box : boxes) box = randomBox(random, 2.0);
    for (OrientedBox& box : others) box = randomBox(random, 2.0);
    const BoxBlock block = blockOf(boxes), other = blockOf(others);
    const Eigen::Isometry3d X = random.pose(2.0);
    for (int lane = 0; lane < BOX_LANES; ++lane) {
      const FourGaps best = squaredBoxGaps(block, other, lane, X);
      for (int i = 0; i < BOX_LANES; ++i) {
        const double expected = squaredBoxGap(boxes[i], others[lane].movedBy(X));
        ASSERT_NEAR(best.of[i], expected, 1e-13);
        for (const GeometryKernel& kernel : geometryKernels()) {
          FourGaps gaps;
          kernel.moved_box_gaps(block, other, lane, X.data(), gaps.of);
          ASSERT_NEAR(gaps.of[i], expected, 1e-13) << kernel.name;
        }
      }
    }
  }
}

TEST(BoxGap, OfAPointIsTheDistanceToItsNearestPointInTheBox) {
  RandomInputs random;
  for (int round = 0; round < 2000; ++round) {
    std::array<OrientedBox, BOX_LANES> boxes;
    for (OrientedBox& box : boxes) box = randomBox(random, 2.0);
    const Vector3d point = random.vector(-3.0, 3.0);
    const BoxBlock block = blockOf(boxes);
    const FourGaps best = squaredPointGaps(block, point);
    for (int lane = 0; lane < BOX_LANES; ++lane) {
      const OrientedBox& box = boxes[lane];
      const Vector3d local = box.R.transpose() * (point - box.center);
      const Vector3d nearest = local.cwiseMax(-box.half).cwiseMin(box.half);
      ASSERT_NEAR(best.of[lane], (nearest - local).squaredNorm(), 1e-13);
      for (const GeometryKernel& kernel : geometryKernels()) {
        FourGaps gaps;
        kernel.point_gaps(block, point.data(), gaps.of);
        ASSERT_NEAR(gaps.of[lane], (nearest - local).squaredNorm(), 1e-13) << kernel.name;
      }
    }
  }
}

TEST(BoxGap, ABoxComesOutOfItsLaneAsItWentIn) {
  RandomInputs random;
  std::array<OrientedBox, BOX_LANES> boxes;
  for (OrientedBox& box : boxes) box = randomBox(random, 2.0);
  const BoxBlock block = blockOf(boxes);
  for (int lane = 0; lane < BOX_LANES; ++lane) {
    const OrientedBox out = boxInLane(block, lane);
    EXPECT_EQ(out.R, boxes[lane].R);
    EXPECT_EQ(out.center, boxes[lane].center);
    EXPECT_EQ(out.half, boxes[lane].half);
  }
}

/// Walks a tree and counts what it finds.
struct TreeWalk {
  const TriangleMesh& mesh;
  const TriangleTree& tree;
  std::multiset<std::uint32_t> triangles;
  int patches = 0;

  // Gives the triangles below the node.
  std::set<std::uint32_t> walk(std::uint32_t index, bool below_patch) {
    const TriangleTree::Node& node = tree.node(index);
    EXPECT_FALSE(node.isPatch() && below_patch);
    below_patch |= node.isPatch();
    patches += node.isPatch();
    EXPECT_EQ(node.above_patches, !below_patch);
    std::set<std::uint32_t> below;
    if (node.isLeaf()) {
      triangles.insert(node.children);
      below.insert(node.children);
    } else {
      EXPECT_GE(node.nb_children, 2);
      EXPECT_LE(node.nb_children, BOX_LANES);
    }
    for (std::uint32_t i = 0; i < node.nb_children; ++i) {
      below.merge(walk(node.children + i, below_patch));
    }
    EXPECT_LE(node.isPatch() ? below.size() : 0, TriangleTree::PATCH_TRIANGLES);
    holdBox(index, below);
    return below;
  }

  void holdBox(std::uint32_t index, const std::set<std::uint32_t>& below) const {
    const OrientedBox box = tree.box(index);
    EXPECT_EQ(tree.node(index).size, box.half.maxCoeff());
    for (const std::uint32_t t : below) {
      for (const std::uint32_t vertex : mesh.triangles[t]) {
        const Vector3d local = box.R.transpose() * (mesh.vertices[vertex] - box.center);
        EXPECT_LE((local.cwiseAbs() - box.half).maxCoeff(), 1e-15);
      }
    }
  }
};

TEST(TriangleTree, HoldsEachTriangleOnceAndInTheBoxesAndOnePatchAboveIt) {
  RandomInputs random;
  for (const int nb_triangles : {1, 2, 3, 5, 31, 32, 33, 64, 200, 1000}) {
    TriangleMesh mesh;
    for (int t = 0; t < nb_triangles; ++t) {
      const Vector3d at = random.vector(-1.0, 1.0);
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      for (int k = 0; k < 3; ++k) mesh.vertices.push_back(at + random.vector(-0.1, 0.1));
      mesh.triangles.push_back({first, first + 1, first + 2});
    }
    const TriangleTree tree(mesh);
    TreeWalk walk{mesh, tree, {}, 0};
    walk.walk(0, false);
    EXPECT_EQ(walk.triangles.size(), mesh.triangles.size());
    EXPECT_EQ(std::set<std::uint32_t>(walk.triangles.begin(), walk.triangles.end()).size(),
              mesh.triangles.size());
    EXPECT_GE(walk.patches * TriangleTree::PATCH_TRIANGLES, mesh.triangles.size());
  }
}

}  // namespace collision_pairs::test_box_gap
