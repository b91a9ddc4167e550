// What the shapes of an object in a message become, and which are refused.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry_conversions.h"
#include "object_conversions.h"
#include "object_messages.h"
#include "random_inputs.h"
#include "refusal.h"
#include "test_shapes.h"

namespace collision_pairs::test_object_conversions {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using shape_msgs::SolidPrimitive;
using testing::AllOf;
using testing::HasSubstr;

std::string refusalOf(const SceneObject& object) {
  return refusal([&] { toObject(object, noMeshLoader()); });
}

TEST(ObjectOfAMessage, HasItsShapesWhereTheyAre) {
  SceneObject message = boxObject("thing", poseAt(0, 0, 0));
  message.primitives.push_back(primitive(SolidPrimitive::SPHERE, {0.5}));
  message.primitives.push_back(primitive(SolidPrimitive::CYLINDER, {2.0, 0.25}));
  message.primitive_poses = {poseAt(0, 0, 0), poseAt(1, 0, 0), poseAt(0, 2, 0)};
  message.padding = 0.1;
  message.touch_links = {"a"};
  const RigidObject object = toObject(message, noMeshLoader());
  ASSERT_EQ(object.elements.size(), 3u);
  EXPECT_EQ(std::get<Box>(object.elements[0].shape).size, Vector3d(1, 2, 3));
  EXPECT_EQ(std::get<Sphere>(object.elements[1].shape).radius, 0.5);
  EXPECT_EQ(object.elements[1].X_LE.translation(), Vector3d(1, 0, 0));
  EXPECT_EQ(std::get<Cylinder>(object.elements[2].shape).length, 2.0);
  EXPECT_EQ(std::get<Cylinder>(object.elements[2].shape).radius, 0.25);
  EXPECT_EQ(object.padding, 0.1);
  EXPECT_EQ(object.touch_links, (std::vector<std::string>{"a"}));
}

TEST(ObjectOfAMessage, AMeshKeepsItsHollows) {
  const TriangleMesh l = LShape().mesh();
  SceneObject message;
  message.name = "l";
  message.meshes = {messageOf(l)};
  message.mesh_poses = {poseAt(1, 2, 3)};
  const RigidObject object = toObject(message, noMeshLoader());
  ASSERT_EQ(object.elements.size(), 1u);
  const auto* mesh = std::get_if<Mesh>(&object.elements[0].shape);
  ASSERT_TRUE(mesh) << "it is not said to be convex";
  EXPECT_EQ(object.elements[0].X_LE.translation(), Vector3d(1, 2, 3));
  EXPECT_EQ(mesh->mesh->name, "mesh of a message");
  EXPECT_EQ(mesh->mesh->vertices, l.vertices);
  EXPECT_EQ(mesh->mesh->triangles, l.triangles);
}

TEST(ObjectOfAMessage, ConeLiesWithinItsPyramidAndIsHardlyNarrower) {
  SceneObject message;
  message.primitives = {primitive(SolidPrimitive::CONE, {0.6, 0.2})};
  const RigidObject object = toObject(message, noMeshLoader());
  const auto& hull = std::get<Convex>(object.elements.front().shape);
  const Vector3d lower(0, 0, -0.3), upper(0, 0, 0.3);
  double widest = 0.0;
  for (const Vector3d& p : hull.mesh->vertices) widest = std::max(widest, p.head<2>().norm());
  EXPECT_LT(widest, 0.2 * 1.0013);
  // Every side of the pyramid is at least the radius away from the axis.
  const auto& corners = hull.mesh->vertices;
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const Vector3d& next = corners[(i + 1) % (corners.size() - 1)];
    EXPECT_GE((0.5 * (corners[i] + next)).head<2>().norm(), 0.2 * (1.0 - 1e-12));
  }
  ASSERT_EQ(corners.size(), 64u + 1u);
  const double side = 2.0 * 0.2 * std::tan(EIGEN_PI / 64.0);
  for (std::size_t i = 0; i < 64; ++i) {
    EXPECT_NEAR((corners[i] - corners[(i + 1) % 64]).norm(), side, 1e-12);
  }
  EXPECT_EQ(hull.mesh->name, "cone");
  EXPECT_TRUE(corners.back().isApprox(upper));
  EXPECT_DOUBLE_EQ(corners.front().z(), lower.z());
}

