// Shapes of MoveIt, and what is read of octrees.
#include <algorithm>
#include <sstream>

#include <geometric_shapes/shapes.h>
#include <gmock/gmock.h>
#include <octomap/OcTree.h>

#include "collision_pairs/input_error.h"
#include "moveit_octree.h"
#include "moveit_shapes.h"
#include "random_inputs.h"

namespace collision_pairs::test_moveit_shapes {

using Eigen::Isometry3d;
using Eigen::Translation3d;
using testing::ElementsAre;
using testing::IsEmpty;

TEST(Shapes, BecomeElementsInTheirPlaces) {
  MoveitShapes shapes;
  std::vector<Element> elements;
  const Isometry3d X_ME(Translation3d(1.0, 2.0, 3.0));
  shapes.append(std::make_shared<shapes::Box>(1.0, 2.0, 3.0), 2.0, X_ME, elements);
  shapes.append(std::make_shared<shapes::Cylinder>(1.0, 3.0), 2.0, X_ME, elements);
  shapes.append(std::make_shared<shapes::Sphere>(1.0), 2.0, X_ME, elements);
  shapes.append(std::make_shared<shapes::Cone>(1.0, 3.0), 2.0, X_ME, elements);
  ASSERT_EQ(elements.size(), 4u);
  EXPECT_EQ(std::get<Box>(elements[0].shape).size, Eigen::Vector3d(2.0, 4.0, 6.0));
  EXPECT_EQ(std::get<Cylinder>(elements[1].shape).radius, 2.0);
  EXPECT_EQ(std::get<Cylinder>(elements[1].shape).length, 6.0);
  EXPECT_EQ(std::get<Sphere>(elements[2].shape).radius, 2.0);
  EXPECT_EQ(std::get<Convex>(elements[3].shape).mesh->vertices.back(), Eigen::Vector3d(0, 0, 3));
  for (const Element& element : elements) EXPECT_EQ(element.X_LE.matrix(), X_ME.matrix());
  const auto plane = std::make_shared<shapes::Plane>(0.0, 0.0, 1.0, 0.0);
  EXPECT_THROW(shapes.append(plane, 1.0, X_ME, elements), InputError);
}

TEST(Shapes, ShareTheTrianglesOfAMeshUnlessItIsScaled) {
  auto mesh = std::make_shared<shapes::Mesh>(3, 1);
  for (unsigned i = 0; i < 9; ++i) mesh->vertices[i] = i * i;
  for (unsigned i = 0; i < 3; ++i) mesh->triangles[i] = i;
  MoveitShapes shapes;
  std::vector<Element> elements;
  for (const double scale : {1.0, 1.0, 3.0}) {
    shapes.append(mesh, scale, Isometry3d::Identity(), elements);
  }
  const auto triangles = [&](int i) { return std::get<Mesh>(elements[i].shape).mesh; };
  EXPECT_EQ(triangles(0), triangles(1));
  EXPECT_EQ(triangles(0)->vertices[1], Eigen::Vector3d(9, 16, 25));
  EXPECT_THAT(triangles(0)->triangles[0], ElementsAre(0, 1, 2));
  EXPECT_NEAR((triangles(2)->vertices[1] - triangles(2)->vertices[0]).norm(),
              3.0 * (triangles(0)->vertices[1] - triangles(0)->vertices[0]).norm(), 1e-9);
}

TEST(Shapes, AreAlikeIfTheirNumbersAre) {
  const auto tree = std::make_shared<octomap::OcTree>(0.5);
  const auto mesh = [](double x, unsigned last) {
    auto made = std::make_shared<shapes::Mesh>(4, 1);
    std::fill(made->vertices, made->vertices + 12, 1.0);
    made->vertices[0] = x;
    for (unsigned i = 0; i < 3; ++i) made->triangles[i] = i;
    made->triangles[2] = last;
    return made;
  };
  const auto make = [&] {  // none like another
    return std::vector<shapes::ShapeConstPtr>{std::make_shared<shapes::Sphere>(1.0),
                                              std::make_shared<shapes::Sphere>(2.0),
                                              std::make_shared<shapes::Cylinder>(1.0, 2.0),
                                              std::make_shared<shapes::Cylinder>(1.0, 3.0),
                                              std::make_shared<shapes::Cylinder>(2.0, 2.0),
                                              std::make_shared<shapes::Cone>(1.0, 2.0),
                                              std::make_shared<shapes::Cone>(1.0, 3.0),
                                              std::make_shared<shapes::Cone>(2.0, 2.0),
                                              std::make_shared<shapes::Box>(1.0, 2.0, 3.0),
                                              std::make_shared<shapes::Box>(1.0, 2.0, 4.0),
                                              mesh(0.0, 2),
                                              mesh(1.0, 2),
                                              mesh(0.0, 3),
                                              std::make_shared<shapes::OcTree>(tree),
                                              std::make_shared<shapes::OcTree>()};
  };
  const auto some = make(), others = make();
  for (std::size_t i = 0; i < some.size(); ++i) {
    for (std::size_t j = 0; j < some.size(); ++j) {
      EXPECT_EQ(areAlike(some[i], others[j]), i == j) << i << ' ' << j;
    }
  }
}

TEST(AnOctree, IsItsOccupiedLeavesOfAnySize) {
  octomap::OcTree tree(0.5);
  for (double x : {0.25, 0.75}) {
    for (double y : {0.25, 0.75}) {
      for (double z : {0.25, 0.75}) tree.updateNode(octomap::point3d(x, y, z), true);
    }
  }
  tree.updateNode(octomap::point3d(5.25f, 0.25f, 0.25f), true);
  tree.updateNode(octomap::point3d(-5.25f, 0.25f, 0.25f), false);
  tree.prune();
  const std::vector<OctreeLeaf> leaves = occupiedLeaves(tree);
  EXPECT_THAT(leaves,
              testing::UnorderedElementsAre(OctreeLeaf{1, {0, 0, 0}}, OctreeLeaf{0, {10, 0, 0}}));
  tree.updateNode(octomap::point3d(0.25f, 0.25f, 0.25f), false);
  EXPECT_FALSE(occupiedLeaves(tree) == leaves);
  tree.clear();
  EXPECT_THAT(occupiedLeaves(tree), IsEmpty());
}

std::vector<OctreeLeaf> leavesByOctomap(const octomap::OcTree& tree) {
  std::vector<OctreeLeaf> leaves;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    if (!tree.isNodeOccupied(*leaf)) continue;
    const Eigen::Vector3d center(leaf.getX(), leaf.getY(), leaf.getZ());
    leaves.push_back({16 - static_cast<int>(leaf.getDepth()),
                      (center / leaf.getSize()).array().floor().cast<int>()});
  }
  return leaves;
}

