// What rviz is shown of a scene, and of the boxes of a report about it, where they stand.
#include <set>

#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "conversions.h"
#include "demo_scene.h"
#include "geometry_conversions.h"
#include "markers.h"
#include "random_inputs.h"
#include "scene_markers.h"
#include "test_shapes.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using visualization_msgs::Marker;

/// Boxes a and b that slide, something on a, and something static.
std::vector<Marker> drawn(const Shape& load, const Shape& fixed, Fidelity fidelity,
                          const SceneSettings& settings = {}) {
  SceneDescription description;
  description.settings = settings;
  description.robots.push_back({robotFrom(slidingBoxes(2)), std::nullopt, ""});
  RigidObject on_a, beside;
  on_a.name = "load";
  on_a.attached_link = "a";
  on_a.elements.push_back({load, Isometry3d::Identity()});
  beside.name = "beside";
  beside.elements.push_back({fixed, Isometry3d::Identity()});
  beside.X_PO.translation().z() = -1.0;
  description.objects = {on_a, beside};
  std::vector<Marker> markers;
  for (const Marker& marker :
       toSceneMarkers(*CollisionScene::build(description), fidelity, "world").markers) {
    if (marker.action == Marker::ADD) markers.push_back(marker);
  }
  return markers;
}

std::vector<Marker> of(const std::string& ns, const std::vector<Marker>& markers) {
  std::vector<Marker> found;
  for (const Marker& marker : markers) {
    if (marker.ns == ns) found.push_back(marker);
  }
  return found;
}

TEST(SceneMarkers, ABoxAlongAnElementsOwnAxesHoldsItWhereItIsDrawn) {
  TriangleMesh turned = LShape().mesh();
  const Eigen::AngleAxisd turn(0.5, Vector3d(1, 2, 3).normalized());
  for (Vector3d& p : turned.vertices) p = turn * p + Vector3d(0.4, 0, 0);
  const auto boxes = of("attached_objects", drawn(meshShape(turned), Sphere{0.1}, Fidelity::OBB));
  ASSERT_EQ(boxes.size(), 1u);
  Isometry3d X_LB;
  ASSERT_TRUE(toIsometry(boxes[0].pose, X_LB));
  const Vector3d half(0.5 * boxes[0].scale.x, 0.5 * boxes[0].scale.y, 0.5 * boxes[0].scale.z);
  for (const Vector3d& p_L : turned.vertices) {
    EXPECT_LE(((X_LB.inverse() * p_L).cwiseAbs() - half).maxCoeff(), 1e-9);
  }
  EXPECT_LT(half.maxCoeff(), 0.25) << "and is no larger than that takes";
}

TEST(SceneMarkers, SpheresEncloseTheMeshInPlaceOfWhichTheyAreDrawn) {
  const TriangleMesh mesh = LShape().mesh();
  const auto markers = drawn(meshShape(mesh), Capsule{0.1, 2.0}, Fidelity::SPHERES);
  EXPECT_EQ(of("standing", markers).size(), 3u) << "a capsule remains one";
  const auto lists = of("attached_objects", markers);
  ASSERT_EQ(lists.size(), 1u);
  ASSERT_EQ(lists[0].type, Marker::TRIANGLE_LIST);
  EXPECT_GT(lists[0].points.size(), 3u * 1000u);
  EXPECT_LT(lists[0].points.size(), 3u * 64u * 128u / 2u) << "those inside of others are left out";
  RandomInputs random;
  for (int i = 0; i < 1000; ++i) {
    const Vector3d direction = random.rotation() * Vector3d::UnitX();
    double of_mesh = -HUGE_VAL, of_spheres = -HUGE_VAL;
    for (const Vector3d& p : mesh.vertices) of_mesh = std::max(of_mesh, direction.dot(p));
    for (const auto& p : lists[0].points) {
      of_spheres = std::max(of_spheres, direction.dot(Vector3d(p.x, p.y, p.z)));
    }
    EXPECT_GT(of_spheres, of_mesh - 0.005) << "in between its corners a sphere is drawn smaller";
    EXPECT_LT(of_spheres, of_mesh + 0.05);
  }
}