TEST(ObjectOfAMessage, PlaneIsSolidBehind) {
  RandomInputs random;
  for (int round = 0; round < 100; ++round) {
    shape_msgs::Plane plane;
    for (double& c : plane.coef) c = random.uniform(-2, 2);
    SceneObject message;
    message.planes = {plane};
    const Isometry3d X_OE = toObject(message, noMeshLoader()).elements.front().X_LE;
    const Vector3d normal(plane.coef[0], plane.coef[1], plane.coef[2]);
    EXPECT_TRUE(X_OE.linear().isUnitary(1e-12));
    for (int i = 0; i < 10; ++i) {
      const Vector3d p = random.vector(-3, 3);
      const double side = (normal.dot(p) + plane.coef[3]) / normal.norm();
      EXPECT_NEAR((X_OE.inverse() * p).z(), side, 1e-12);
    }
  }
}

TEST(ObjectOfAMessage, PoseOfAPlaneMovesThePlane) {
  RandomInputs random;
  shape_msgs::Plane plane;
  plane.coef = {0.0, 0.0, 1.0, -2.0};  // z = 2
  for (int round = 0; round < 20; ++round) {
    const Isometry3d X_OP = random.pose(1.0);
    SceneObject message;
    message.planes = {plane};
    message.plane_poses = {toPose(X_OP)};
    const Isometry3d X_OE = toObject(message, noMeshLoader()).elements.front().X_LE;
    const Vector3d on_plane(random.uniform(-3, 3), random.uniform(-3, 3), 2.0);
    EXPECT_NEAR((X_OE.inverse() * X_OP * on_plane).z(), 0.0, 1e-12);
  }
}

TEST(ObjectOfAMessage, PlaneThatFacesDownIsAsExactAsOneThatFacesUp) {
  const Vector3d p(5, 2, 1);
  for (const double slope : {0.0, 1e-7, 1e-6, 1.5e-6, 1e-5, 1e-4, 1e-3}) {
    for (const double c : {-1.0, 1.0}) {
      shape_msgs::Plane plane;
      plane.coef = {slope, 0.0, c, 3.0};
      SceneObject message;
      message.planes = {plane};
      const Isometry3d X_OH = toObject(message, noMeshLoader()).elements.front().X_LE;
      const double side = (slope * p.x() + c * p.z() + 3.0) / std::hypot(slope, c);
      EXPECT_NEAR((X_OH.inverse() * p).z(), side, 1e-14) << slope << " " << c;
      EXPECT_LT((X_OH.linear().transpose() * X_OH.linear() - Eigen::Matrix3d::Identity()).norm(),
                1e-14);
    }
  }
}

TEST(ObjectOfAMessage, WhatIsWrongIsNamed) {
  const auto with = [](const auto& spoil) {
    SceneObject object = boxObject("thing", poseAt(0, 0, 0));
    spoil(object);
    return refusalOf(object);
  };
  EXPECT_THAT(with([](SceneObject& o) { o.primitives[0].dimensions.pop_back(); }),
              AllOf(HasSubstr("primitives[0]"), HasSubstr("2 dimensions, but needs 3: x, y, z")));
  EXPECT_THAT(with([](SceneObject& o) { o.primitives[0].dimensions[1] = -1; }),
              HasSubstr("primitives[0]"));
  EXPECT_THAT(with([](SceneObject& o) { o.primitives[0].type = 9; }),
              HasSubstr("type 9 is unknown"));
  EXPECT_THAT(with([](SceneObject& o) { o.primitive_poses.resize(1); }),
              HasSubstr("pose is invalid"));
  EXPECT_THAT(with([](SceneObject& o) { o.primitive_poses.resize(2); }),
              HasSubstr("1 entries, but 2 poses"));
  EXPECT_THAT(with([](SceneObject& o) { o.meshes.resize(1); }), HasSubstr("meshes[0]"));
  EXPECT_THAT(with([](SceneObject& o) { o.mesh_resources = {"file:///nowhere.stl"}; }),
              AllOf(HasSubstr("mesh_resources[0]"), HasSubstr("no such file")));
  EXPECT_THAT(with([](SceneObject& o) { o.planes.resize(1); }), HasSubstr("do not define a plane"));
}

