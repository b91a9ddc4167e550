// Objects in messages, and what changes make of them: no master needed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "collision_pairs/input_error.h"
#include "demo_scene.h"
#include "geometry_conversions.h"
#include "object_conversions.h"
#include "random_inputs.h"
#include "scene_updates.h"
#include "test_shapes.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using shape_msgs::SolidPrimitive;
using testing::AllOf;
using testing::HasSubstr;

geometry_msgs::Pose poseAt(double x, double y, double z) {
  geometry_msgs::Pose pose;
  pose.position.x = x;
  pose.position.y = y;
  pose.position.z = z;
  pose.orientation.w = 1.0;
  return pose;
}

SolidPrimitive primitive(std::uint8_t type, const std::vector<double>& dimensions) {
  SolidPrimitive solid;
  solid.type = type;
  solid.dimensions.assign(dimensions.begin(), dimensions.end());
  return solid;
}

SceneObject boxObject(const std::string& name, const geometry_msgs::Pose& pose) {
  SceneObject object;
  object.name = name;
  object.pose = pose;
  object.primitives = {primitive(SolidPrimitive::BOX, {1, 2, 3})};
  return object;
}

MeshLoader noMeshLoader() {
  return [](const std::string& uri, const Vector3d&) -> std::shared_ptr<const TriangleMesh> {
    throw InputError("mesh '" + uri + "': there is no such file");
  };
}

