// What rviz is shown of a scene, and of the boxes of a report about it, where they stand.
#include <array>
#include <set>

#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "conversions.h"
#include "demo_scene.h"
#include "geometry_conversions.h"
#include "markers.h"
#include "printed.h"
#include "random_inputs.h"
#include "scene_markers.h"
#include "sphere_cover.h"
#include "test_shapes.h"

namespace collision_pairs::test_scene_markers {

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
      const auto hull = of("standing", toSceneMarkers(*scene, Fidelity::CONVEX, "world").markers);
      for (int i = 0; i < 10; ++i) {
        const Vector3d d = random.rotation() * Vector3d::UnitX();
        const double expected = reachOf(shape, object.X_PO * object.elements[0].X_LE, d);
        EXPECT_NEAR(reachOf(shown, d), expected, 1e-9) << shape.index();
        EXPECT_NEAR(reachOf(hull, d), expected, 1e-6) << shape.index();
      }
    }
  }
}

TEST(SceneMarkers, HaveTheirPlaceSizeAndColour) {
  SceneDescription description;
  description.robots.push_back(
      {robotFrom(linkWith("base", "<box size='1 2 3'/>", "<origin xyz='4 5 6'/>")), Srdf(), ""});
  const Isometry3d X_PE = Isometry3d(Eigen::Translation3d(1, 2, 3)) *
                          Eigen::AngleAxisd(EIGEN_PI / 2, Vector3d::UnitX());
  RigidObject load, beside;
  load.name = "load";
  load.attached_link = "base";
  load.elements.push_back({Sphere{0.25}, X_PE});
  beside.name = "beside";
  beside.elements = {{Cylinder{0.5, 8.0}, X_PE},
                     {Capsule{0.125, 6.0}, X_PE},
                     {HalfSpace{}, X_PE},
                     {meshShape(LShape().mesh()), X_PE},
                     {Box{{0.0, 1.0, 2.0}}, X_PE}};
  beside.X_PO.translation().x() = 100.0;
  description.objects = {load, beside};
  description.clouds.push_back(cloudOf("camera", 0.1, {}));  // drawn apart
  std::vector<std::string> all;
  auto array = toSceneMarkers(*CollisionScene::build(description), Fidelity::MESH, "world");
  for (Marker& marker : array.markers) {
    const std::size_t nb_points = marker.points.size();
    marker.points.clear(), marker.colors.clear();
    all.push_back(printed(marker) + (nb_points ? " points " + std::to_string(nb_points) : ""));
  }
  const std::vector<std::string> expected = {
      "header frame_id world action 3",
      "header frame_id base ns links id 2 type 1 pose position x 4 y 5 z 6 orientation w 1 scale x "
      "1 y 2 z 3 color r 0.72 g 0.74 b 0.77 a 1 frame_locked 1",
      "header frame_id base ns attached_objects id 3 type 2 pose position x 1 y 2 z 3 orientation "
      "x 0.707107 w 0.707107 scale x 0.5 y 0.5 z 0.5 color r 0.6 g 0.3 b 0.7 a 0.9 frame_locked 1",
      "header frame_id world ns standing id 4 type 3 pose position x 101 y 2 z 3 orientation x "
      "0.707107 w 0.707107 scale x 1 y 1 z 8 color r 0.35 g 0.6 b 0.4 a 0.6",
      "header frame_id world ns standing id 5 type 3 pose position x 101 y 2 z 3 orientation x "
      "0.707107 w 0.707107 scale x 0.25 y 0.25 z 6 color r 0.35 g 0.6 b 0.4 a 0.6",
      "header frame_id world ns standing id 6 type 2 pose position x 101 y 5 z 3 orientation x "
      "0.707107 w 0.707107 scale x 0.25 y 0.25 z 0.25 color r 0.35 g 0.6 b 0.4 a 0.6",
      "header frame_id world ns standing id 7 type 2 pose position x 101 y -1 z 3 orientation x "
      "0.707107 w 0.707107 scale x 0.25 y 0.25 z 0.25 color r 0.35 g 0.6 b 0.4 a 0.6",
      "header frame_id world ns standing id 8 type 1 pose position x 101 y 2.0005 z 3 orientation "
      "x 0.707107 w 0.707107 scale x 10 y 10 z 0.001 color r 0.35 g 0.6 b 0.4 a 0.6",
      "header frame_id world ns standing id 9 type 11 pose position x 101 y 2 z 3 orientation x "
      "0.707107 w 0.707107 scale x 1 y 1 z 1 color r 0.35 g 0.6 b 0.4 a 0.6 points 72",
      "header frame_id world ns standing id 10 type 1 pose position x 101 y 2 z 3 orientation x "
      "0.707107 w 0.707107 scale x 1e-06 y 1 z 2 color r 0.35 g 0.6 b 0.4 a 0.6"};
  EXPECT_EQ(all, expected);
}

