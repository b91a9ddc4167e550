// Meshes that scenes share.
#include <thread>

#include <gtest/gtest.h>

#include "collision_pairs/collision_scene.h"
#include "demo_scene.h"
#include "test_shapes.h"

namespace collision_pairs::test_scene_cache {

RigidObject ball(const std::string& name) {
  RigidObject object;
  object.name = name;
  // A mesh of its own, of equal content.
  object.elements.push_back({meshShape(bumpyBall(12, 0.15)), Eigen::Isometry3d::Identity()});
  object.X_PO.translation().x() = 2.0;
  return object;
}

class SharedMeshes : public testing::Test {
 protected:
  SharedMeshes() { description_.robots.push_back({robotFrom(slidingBoxes(2)), std::nullopt, ""}); }
  SceneDescription description_;
};

const PreparedShape* preparedOf(const CollisionScene& scene, const std::string& name) {
  const CollisionModel& model = scene.models()[static_cast<std::size_t>(scene.findModel(name))];
  return scene.elements()[model.first_element].rung(Fidelity::MESH).shape.get();
}

TEST_F(SharedMeshes, OfEqualContentArePreparedOnceForAllScenes) {
  std::size_t nb_prepared = 0;
  description_.settings.progress = [&](std::size_t, std::size_t) { ++nb_prepared; };
  description_.objects = {ball("p"), ball("q")};
  SceneCache cache;
  const auto first = CollisionScene::build(description_, &cache);
  EXPECT_EQ(nb_prepared, 1u);
  description_.objects.push_back(ball("r"));
  const auto second = CollisionScene::build(description_, &cache);
  const auto third = first->with({{ball("s")}, {}}, &cache);
  EXPECT_EQ(nb_prepared, 1u);
  const PreparedShape* known = preparedOf(*first, "p");
  EXPECT_EQ(preparedOf(*first, "q"), known);
  EXPECT_EQ(preparedOf(*second, "r"), known);
  EXPECT_EQ(preparedOf(*third, "s"), known);
  RigidObject other = ball("t");
  TriangleMesh mesh = bumpyBall(12, 0.15);
  mesh.vertices[0] *= 1.0 + 1e-15;
  other.elements[0].shape = meshShape(mesh);
  EXPECT_NE(preparedOf(*first->with({{other}, {}}, &cache), "t"), known);
}

TEST_F(SharedMeshes, AreKeptAsLongAsASceneHoldsThem) {
  SceneCache cache;
  description_.objects = {ball("p")};
  const auto holder = CollisionScene::build(description_, &cache);
  std::weak_ptr<const PreparedShape> dropped;
  for (int i = 0; i < 60; ++i) {
    description_.objects = {ball("q")};
    TriangleMesh mesh = bumpyBall(12, 0.15 + 0.001 * (i + 1));
    description_.objects[0].elements[0].shape = meshShape(mesh);
    const auto scene = CollisionScene::build(description_, &cache);
    const CollisionModel& q = scene->models()[static_cast<std::size_t>(scene->findModel("q"))];
    if (i == 0) dropped = scene->elements()[q.first_element].rung(Fidelity::MESH).shape;
  }
  EXPECT_TRUE(dropped.expired());
  description_.objects = {ball("again")};
  EXPECT_EQ(preparedOf(*CollisionScene::build(description_, &cache), "again"),
            preparedOf(*holder, "p"));
}

// Each of the scenes between is let go again, and has a mesh of its own.
TEST_F(SharedMeshes, AreDroppedIfSixteenScenesDidNotUseThem) {
  std::size_t nb_prepared = 0;
  description_.settings.progress = [&](std::size_t, std::size_t) { ++nb_prepared; };
  int nb_meshes = 0;
  for (const int nb_between : {1, 15, 16, 17}) {
    SceneCache cache;
    const auto build = [&](const RigidObject& object) {
      description_.objects = {object};
      CollisionScene::build(description_, &cache);
    };
    const auto other = [&] {
      RigidObject object = ball("other");
      object.elements[0].shape = meshShape(bumpyBall(6, 0.2 + 0.001 * ++nb_meshes));
      return object;
    };
    RigidObject used = ball("p");
    std::weak_ptr<const TriangleMesh> mesh = std::get<Mesh>(used.elements[0].shape).mesh;
    build(used);
    used = ball("p");
    description_.objects.clear();
    for (int i = 0; i < nb_between; ++i) {
      EXPECT_EQ(mesh.expired(), i >= 16);
      build(other());
    }
    description_.objects.clear();
    EXPECT_EQ(mesh.expired(), nb_between >= 16);
    nb_prepared = 0;
    build(used);
    EXPECT_EQ(nb_prepared, nb_between >= 16 ? 1u : 0u) << nb_between;
    for (int i = 0; i < 40; ++i) {  // in use all the time
      nb_prepared = 0;
      build(other());
      EXPECT_EQ(nb_prepared, 1u);
      build(used);
      EXPECT_EQ(nb_prepared, 1u);
    }
  }
}

TEST_F(SharedMeshes, ServeAllThreads) {
  SceneCache cache;
  std::vector<std::shared_ptr<const CollisionScene>> scenes(4);
  std::vector<std::thread> threads;
  for (auto& scene : scenes) {
    threads.emplace_back([&] {
      SceneDescription description = description_;
      for (const char* name : {"p", "q"}) description.objects.push_back(ball(name));
      scene = CollisionScene::build(description, &cache);
      for (int i = 0; i < 20; ++i)
        scene = scene->with({{ball("r" + std::to_string(i))}, {}}, &cache);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const auto& scene : scenes) {
    EXPECT_EQ(preparedOf(*scene, "r19"), preparedOf(*scenes[0], "p"));
  }
}

}  // namespace collision_pairs::test_scene_cache
