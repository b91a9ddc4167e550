#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "collision_pairs/input_error.h"
#include "scene_config.h"

namespace collision_pairs {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string refusal(const std::string& yaml) {
  try {
    readSceneConfig(YAML::Load(yaml));
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(SceneConfig, ReadsEveryKey) {
  const SceneConfig config = readSceneConfig(YAML::Load(R"(
max_hull_vertices: 32
narrow_phase: fcl
link_fidelity: {gripper: obb}
padding: 0.01
link_padding: {elbow: 0.02}
pair_padding: [{pair: ["left_*", base], padding: 0.1}]
pair_rules: [{deny: [a, "b_*"]}, {allow: ["*", c]}]
ignored_links: ["cable_*"]
cylinder_as_capsule: ["*"]
group: arm
links: [wrist, "finger_?"]
floor: {height: -0.5, touch_links: [base]}
rate: 50.0
)"));
  const SceneSettings& settings = config.settings;
  EXPECT_EQ(settings.max_hull_vertices, 32);
  EXPECT_EQ(settings.narrow_phase, NarrowPhaseMethod::FCL);
  EXPECT_EQ(settings.link_fidelity.at("gripper"), Fidelity::OBB);
  EXPECT_EQ(settings.padding, 0.01);
  EXPECT_EQ(settings.link_padding.at("elbow"), 0.02);
  ASSERT_EQ(settings.pair_padding.size(), 1u);
  EXPECT_EQ(settings.pair_padding[0].first, "left_*");
  EXPECT_EQ(settings.pair_padding[0].second, "base");
  EXPECT_EQ(settings.pair_padding[0].metres, 0.1);
  ASSERT_EQ(settings.pair_rules.size(), 2u);
  EXPECT_EQ(settings.pair_rules[0].verdict, PairRule::Verdict::DENY);
  EXPECT_EQ(settings.pair_rules[0].second, "b_*");
  EXPECT_EQ(settings.pair_rules[1].verdict, PairRule::Verdict::ALLOW);
  EXPECT_EQ(settings.pair_rules[1].first, "*");
  EXPECT_EQ(settings.ignored_links, (std::vector<std::string>{"cable_*"}));
  EXPECT_EQ(settings.cylinder_as_capsule, (std::vector<std::string>{"*"}));
  EXPECT_EQ(config.restriction, (Restriction{"arm", {"wrist", "finger_?"}}));
  ASSERT_TRUE(config.floor);
  EXPECT_EQ(config.floor->X_PO.translation(), Eigen::Vector3d(0, 0, -0.5));
  EXPECT_EQ(config.floor->touch_links, (std::vector<std::string>{"base"}));
}

TEST(SceneConfig, ALinkWithAPrefixMayBeInAMapAsTheParameterServerHasIt) {
  for (const char* yaml :
       {"{link_padding: {left/elbow: 0.1}, link_fidelity: {left/elbow: obb}}",
        "{link_padding: {left: {elbow: 0.1}}, link_fidelity: {left: {elbow: obb}}}"}) {
    const SceneSettings settings = readSceneConfig(YAML::Load(yaml)).settings;
    EXPECT_EQ(settings.link_padding, (std::map<std::string, double>{{"left/elbow", 0.1}}));
    EXPECT_EQ(settings.link_fidelity,
              (std::map<std::string, Fidelity>{{"left/elbow", Fidelity::OBB}}));
  }
  EXPECT_EQ(readSceneConfig(YAML::Load("{link_padding: {cell: {left: {elbow: 0.1}}}}"))
                .settings.link_padding,
            (std::map<std::string, double>{{"cell/left/elbow", 0.1}}));
  EXPECT_THAT(refusal("link_padding: {left: {elbow: b}}"),
              HasSubstr("link_padding/left/elbow is b"));
  EXPECT_THAT(refusal("link_padding: {left: {}}"), HasSubstr("link_padding/left is {}"));
}

TEST(SceneConfig, AMapThatHoldsItselfOrMoreThanThereCanBeIsRefused) {
  EXPECT_THAT(refusal("link_padding: &all {elbow: 0.1, left: *all}"),
              AllOf(HasSubstr("link_padding"), HasSubstr("contains itself")));
  std::string bomb = "link_padding: {a: &a {x: 0.1}";
  for (char name = 'b'; name < 'n'; ++name) {
    bomb += std::string(", ") + name + ": &" + name + " {";
    for (char copy = '0'; copy <= '9'; ++copy) {
      bomb += std::string(copy > '0' ? ", " : "") + copy + ": *" + static_cast<char>(name - 1);
    }
    bomb += "}";
  }
  EXPECT_THAT(refusal(bomb + "}"), HasSubstr("link_padding names more than 100000 links"));
}

TEST(SceneConfig, OfNothingIsTheDefaults) {
  const SceneConfig config = readSceneConfig(YAML::Load("{floor: {}, pair_rules: [], links: []}"));
  EXPECT_FALSE(config.floor);
  EXPECT_TRUE(config.settings.pair_rules.empty());
  EXPECT_TRUE(config.restriction.empty());
  EXPECT_EQ(config.settings.padding, SceneSettings().padding);
}

TEST(SceneConfig, WhatIsWrongIsNamedWithWhatItMustBe) {
  EXPECT_THAT(refusal("padding: -1"), AllOf(HasSubstr("padding is -1"), HasSubstr("0 or more")));
  EXPECT_THAT(refusal("padding: thick"), HasSubstr("padding is thick"));
  EXPECT_THAT(refusal("padding: .nan"), HasSubstr("padding is .nan"));
  EXPECT_THAT(refusal("link_padding: 0.1"), HasSubstr("a map from links to metres"));
  EXPECT_THAT(refusal("link_padding: {a: b}"), HasSubstr("link_padding/a is b"));
  EXPECT_THAT(refusal("link_fidelity: {a: exact}"),
              AllOf(HasSubstr("link_fidelity/a is exact"),
                    HasSubstr("aabb, spheres, obb, convex or mesh")));
  EXPECT_THAT(refusal("link_fidelity: {a: mehs}"), HasSubstr("did you mean 'mesh'?"));
  EXPECT_THAT(refusal("pair_rules: {deny: [a, b]}"), HasSubstr("pair_rules is {deny: [a, b]}"));
  EXPECT_THAT(refusal("pair_rules: [{forbid: [a, b]}]"), HasSubstr("{forbid: [a, b]}"));
  EXPECT_THAT(refusal("pair_rules: [{deny: [a]}]"), HasSubstr("two names"));
  EXPECT_THAT(refusal("pair_rules: [{deny: [a, b, c]}]"), HasSubstr("two names"));
  EXPECT_THAT(refusal("pair_rules: [{deny: [a, b], allow: [a, c]}]"), HasSubstr("a list of"));
  EXPECT_THAT(refusal("pair_padding: [{pair: [a, b]}]"), HasSubstr("{pair: [first, second]"));
  EXPECT_THAT(refusal("pair_padding: [{pair: [a, b], padding: -1}]"), HasSubstr("0 or more"));
  EXPECT_THAT(refusal("ignored_links: cable"), HasSubstr("ignored_links is cable"));
  EXPECT_THAT(refusal("group: [a]"), HasSubstr("a group's name"));
  EXPECT_THAT(refusal("floor: 0.0"), HasSubstr("floor is 0.0"));
  EXPECT_THAT(refusal("floor: {touch_links: [a]}"), HasSubstr("{height: metres"));
  EXPECT_THAT(refusal("floor: {hight: 0}"), HasSubstr("{height: metres"));
  EXPECT_THAT(refusal("max_hull_vertices: 3"), HasSubstr("4 or more"));
  EXPECT_THAT(refusal("max_hull_vertices: 4.5"), HasSubstr("4 or more"));
  EXPECT_THAT(refusal("narrow_phase: bullet"), HasSubstr("narrow_phase is bullet, but must be"));
  EXPECT_THAT(refusal("narrow_phase: [fcl]"), HasSubstr("native or fcl"));
}

class ConfigFile : public testing::Test {
 protected:
  std::string refusalOf(const std::string& yaml) {
    std::ofstream(path_) << yaml;
    try {
      readSceneConfigFile(path_);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }
  void TearDown() override { std::filesystem::remove(path_); }

  const std::string path_ =
      (std::filesystem::temp_directory_path() / ("scene_config_" + std::to_string(getpid())))
          .string();
};

TEST_F(ConfigFile, IsNamedInWhatIsWrongWithIt) {
  EXPECT_EQ(refusalOf("rate: 3\npadding: 0.1\n"), "accepted");
  EXPECT_EQ(refusalOf(""), "accepted");
  EXPECT_THAT(refusalOf("pading: 0.1"), AllOf(HasSubstr(path_), HasSubstr("'padding'?")));
  EXPECT_THAT(refusalOf("padding: -1"), AllOf(HasSubstr(path_), HasSubstr("padding is -1")));
  EXPECT_THAT(refusalOf("padding: [0.1"), HasSubstr(path_));
  EXPECT_THAT(refusalOf("just words"), HasSubstr("must be a map"));
}

TEST_F(ConfigFile, OfTheNodeIsAsTheNodeHasIt) {
  const std::string shipped = std::string(PROJECT_SOURCE_DIR) + "/config/collision_pairs_node.yaml";
  const SceneConfig config = readSceneConfigFile(shipped);
  EXPECT_TRUE(config.restriction.empty());
  EXPECT_FALSE(config.floor);
}

}  // namespace
}  // namespace collision_pairs