/// Triangles of a sphere of the tree.
struct DrawnSphere {
  PlacedSphere sphere;
  std::vector<std::array<Vector3d, 3>> triangles;
  /// Whether one of them is seen from the centre in this direction; then from outside, too.
  bool covers(const Vector3d& d) const {
    return std::any_of(triangles.begin(), triangles.end(), [&](const auto& t) {
      const Vector3d a = t[0] - sphere.center, b = t[1] - sphere.center, c = t[2] - sphere.center;
      return a.cross(b).dot(d) > -1e-9 && b.cross(c).dot(d) > -1e-9 && c.cross(a).dot(d) > -1e-9;
    });
  }
};

TEST(SceneMarkers, OfSpheresAreClosedFaceOutwardsAndHoldTheMesh) {
  SceneDescription description;
  description.robots.push_back({robotFrom(slidingBoxes(2)), std::nullopt, ""});
  RigidObject slab;
  slab.name = "slab";
  slab.elements.push_back({meshShape(boxMesh({0.1, 0.075, 0.01})), Isometry3d::Identity()});
  description.objects = {slab};
  const auto scene = CollisionScene::build(description);
  const auto lists = of("standing", toSceneMarkers(*scene, Fidelity::SPHERES, "world").markers);
  ASSERT_EQ(lists.size(), 1u);
  std::vector<DrawnSphere> all;
  const SceneElement& element = scene->elements().front();
  ASSERT_TRUE(element.spheres);
  for (const OuterSphere& sphere : element.spheres->get()) all.push_back({sphere, {}});
  for (std::size_t i = 0; i + 2 < lists[0].points.size(); i += 3) {
    std::array<Vector3d, 3> t;
    for (std::size_t k = 0; k < 3; ++k) t[k] = toVector(lists[0].points[i + k]);
    const auto its = std::find_if(all.begin(), all.end(), [&](const DrawnSphere& one) {
      const auto off = [&](int k) { return (t[k] - one.sphere.center).norm() - one.sphere.radius; };
      return std::max({std::abs(off(0)), std::abs(off(1)), std::abs(off(2))}) < 1e-12;
    });
    ASSERT_NE(its, all.end()) << "its corners are on no sphere";
    its->triangles.push_back(t);
  }
  const auto isHidden = [](const DrawnSphere& one) { return one.triangles.empty(); };
  all.erase(std::remove_if(all.begin(), all.end(), isHidden), all.end());
  RandomInputs random;
  int nb_outside = 0;
  for (const DrawnSphere& one : all) {
    for (int i = 0; i < 50; ++i) {
      const Vector3d d = random.rotation() * Vector3d::UnitX();
      const Vector3d p = one.sphere.center + one.sphere.radius * d;
      const auto isNear = [&](const DrawnSphere& other) {
        return &other != &one && (p - other.sphere.center).norm() < 1.3 * other.sphere.radius;
      };
      if (std::any_of(all.begin(), all.end(), isNear)) continue;
      ++nb_outside;
      EXPECT_TRUE(one.covers(d)) << "a hole";
    }
  }
  EXPECT_GT(nb_outside, 100);
  for (int i = 0; i < 200; ++i) {
    const Vector3d p = random.vector(-1.0, 1.0).cwiseProduct(Vector3d(0.1, 0.075, 0.01));
    const auto holds = [&](const DrawnSphere& one) {
      return (p - one.sphere.center).norm() <= one.sphere.radius + 1e-9;
    };
    EXPECT_TRUE(std::any_of(all.begin(), all.end(), holds));
  }
}