/// How far a shape at X, or markers, reach along d.
double reachOf(const Shape& shape, const Isometry3d& X, const Vector3d& d) {
  const Vector3d along = X.linear().transpose() * d;
  const double across = std::hypot(along.x(), along.y());
  double reach = 0.0;
  if (const auto* box = std::get_if<Box>(&shape)) {
    reach = 0.5 * along.cwiseAbs().dot(box->size);
  } else if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    reach = sphere->radius;
  } else if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    reach = cylinder->radius * across + 0.5 * cylinder->length * std::abs(along.z());
  } else if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    reach = capsule->radius + 0.5 * capsule->length * std::abs(along.z());
  } else {
    reach = -std::numeric_limits<double>::infinity();
    for (const Vector3d& p : std::get<Mesh>(shape).mesh->vertices) {
      reach = std::max(reach, along.dot(p));
    }
  }
  return d.dot(X.translation()) + reach;
}

double reachOf(const std::vector<Marker>& markers, const Vector3d& d) {
  double reach = -std::numeric_limits<double>::infinity();
  for (const Marker& marker : markers) {
    Isometry3d X;
    EXPECT_TRUE(toIsometry(marker.pose, X));
    const Vector3d size(marker.scale.x, marker.scale.y, marker.scale.z);
    Shape shape = Box{size};
    if (marker.type == Marker::SPHERE) shape = Sphere{0.5 * size.x()};
    if (marker.type == Marker::CYLINDER) shape = Cylinder{0.5 * size.x(), size.z()};
    if (marker.type == Marker::TRIANGLE_LIST) {
      TriangleMesh mesh;
      for (const geometry_msgs::Point& p : marker.points) mesh.vertices.push_back(toVector(p));
      shape = Mesh{std::make_shared<const TriangleMesh>(mesh)};
    }
    reach = std::max(reach, reachOf(shape, X, d));
  }
  return reach;
}

TEST(SceneMarkers, ReachAsFarAsTheirShapeInEveryDirection) {
  RandomInputs random;
  for (int round = 0; round < 50; ++round) {
    const double radius = random.uniform(0.1, 0.5), length = random.uniform(0.6, 2.0);
    TriangleMesh mesh = LShape().mesh();
    for (Vector3d& p : mesh.vertices) p = p.cwiseProduct(Vector3d(0.3, 0.7, 1.1));
    const Shape shapes[] = {Box{random.vector(0.1, 2.0)}, Sphere{radius}, Cylinder{radius, length},
                            Capsule{radius, length}, meshShape(mesh)};
    for (const Shape& shape : shapes) {
      SceneDescription description;
      description.robots.push_back({robotFrom(slidingBoxes(2)), std::nullopt, ""});
      RigidObject object;
      object.name = "beside";
      object.X_PO = random.pose(2.0);
      object.elements.push_back({shape, random.pose(0.5)});
      description.objects = {object};
      const auto scene = CollisionScene::build(description);
      const auto shown = of("standing", toSceneMarkers(*scene, Fidelity::MESH, "world").markers);
      for (int i = 0; i < 10; ++i) {
        const Vector3d d = random.rotation() * Vector3d::UnitX();
        const double expected = reachOf(shape, object.X_PO * object.elements[0].X_LE, d);
        EXPECT_NEAR(reachOf(shown, d), expected, 1e-9) << shape.index();
      }
    }
  }
}

TEST(SceneMarkers, AFloorIsDrawnBelowItsSurface) {
  const auto floor = of("standing", drawn(Sphere{0.1}, HalfSpace{}, Fidelity::MESH));
  ASSERT_EQ(floor.size(), 1u);
  EXPECT_DOUBLE_EQ(floor[0].pose.position.z + 0.5 * floor[0].scale.z, -1.0);
}

TEST(SceneMarkers, BeginWithTheRobotBecauseAVastWorldIsNotDrawnWhole) {
  const auto markers = drawn(Sphere{0.1}, Sphere{0.1}, Fidelity::MESH);
  ASSERT_EQ(markers.size(), 4u);
  EXPECT_EQ(markers.back().ns, "standing");
}

/// Link a (a box), a mesh on it, a capsule and a floor.
std::shared_ptr<const CollisionScene> drawnScene() {
  SceneDescription description;
  description.robots.push_back({robotFrom(slidingBoxes(2)), std::nullopt, ""});
  RigidObject load;
  load.name = "load";
  load.attached_link = "a";
  const auto mesh = std::make_shared<const TriangleMesh>(LShape().mesh());
  load.elements.push_back({Mesh{mesh}, Isometry3d::Identity()});
  RigidObject pole;
  pole.name = "pole";
  pole.elements.push_back({Capsule{0.1, 2.0}, Isometry3d::Identity()});
  description.objects = {load, pole, floorAt(-1.0, {})};
  return CollisionScene::build(description);
}

