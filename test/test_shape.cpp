#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "collision_pairs/shape.h"

namespace collision_pairs::test_shape {

std::string shapeRefusal(const Shape& shape) {
  try {
    validateShape(shape);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

std::shared_ptr<TriangleMesh> triangle() {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh->triangles = {{0, 1, 2}};
  mesh->name = "one.stl";
  return mesh;
}

TEST(Shape, OfNoSizeIsAccepted) {
  EXPECT_EQ(shapeRefusal(Box{{0, 1, 2}}), "");
  EXPECT_EQ(shapeRefusal(Cylinder{0, 0}), "");
  EXPECT_EQ(shapeRefusal(Mesh{triangle()}), "");
}

TEST(Shape, WithAnySizeNegativeOrNotFiniteIsRefusedByName) {
  using testing::HasSubstr;
  for (const double bad :
       {-1.0, -1e-300, static_cast<double>(NAN), static_cast<double>(INFINITY)}) {
    for (int i = 0; i < 3; ++i) {
      Box box{{1, 2, 3}};
      box.size[i] = bad;
      EXPECT_THAT(shapeRefusal(box), HasSubstr("box")) << "size " << i << ": " << bad;
    }
    EXPECT_THAT(shapeRefusal(Sphere{bad}), HasSubstr("sphere: the radius")) << bad;
    EXPECT_THAT(shapeRefusal(Cylinder{bad, 1}), HasSubstr("cylinder: the radius")) << bad;
    EXPECT_THAT(shapeRefusal(Cylinder{1, bad}), HasSubstr("cylinder: the length")) << bad;
    EXPECT_THAT(shapeRefusal(Capsule{bad, 1}), HasSubstr("capsule: the radius")) << bad;
    EXPECT_THAT(shapeRefusal(Capsule{1, bad}), HasSubstr("capsule: the length")) << bad;
  }
}

TEST(Shape, MeshNamesItsBadVertexOrTriangle) {
  for (int i = 0; i < 3; ++i) {
    auto broken = triangle();
    broken->vertices[i][i] = NAN;
    const std::string vertex = "vertex " + std::to_string(i) + " is not finite";
    EXPECT_THAT(shapeRefusal(Mesh{broken}), testing::HasSubstr("mesh 'one.stl': " + vertex));
    EXPECT_THAT(shapeRefusal(Convex{broken}), testing::HasSubstr("convex 'one.stl': " + vertex));
    broken = triangle();
    broken->triangles.push_back({0, 1, 2});
    broken->triangles[i / 2][i] = 3;
    EXPECT_THAT(shapeRefusal(Mesh{broken}), testing::HasSubstr("triangle " + std::to_string(i / 2) +
                                                               " refers to vertex 3 of 3"));
  }
  auto broken = triangle();
  broken->triangles.clear();
  EXPECT_THAT(shapeRefusal(Mesh{broken}), testing::HasSubstr("no triangle"));
  EXPECT_THAT(shapeRefusal(Convex{std::make_shared<TriangleMesh>()}),
              testing::HasSubstr("no vertex"));
}

}  // namespace collision_pairs::test_shape