TEST(ObjectOfAMessage, WhatAShapeNeedsIsSaid) {
  const std::tuple<int, std::string, std::string> all[] = {
      {SolidPrimitive::BOX, "a box", "3: x, y, z"},
      {SolidPrimitive::SPHERE, "a sphere", "1: radius"},
      {SolidPrimitive::CYLINDER, "a cylinder", "2: height, radius"},
      {SolidPrimitive::CONE, "a cone", "2: height, radius"}};
  for (const auto& [type, shape, needs] : all) {
    SceneObject message = boxObject("thing", poseAt(0, 0, 0));
    message.primitives.push_back(primitive(static_cast<std::uint8_t>(type), {1, 2, 3, 4}));
    EXPECT_EQ(refusalOf(message),
              "primitives[1]: " + shape + " has 4 dimensions, but needs " + needs);
  }
  for (const auto& sizes : {std::vector<double>{-0.1, 1.0}, {1.0, -0.1}, {std::nan(""), 1.0}}) {
    SceneObject message;
    message.primitives = {primitive(SolidPrimitive::CONE, sizes)};
    EXPECT_EQ(refusalOf(message), "primitives[0]: a cone's size is negative or not finite");
  }
  for (const auto& sizes : {std::vector<double>{0.0, 1.0}, {1.0, 0.0}}) {
    SceneObject message;
    message.primitives = {primitive(SolidPrimitive::CONE, sizes)};
    EXPECT_EQ(refusalOf(message).find("negative"), std::string::npos);
  }
  for (const double spoilt : {0.0, HUGE_VAL}) {
    for (int i = 0; i < 4; ++i) {
      SceneObject message;
      message.planes.resize(1);
      message.planes[0].coef = {0.0, 0.0, 0.0, 0.0};
      message.planes[0].coef[3 - i] = 1.0;
      message.planes[0].coef[i] = spoilt;
      const bool is_plane = spoilt == 0.0 && i > 0;
      EXPECT_EQ(refusalOf(message) == "accepted", is_plane) << spoilt << ' ' << i;
    }
  }
}

TEST(ObjectOfAMessage, HasItsNameItsLinkAndTheFilesOfItsMeshes) {
  SceneObject message;
  message.name = "thing";
  message.attached_link = "hand";
  message.mesh_resources = {"package://a/b.stl", "package://a/c.stl"};
  message.mesh_resource_poses = {poseAt(0, 0, 0), poseAt(1, 2, 3)};
  std::vector<std::string> uris;
  const RigidObject object = toObject(message, [&](const std::string& uri, const Vector3d& scale) {
    EXPECT_EQ(scale, Vector3d::Ones());
    uris.push_back(uri);
    return std::make_shared<const TriangleMesh>(LShape().mesh());
  });
  EXPECT_EQ(object.name, "thing");
  EXPECT_EQ(object.attached_link, "hand");
  ASSERT_EQ(object.elements.size(), 2u);
  EXPECT_EQ(object.elements[1].X_LE.translation(), Vector3d(1, 2, 3));
  EXPECT_EQ(std::vector<std::string>(message.mesh_resources), uris);
}

}  // namespace collision_pairs::test_object_conversions