TEST(SceneMarkers, ShowEachShapeInItsFrame) {
  const auto array = toSceneMarkers(*drawnScene(), Fidelity::MESH, "world");
  EXPECT_EQ(array.markers.front().action, Marker::DELETEALL);
  std::multiset<std::string> drawn;
  std::set<int> ids;
  for (const Marker& marker : array.markers) {
    if (marker.action != Marker::ADD) continue;
    drawn.insert(marker.ns + " " + marker.header.frame_id + " " + std::to_string(marker.type));
    EXPECT_EQ(marker.frame_locked, marker.ns != "standing");
    EXPECT_TRUE(ids.insert(marker.id).second);
  }
  const auto type = [](int value) { return " " + std::to_string(value); };
  EXPECT_EQ(drawn,
            (std::multiset<std::string>{
                "links a" + type(Marker::CUBE), "links b" + type(Marker::CUBE),
                "attached_objects a" + type(Marker::TRIANGLE_LIST),
                "standing world" + type(Marker::CYLINDER), "standing world" + type(Marker::SPHERE),
                "standing world" + type(Marker::SPHERE), "standing world" + type(Marker::CUBE)}));
}

TEST(SceneMarkers, ShowTheHullOrTheBoxWhereThatIsCompared) {
  const auto scene = drawnScene();
  const auto loadOf = [&](Fidelity fidelity) {
    for (const Marker& marker : toSceneMarkers(*scene, fidelity, "world").markers) {
      if (marker.ns == "attached_objects") return marker;
    }
    return Marker();
  };
  EXPECT_EQ(loadOf(Fidelity::OBB).type, Marker::CUBE);
  EXPECT_EQ(loadOf(Fidelity::AABB).type, Marker::CUBE);
  EXPECT_EQ(loadOf(Fidelity::CONVEX).type, Marker::TRIANGLE_LIST);
  EXPECT_EQ(loadOf(Fidelity::MESH).points.size(), 3 * LShape().mesh().triangles.size());
  EXPECT_LT(loadOf(Fidelity::CONVEX).points.size(), loadOf(Fidelity::MESH).points.size());
}

TEST(SceneMarkers, ShowALinkAsCoarselyAsItIsCompared) {
  SceneSettings settings;
  settings.link_fidelity = {{"load", Fidelity::OBB}};
  const auto markers = drawn(meshShape(LShape().mesh()), Box{{1, 1, 1}}, Fidelity::MESH, settings);
  EXPECT_EQ(markers.size(), 4u);
  for (const Marker& marker : markers) EXPECT_EQ(marker.type, Marker::CUBE) << marker.ns;
}

/// Of a report about the scene with all links at their root.
std::vector<Marker> boxesOf(const std::shared_ptr<const CollisionScene>& scene) {
  CollisionDetector detector(scene);
  BodyPoses poses;
  poses.resize(scene->bodies().size());
  CheckSettings settings;
  settings.list_boxes = true;
  const auto& report = detector.detect(poses, settings);
  const auto message = toMessage(report, *scene, settings, "world", ros::Time(7), {});
  std::vector<Marker> boxes;
  for (const Marker& marker : toMarkers(message, &report, false).markers) {
    if (marker.type == Marker::CUBE && marker.action == Marker::ADD) boxes.push_back(marker);
  }
  return boxes;
}

TEST(BoxMarkers, OfAFloorAreFinite) {
  const auto boxes = boxesOf(drawnScene());
  EXPECT_EQ(boxes.size(), 5u);
  for (const Marker& marker : boxes) {
    for (const double size : {marker.scale.x, marker.scale.y, marker.scale.z}) {
      EXPECT_GT(size, 0.0);
      EXPECT_LT(size, 100.0);
    }
  }
}

TEST(BoxMarkers, OfWhatIsFlatAreDrawable) {
  const auto boxes = boxesOf(
      CollisionScene::build(robotFrom(linkWith("root", "<box size='1 1 0'/>") + boxLink("a", 1.0) +
                                      joint("j", "floating", "root", "a", "0 0 0", "")),
                            Srdf{}, nullptr));
  EXPECT_EQ(boxes.size(), 2u);
  for (const Marker& marker : boxes) {
    EXPECT_GE(marker.scale.z, 1e-6);  // rviz shows nothing where an edge has no length
  }
}

}  // namespace
}  // namespace collision_pairs