Aabb boxOf(const OctreeLeaf& leaf, double resolution) {
  const double edge = edgeOfLeaf(resolution, leaf.level);
  return {edge * leaf.cell.cast<double>(), edge * (leaf.cell.array() + 1).cast<double>().matrix()};
}

TEST(AnOctree, ShowsTheLeavesWithinReachOfBoxesAsItIsNow) {
  constexpr double RESOLUTION = 0.07;
  RandomInputs random;
  octomap::OcTree tree(RESOLUTION);
  std::size_t nb_within = 0, nb_beyond = 0;
  for (int round = 0; round < 300; ++round) {
    for (int i = random.integer(0, 30); i > 0; --i) {
      const auto at = [&] { return 0.07f * (0.5f + static_cast<float>(random.integer(-5, 4))); };
      const octomap::point3d centre(at(), at(), at());
      tree.setNodeValue(centre, random.integer(0, 3) ? 1.0f : -1.0f);
    }
    if (random.integer(0, 2) == 0) tree.prune();
    const std::vector<OctreeLeaf> leaves = occupiedLeaves(tree);
    ASSERT_EQ(leaves, leavesByOctomap(tree));
    std::vector<Aabb> boxes = {noBox()};
    for (int i = random.integer(0, 3); i > 0; --i) {
      Eigen::Vector3d low, size;
      for (int k = 0; k < 3; ++k) {  // some end at faces of leaves
        low[k] = RESOLUTION * (random.integer(-7, 6) + (random.integer(0, 1) ? 0.0 : 0.3));
        size[k] = RESOLUTION * random.integer(0, 3);
      }
      boxes.push_back({low, low + size});
    }
    const double reach = random.integer(0, 1) ? 0.0 : RESOLUTION;
    const std::vector<OctreeLeaf> within = leavesWithin(tree, boxes, reach);
    std::size_t next = 0;
    for (const OctreeLeaf& leaf : leaves) {  // in the same order
      const bool is_within = next < within.size() && within[next] == leaf;
      next += is_within;
      const bool must_be = std::any_of(boxes.begin(), boxes.end(), [&](const Aabb& box) {
        return box.valid() && squaredGap(box, boxOf(leaf, RESOLUTION)) <= squaredReach(reach);
      });
      ASSERT_TRUE(is_within || !must_be) << "round " << round;
      ++(is_within ? nb_within : nb_beyond);
    }
    ASSERT_EQ(next, within.size()) << "and no others";
  }
  EXPECT_GT(nb_within, 500u);
  EXPECT_GT(nb_beyond, 500u);
}

TEST(AnOctree, ThatIsOneLeafIsEight) {
  octomap::OcTree tree(0.5);
  const float log_odds = 1.0f;
  std::stringstream file;  // the root's value, and no children
  file.write(reinterpret_cast<const char*>(&log_odds), sizeof log_odds).put('\0');
  tree.readData(file);
  ASSERT_EQ(tree.size(), 1u);
  const std::vector<OctreeLeaf> leaves = occupiedLeaves(tree);
  ASSERT_EQ(leaves.size(), 8u);
  EXPECT_EQ(boxOf(leaves[0], 0.5).min, Eigen::Vector3d::Constant(-16384.0));
  EXPECT_EQ(boxOf(leaves[7], 0.5).max, Eigen::Vector3d::Constant(16384.0));
}

TEST(OctreesAmongShapes, AreKnownByTheirLeavesNow) {
  const auto first = std::make_shared<octomap::OcTree>(0.5);
  const auto second = std::make_shared<octomap::OcTree>(0.5);
  const octomap::point3d centre(0.25f, 0.25f, 0.25f);
  first->updateNode(centre, true);
  const std::vector<shapes::ShapeConstPtr> parts = {
      std::make_shared<shapes::OcTree>(first), std::make_shared<shapes::Sphere>(1.0),
      std::make_shared<shapes::OcTree>(second), std::make_shared<shapes::OcTree>()};
  const auto leaves = leavesOf(parts);
  EXPECT_THAT(leavesOf({parts[1]}), IsEmpty());
  EXPECT_EQ(leaves.size(), 3u);
  EXPECT_NE(leavesOf({parts[2], parts[0], parts[3]}), leaves) << "the other one has the leaf";
  second->updateNode(centre, true);
  EXPECT_NE(leavesOf(parts), leaves);
  second->clear();
  EXPECT_EQ(leavesOf(parts), leaves);
  first->setResolution(0.25);
  EXPECT_NE(leavesOf(parts), leaves);
}

}  // namespace collision_pairs::test_moveit_shapes