TEST(SceneMarkers, OfAMeshLookTheSameInWhateverOrderItsCornersAre) {
  RandomInputs random;
  TriangleMesh mesh = LShape().mesh(), mixed = mesh;
  int nb_turned = 0;
  for (auto& triangle : mixed.triangles) {
    if (random.integer(0, 1)) std::swap(triangle[0], triangle[1]), ++nb_turned;
  }
  EXPECT_GT(nb_turned, 0);
  const auto shown = of("standing", drawn(Sphere{0.1}, meshShape(mesh), Fidelity::MESH)).at(0);
  const auto same = of("standing", drawn(Sphere{0.1}, meshShape(mixed), Fidelity::MESH)).at(0);
  EXPECT_EQ(shown.colors, same.colors);
  ASSERT_EQ(shown.colors.size(), mesh.triangles.size());
  std::set<float> shades;
  for (const std_msgs::ColorRGBA& shade : shown.colors) {
    EXPECT_GE(shade.g, 0.5f * shown.color.g) << "nothing is black";
    EXPECT_LE(shade.g, shown.color.g);
    EXPECT_FLOAT_EQ(shade.r * shown.color.g, shade.g * shown.color.r) << "only darker";
    shades.insert(shade.g);
  }
  EXPECT_EQ(shades.size(), 3u) << "of the six directions that its sides face";
}

TEST(SceneMarkers, OfLinksAreOfOneNeutralColourAndThoseOfObjectsAreNot) {
  SceneDescription description;
  description.robots.push_back({robotFrom(slidingBoxes(2)), std::nullopt, ""});
  RigidObject object;
  object.name = "beside";
  object.elements.push_back({Sphere{0.1}, Isometry3d::Identity()});
  description.objects = {object};
  for (const Marker& marker :
       toSceneMarkers(*CollisionScene::build(description), Fidelity::MESH, "world").markers) {
    if (marker.action != Marker::ADD) continue;
    const auto& of = marker.color;
    const bool is_grey = std::max({of.r, of.g, of.b}) - std::min({of.r, of.g, of.b}) < 0.1f;
    EXPECT_EQ(is_grey, marker.type == Marker::CUBE) << marker.ns;
  }
}

TEST(SceneMarkers, OfAFlatHullHaveNoListWithoutPoints) {
  const TriangleMesh sheet{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, "sheet"};
  for (const Marker& marker : drawn(meshShape(sheet), Sphere{0.1}, Fidelity::CONVEX)) {
    EXPECT_TRUE(marker.type != Marker::TRIANGLE_LIST || !marker.points.empty());
  }
}

TEST(SceneMarkers, BeginWithTheRobotBecauseAVastWorldIsNotDrawnWhole) {
  SceneDescription description;
  description.robots.push_back({robotFrom(slidingBoxes(2)), std::nullopt, ""});
  RigidObject dust;
  dust.name = "dust";
  dust.elements.assign(10000, {Sphere{0.001}, Isometry3d::Identity()});
  description.objects = {dust};
  const auto array = toSceneMarkers(*CollisionScene::build(description), Fidelity::MESH, "world");
  EXPECT_EQ(array.markers.size(), 1u + 10000u);
  EXPECT_EQ(of("links", array.markers).size(), 2u);
  EXPECT_EQ(array.markers.back().ns, "standing");
}

TEST(SceneMarkers, AFloorIsDrawnBelowItsSurface) {
  const auto floor = of("standing", drawn(Sphere{0.1}, HalfSpace{}, Fidelity::MESH));
  ASSERT_EQ(floor.size(), 1u);
  EXPECT_DOUBLE_EQ(floor[0].pose.position.z + 0.5 * floor[0].scale.z, -1.0);
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

}  // namespace collision_pairs::test_scene_markers
