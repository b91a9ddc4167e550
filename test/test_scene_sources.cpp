// Meshes are read when a scene needs them, and only then.
#include <gtest/gtest.h>

#include "collision_pairs/collision_scene.h"
#include "collision_pairs/input_error.h"
#include "mixed_robot.h"
#include "scene_sources.h"

namespace collision_pairs::test_scene_sources {

class CountingLoader {
 public:
  MeshLoader loader() {
    return [this](const std::string& uri, const Eigen::Vector3d& scale) {
      loaded.insert(uri);
      if (uri == "broken") throw InputError("mesh 'broken': there is no such file");
      return testMesh(uri, scale);
    };
  }
  std::multiset<std::string> loaded;
};

/// Links a (mesh l), b (mesh ball), c (mesh broken) and d (a box), all floating.
std::string robotOfMeshes() {
  std::string xml = emptyLink("root");
  for (const auto& [link, mesh] : {std::pair{"a", "l"}, {"b", "ball"}, {"c", "broken"}}) {
    xml +=
        linkWith(link, std::string("<mesh filename='") + mesh + "'/>", "<origin xyz='0 0 0.5'/>") +
        joint(std::string("to_") + link, "floating", "root", link, "0 0 0", "");
  }
  return "<robot name='r'>" + xml + boxLink("d", 1) +
         joint("to_d", "floating", "root", "d", "0 0 0", "") + "</robot>";
}

SceneSources sourcesWith(CountingLoader& loader, const std::string& srdf) {
  SceneSources sources;
  sources.robots.emplace_back();
  sources.robots[0].source = std::make_unique<RobotSource>(robotOfMeshes(), loader.loader());
  sources.robots[0].srdf = Srdf::fromXml("<robot name='r'>" + srdf + "</robot>");
  return sources;
}

TEST(RobotSource, IsTheRobotThatTheUrdfDescribes) {
  CountingLoader loader;
  RobotSource source(robotOfMeshes(), [](const std::string& uri, const Eigen::Vector3d& scale) {
    return testMesh(uri == "broken" ? "slab" : uri, scale);
  });
  const auto whole = RobotModel::fromUrdf(robotOfMeshes(),
                                          [](const std::string& uri, const Eigen::Vector3d& scale) {
                                            return testMesh(uri == "broken" ? "slab" : uri, scale);
                                          });
  const auto model = source.withGeometryOf([](const std::string&) { return true; });
  ASSERT_EQ(model->links().size(), whole->links().size());
  for (std::size_t i = 0; i < model->links().size(); ++i) {
    const auto &got = model->links()[i].elements, &expected = whole->links()[i].elements;
    ASSERT_EQ(got.size(), expected.size());
    for (std::size_t k = 0; k < got.size(); ++k) {
      EXPECT_EQ(got[k].X_LE.matrix(), expected[k].X_LE.matrix());
      EXPECT_EQ(got[k].shape.index(), expected[k].shape.index());
      const auto* mesh = std::get_if<Mesh>(&got[k].shape);
      if (mesh) {
        EXPECT_EQ(mesh->mesh->vertices, std::get<Mesh>(expected[k].shape).mesh->vertices);
      }
    }
  }
}

TEST(RobotSource, ReadsAMeshAtItsScale) {
  Eigen::Vector3d given = Eigen::Vector3d::Zero();
  RobotSource source(
      "<robot name='r'>" + linkWith("a", "<mesh filename='l' scale='1 -2 3'/>") + "</robot>",
      [&](const std::string& uri, const Eigen::Vector3d& scale) {
        given = scale;
        return testMesh(uri, scale);
      });
  source.withGeometryOf([](const std::string&) { return true; });
  EXPECT_EQ(given, Eigen::Vector3d(1, -2, 3));
}

TEST(SceneSources, MeshesOfLinksInNoPairAreNeverRead) {
  CountingLoader loader;
  SceneSources sources = sourcesWith(loader,
                                     "<disable_default_collisions link='a'/>"
                                     "<disable_default_collisions link='c'/>");
  EXPECT_TRUE(loader.loaded.empty());
  const auto scene = CollisionScene::build(describeScene(sources, {}, {}));
  EXPECT_EQ(loader.loaded, (std::multiset<std::string>{"ball"}));
  EXPECT_EQ(scene->models().size(), 2u);
  EXPECT_EQ(scene->bodies().size(), 2u);
  EXPECT_TRUE(scene->missing().empty());
}

TEST(SceneSources, WhatANewObjectCanMeetIsReadThenAndOnlyOnce) {
  CountingLoader loader;
  SceneSources sources = sourcesWith(loader,
                                     "<disable_default_collisions link='a'/>"
                                     "<disable_default_collisions link='c'/>");
  describeScene(sources, {}, {});
  const auto scene = CollisionScene::build(describeScene(sources, {floorAt(0.0, {"d"})}, {}));
  EXPECT_EQ(loader.loaded, (std::multiset<std::string>{"ball", "broken", "l"}));
  ASSERT_EQ(scene->missing().size(), 1u);
  EXPECT_EQ(scene->missing().at("c"),
            std::vector<std::string>{"mesh 'broken': there is no such file"});
  EXPECT_GE(scene->findModel("a"), 0);
  EXPECT_EQ(scene->findModel("c"), -1);
  describeScene(sources, {floorAt(1.0, {})}, {});
  EXPECT_EQ(loader.loaded.size(), 3u);
  EXPECT_TRUE(CollisionScene::build(describeScene(sources, {}, {}))->missing().empty())
      << "link c meets nothing any more";
}

TEST(SceneSources, ARestrictionOfTheRequestStandsForTheConfiguredOne) {
  CountingLoader loader;
  SceneSources sources = sourcesWith(loader, "");
  sources.config.restriction.names = {"a"};
  sources.config.settings.ignored_links = {"c"};
  const auto pairsWith = [&](const Restriction& restriction) {
    const auto scene = CollisionScene::build(describeScene(sources, {}, restriction));
    std::set<std::string> names;
    for (std::uint32_t a = 0; a < scene->models().size(); ++a) {
      for (std::uint32_t b = a + 1; b < scene->models().size(); ++b) {
        if (scene->filter().allowed(a, b)) {
          names.insert(scene->models()[a].name + scene->models()[b].name);
        }
      }
    }
    return names;
  };
  EXPECT_EQ(pairsWith({}), (std::set<std::string>{"ab", "ad"}));
  EXPECT_EQ(pairsWith({"", {"d"}}), (std::set<std::string>{"ad", "bd"}));
}

TEST(SceneSources, AnSrdfOfAnotherRobotIsSaid) {
  std::vector<std::string> said;
  const auto warn = [&](const std::string& what) { said.push_back(what); };
  CountingLoader loader;
  SceneSources sources = sourcesWith(loader, "");
  const auto read = [&](const std::string& srdf) {
    srdfFrom({"a.srdf", srdf}, *sources.robots[0].source->skeleton(), warn);
    sources.robots[0].readSrdf({"b.srdf", srdf}, warn);
  };
  read("<robot name='r'/>");
  read("<robot/>");
  EXPECT_TRUE(said.empty());
  read("<robot name='s'/>");
  const std::string what = ": it is of robot 's', but the URDF is of robot 'r'";
  EXPECT_EQ(said, (std::vector<std::string>{"a.srdf" + what, "b.srdf" + what}));
}

}  // namespace collision_pairs::test_scene_sources