std::string refusal(const SceneObject& object) {
  try {
    toObject(object, noMeshLoader());
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
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
  message.meshes.resize(1);
  message.mesh_poses = {poseAt(0, 0, 0)};
  for (const Vector3d& p : l.vertices) message.meshes[0].vertices.push_back(toPoint(p));
  for (const auto& t : l.triangles) {
    shape_msgs::MeshTriangle triangle;
    std::copy(t.begin(), t.end(), triangle.vertex_indices.begin());
    message.meshes[0].triangles.push_back(triangle);
  }
  const RigidObject object = toObject(message, noMeshLoader());
  ASSERT_EQ(object.elements.size(), 1u);
  const auto* mesh = std::get_if<Mesh>(&object.elements[0].shape);
  ASSERT_TRUE(mesh) << "it is not said to be convex";
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
    return refusal(object);
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

/// A world in which frame "hand" stands at x = 1, turned by a quarter about z.
class Changes : public testing::Test {
 protected:
  Changes() {
    X_WH_.translation().x() = 1.0;
    X_WH_.linear() = Eigen::AngleAxisd(EIGEN_PI / 2, Vector3d::UnitZ()).toRotationMatrix();
    context_.world_frame = "world";
    context_.load_mesh = noMeshLoader();
    context_.look_up = [this](const std::string& target, const std::string& source,
                              const ros::Time&) -> Isometry3d {
      if (target == "world" && source == "hand") return X_WH_;
      if (target == "hand" && source == "world") return X_WH_.inverse();
      throw InputError("TF does not know '" + source + "'");
    };
  }

  void apply(std::uint8_t operation, const SceneObject& object) {
    SceneChange change;
    change.operation = operation;
    change.object = object;
    collision_pairs::apply(editsBy({change}, objects_, context_), objects_);
  }

  std::string refusalOf(std::uint8_t operation, const SceneObject& object) {
    try {
      apply(operation, object);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }

  const RigidObject& stored(const std::string& name) { return objects_.at(name).object; }

  Isometry3d X_WH_ = Isometry3d::Identity();
  UpdateContext context_;
  SceneObjects objects_;
};

TEST_F(Changes, APoseIsOfItsFrame) {
  SceneObject object = boxObject("crate", poseAt(0, 0.5, 0));
  apply(SceneChange::ADD, object);
  EXPECT_EQ(stored("crate").X_PO.translation(), Vector3d(0, 0.5, 0));
  object.header.frame_id = "/hand";
  apply(SceneChange::MOVE, object);
  EXPECT_TRUE(stored("crate").X_PO.translation().isApprox(Vector3d(0.5, 0, 0)));
}

TEST_F(Changes, AttachAndDetachLeaveItWhereItIs) {
  apply(SceneChange::ADD, boxObject("crate", poseAt(3, 1, 0)));
  SceneObject grip;
  grip.name = "crate";
  grip.attached_link = "hand";
  grip.touch_links = {"finger"};
  apply(SceneChange::ATTACH, grip);
  EXPECT_EQ(stored("crate").attached_link, "hand");
  EXPECT_EQ(stored("crate").touch_links, grip.touch_links);
  EXPECT_TRUE((X_WH_ * stored("crate").X_PO).translation().isApprox(Vector3d(3, 1, 0)));
  X_WH_.translation().x() = 5.0;  // it moves along
  apply(SceneChange::DETACH, grip);
  EXPECT_EQ(stored("crate").attached_link, "");
  EXPECT_TRUE(stored("crate").X_PO.translation().isApprox(Vector3d(7, 1, 0)));
}

TEST_F(Changes, WhatMayTouchItEndsWhenItIsDetached) {
  apply(SceneChange::ADD, boxObject("crate", poseAt(3, 1, 0)));
  SceneObject grip;
  grip.name = "crate";
  grip.attached_link = "hand";
  grip.touch_links = {"finger"};
  apply(SceneChange::ATTACH, grip);
  grip.touch_links.clear();
  apply(SceneChange::DETACH, grip);
  EXPECT_TRUE(stored("crate").touch_links.empty());
  grip.touch_links = {"finger"};
  apply(SceneChange::ATTACH, grip);
  grip.touch_links = {"table"};
  apply(SceneChange::DETACH, grip);
  EXPECT_EQ(stored("crate").touch_links, grip.touch_links);
}

TEST_F(Changes, TheListSaysWhereEachIs) {
  apply(SceneChange::ADD, boxObject("b", poseAt(1, 0, 0)));
  apply(SceneChange::ADD, boxObject("a", poseAt(2, 0, 0)));
  SceneObject grip;
  grip.name = "a";
  grip.attached_link = "hand";
  apply(SceneChange::ATTACH, grip);
  const auto list = listed(objects_, "world");
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[0].name, "a");
  EXPECT_EQ(list[0].header.frame_id, "hand");
  EXPECT_NEAR(list[0].pose.position.y, -1.0, 1e-12);
  EXPECT_EQ(list[1].header.frame_id, "world");
  EXPECT_EQ(list[1].pose.position.x, 1.0);
  EXPECT_EQ(list[1].primitives.size(), 1u);
  apply(SceneChange::REMOVE, grip);
  EXPECT_EQ(listed(objects_, "world").size(), 1u);
  apply(SceneChange::CLEAR, SceneObject());
  EXPECT_TRUE(objects_.empty());
}

TEST_F(Changes, WhatIsRemovedIsInNobodysTouchLinks) {
  SceneObject lid = boxObject("lid", poseAt(0, 0, 1));
  lid.touch_links = {"pot", "hand"};
  apply(SceneChange::ADD, lid);
  apply(SceneChange::ADD, boxObject("pot", poseAt(0, 0, 0)));
  apply(SceneChange::REMOVE, boxObject("pot", poseAt(0, 0, 0)));
  EXPECT_EQ(stored("lid").touch_links, (std::vector<std::string>{"hand"}));
}

TEST_F(Changes, WhatIsWrongIsNamedAndNothingIsChanged) {
  apply(SceneChange::ADD, boxObject("crate", poseAt(0, 0, 0)));
  SceneObject object = boxObject("crat", poseAt(0, 0, 0));
  EXPECT_THAT(refusalOf(SceneChange::MOVE, object),
              AllOf(HasSubstr("changes[0], object 'crat'"), HasSubstr("did you mean 'crate'?")));
  EXPECT_THAT(refusalOf(SceneChange::ATTACH, object), HasSubstr("no such object"));
  EXPECT_THAT(refusalOf(77, object), HasSubstr("operation 77 is unknown"));
  object.pose.orientation.w = 0.0;
  EXPECT_THAT(refusalOf(SceneChange::ADD, object), HasSubstr("its pose is invalid"));
  object.pose = poseAt(0, 0, std::nan(""));
  EXPECT_THAT(refusalOf(SceneChange::ADD, object), HasSubstr("its pose is invalid"));
  object.pose = poseAt(0, 0, 0);
  object.header.frame_id = "elsewhere";
  EXPECT_THAT(refusalOf(SceneChange::ADD, object), HasSubstr("'elsewhere'"));
  object.name.clear();
  EXPECT_THAT(refusalOf(SceneChange::ADD, object), HasSubstr("it has no name"));
  object.name = "crate";
  EXPECT_THAT(refusalOf(SceneChange::ATTACH, object), HasSubstr("attached_link is empty"));
  EXPECT_THAT(refusalOf(SceneChange::DETACH, object), HasSubstr("not attached"));
  EXPECT_EQ(objects_.size(), 1u);
  EXPECT_EQ(stored("crate").X_PO.matrix(), Isometry3d::Identity().matrix());
}

}  // namespace
}  // namespace collision_pairs
