// The defaults are said in the core, in the YAML, in the .cfg and in docs/node.md: all must agree.
#include <fstream>
#include <map>

#include <collision_pairs/CollisionPairsConfig.h>
#include <gtest/gtest.h>

#include "documented_defaults.h"
#include "parameters.h"
#include "scene_config.h"

namespace collision_pairs::test_parameters {

std::map<std::string, std::string> yamlDefaults() {
  std::map<std::string, std::string> values;
  std::ifstream file(std::string(PROJECT_SOURCE_DIR) + "/config/collision_pairs_node.yaml");
  std::string line;
  while (std::getline(file, line)) {
    const std::size_t colon = line.find(": ");
    if (line.empty() || line[0] == '#' || colon == std::string::npos) continue;
    values[line.substr(0, colon)] = line.substr(colon + 2);
  }
  return values;
}

std::map<std::string, std::string> pageDefaults() { return documentedDefaults("node.md"); }

class Defaults : public testing::TestWithParam<std::map<std::string, std::string> (*)()> {};

TEST_P(Defaults, AreThoseOfTheCode) {
  const NodeParameters code;
  const auto text = GetParam()();
  EXPECT_EQ(std::stod(text.at("alarm_distance")), code.check.alarm_distance);
  EXPECT_EQ(text.at("fidelity"), fidelityName(code.check.fidelity));
  EXPECT_EQ(std::stod(text.at("tolerance")), code.check.tolerance);
  EXPECT_EQ(std::stod(text.at("time_budget")), code.check.time_budget);
  EXPECT_EQ(std::stoi(text.at("max_hull_vertices")), SceneSettings().max_hull_vertices);
  EXPECT_EQ(text.at("link_fidelity"), "{}");
  EXPECT_EQ(std::stod(text.at("padding")), SceneSettings().padding);
  EXPECT_EQ(text.at("narrow_phase"), narrowPhaseName(SceneSettings().narrow_phase));
  EXPECT_EQ(std::stod(text.at("rate")), code.rate);
  EXPECT_EQ(text.at("show_only_investigated_boxes"),
            code.show_only_investigated_boxes ? "true" : "false");
  EXPECT_EQ(std::stod(text.at("max_transform_age")), code.pose_limits.max_transform_age);
  EXPECT_EQ(std::stod(text.at("max_pose_age")), code.pose_limits.max_pose_age);
  EXPECT_EQ(std::stod(text.at("clock_tolerance")), code.pose_limits.clock_tolerance);
  EXPECT_EQ(text.at("allow_paused"), code.allow_paused ? "true" : "false");
  EXPECT_TRUE(text.count("fixed_frame"));
  EXPECT_EQ(text.at("reload"), code.reload);
  EXPECT_EQ(text.at("trigger"), code.trigger);
  EXPECT_EQ(text.at("broad_phase"), broadPhaseName(code.check.broad_phase));
  EXPECT_EQ(text.at("allow_empty_scene"), SceneSettings().allow_empty_scene ? "true" : "false");
}

// All of these are empty by default: of what the texts say, only that is in them.
TEST_P(Defaults, HoldEverythingThatASceneIsMadeOf) {
  const auto text = GetParam()();
  const std::map<std::string, std::string> by_kind = {{"static_joints", "[]"},
                                                      {"pair_rules", "[]"},
                                                      {"links", "[]"},
                                                      {"ignored_links", "[]"},
                                                      {"pair_padding", "[]"},
                                                      {"link_padding", "{}"},
                                                      {"cylinder_as_capsule", "[]"},
                                                      {"floor", "{}"},
                                                      {"clouds", "[]"},
                                                      {"robots", "[]"},
                                                      {"group", "\"\""}};
  for (const auto& [key, empty] : by_kind) EXPECT_EQ(text.at(key), empty) << key;
  for (const std::string& key : sceneConfigKeys()) EXPECT_EQ(text.count(key), 1u) << key;
}

INSTANTIATE_TEST_SUITE_P(Yaml, Defaults, testing::Values(&yamlDefaults));
INSTANTIATE_TEST_SUITE_P(NodePage, Defaults, testing::Values(&pageDefaults));

TEST(Defaults, OfDynamicReconfigureAreThoseOfTheCode) {
  const NodeParameters code;
  const auto config = CollisionPairsConfig::__getDefault__();
  EXPECT_EQ(config.alarm_distance, code.check.alarm_distance);
  EXPECT_EQ(config.fidelity, fidelityName(code.check.fidelity));
  EXPECT_EQ(config.tolerance, code.check.tolerance);
  EXPECT_EQ(config.time_budget, code.check.time_budget);
  EXPECT_EQ(config.rate, code.rate);
  EXPECT_EQ(config.show_only_investigated_boxes, code.show_only_investigated_boxes);
}

}  // namespace collision_pairs::test_parameters
