#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "collision_pairs/input_error.h"
#include "refusal.h"
#include "scene_config.h"
#include "yaml_values.h"

namespace collision_pairs::test_scene_config {

using testing::AllOf;
using testing::HasSubstr;

std::string refusal(const std::string& yaml) {
  return collision_pairs::refusal([&] { readSceneConfig(YAML::Load(yaml)); });
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
allow_empty_scene: true
static_joints: [rail, "lift_*"]
clouds: [{topic: /camera}]
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
  EXPECT_EQ(settings.pair_rules[0].first, "a");
  EXPECT_EQ(settings.pair_rules[0].second, "b_*");
  EXPECT_EQ(settings.pair_rules[1].verdict, PairRule::Verdict::ALLOW);
  EXPECT_EQ(settings.pair_rules[1].first, "*");
  EXPECT_EQ(settings.pair_rules[1].second, "c");
  EXPECT_EQ(settings.ignored_links, (std::vector<std::string>{"cable_*"}));
  EXPECT_EQ(settings.cylinder_as_capsule, (std::vector<std::string>{"*"}));
  EXPECT_TRUE(settings.allow_empty_scene);
  EXPECT_EQ(config.static_joints, (std::vector<std::string>{"rail", "lift_*"}));
  ASSERT_EQ(config.clouds.size(), 1u);
  EXPECT_EQ(config.clouds[0].topic, "/camera");
  EXPECT_EQ(config.restriction, (Restriction{"arm", {"wrist", "finger_?"}}));
  ASSERT_TRUE(config.floor);
  EXPECT_EQ(config.floor->X_PO.translation(), Eigen::Vector3d(0, 0, -0.5));
  EXPECT_EQ(config.floor->touch_links, (std::vector<std::string>{"base"}));
}

TEST(SceneConfig, EachWordOfAChoiceIsItsOwn) {
  const auto read = [](const std::string& yaml) {
    return readSceneConfig(YAML::Load(yaml)).settings;
  };
  const std::map<std::string, Fidelity> expected = {{"a", Fidelity::AABB},
                                                    {"b", Fidelity::SPHERES},
                                                    {"c", Fidelity::OBB},
                                                    {"d", Fidelity::CONVEX},
                                                    {"e", Fidelity::MESH}};
  EXPECT_EQ(read("link_fidelity: {a: aabb, b: spheres, c: obb, d: convex, e: mesh}").link_fidelity,
            expected);
  EXPECT_EQ(read("narrow_phase: native").narrow_phase, NarrowPhaseMethod::NATIVE);
  EXPECT_FALSE(read("allow_empty_scene: false").allow_empty_scene);
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

TEST(SceneConfig, ANameHasAHundredPartsAtMost) {
  std::string inner = "0.5";
  for (int i = 0; i < 101; ++i) inner = "{a: " + inner + "}";
  EXPECT_EQ(refusal("link_padding: " + inner), "accepted");
  EXPECT_EQ(refusal("link_padding: {a: " + inner + "}"),
            "link_padding names more than 100000 links, or contains itself through an alias");
}

TEST(SceneConfig, WhatIsWrongIsRefusedInTheseWords) {
  const std::string fidelity = "aabb, spheres, obb, convex or mesh", metres = "0 or more metres";
  const std::string rules = "a list of {allow: [first, second]} and {deny: [first, second]}";
  const std::string paddings = "a list of {pair: [first, second], padding: metres}";
  const std::string two = "two names or patterns, such as [\"left_*\", base]";
  const std::string names = "a list of names or patterns, such as [elbow, \"left_*\"]";
  const std::string floor = "{height: metres, touch_links: [names]}, or {} for none";
  const std::string hull = "4 or more, or 0 for exact hulls";
  struct Case {
    std::string key, value, rule, shown = "";
    std::string place = "";  ///< of what is wrong, if not the key
  };
  const std::vector<Case> cases = {
      {"padding", "-1", metres},
      {"padding", "thick", metres},
      {"padding", ".nan", metres},
      {"padding", "[1]", metres},
      {"link_padding", "0.1", "a map from links to metres"},
      {"link_padding", "{a: b}", metres, "b", "link_padding/a"},
      {"link_fidelity", "[a]", "a map from links to " + fidelity},
      {"link_fidelity", "{a: [b]}", fidelity, "[b]", "link_fidelity/a"},
      {"link_fidelity", "{a: mehs}", fidelity + "; did you mean 'mesh'?", "mehs",
       "link_fidelity/a"},
      {"pair_rules", "{deny: [a, b]}", rules},
      {"pair_rules", "[deny]", rules, "deny"},
      {"pair_rules", "[{forbid: [a, b]}]", rules, "{forbid: [a, b]}"},
      {"pair_rules", "[{deny: [a, b], allow: [a, c]}]", rules, "{deny: [a, b], allow: [a, c]}"},
      {"pair_rules", "[{}]", rules, "{}"},
      {"pair_rules", "[{deny: [a]}]", two, "[a]"},
      {"pair_rules", "[{allow: [a, b]}, {deny: [a, b, c]}]", two, "[a, b, c]"},
      {"pair_padding", "{pair: [a, b], padding: 1}", paddings},
      {"pair_padding", "[a]", paddings, "a"},
      {"pair_padding", "[{pair: [a, b]}]", paddings, "{pair: [a, b]}"},
      {"pair_padding", "[{padding: 1}]", paddings, "{padding: 1}"},
      {"pair_padding", "[{pair: [a, b], pading: 1}]", paddings, "{pair: [a, b], pading: 1}"},
      {"pair_padding", "[{pear: [a, b], padding: 1}]", paddings, "{pear: [a, b], padding: 1}"},
      {"pair_padding", "[{pair: [a, b], padding: 1, x: 1}]", paddings,
       "{pair: [a, b], padding: 1, x: 1}"},
      {"pair_padding", "[{pair: [a, b], padding: -1}]", metres, "-1"},
      {"pair_padding", "[{pair: [a], padding: 1}]", two, "[a]"},
      {"ignored_links", "cable", names},
      {"static_joints", "rail", names},
      {"cylinder_as_capsule", "[[a]]", names, "[a]"},
      {"links", "wrist", names},
      {"group", "[a]", "a group's name"},
      {"floor", "0.5", floor},
      {"floor", "{touch_links: [a]}", floor},
      {"floor", "{hight: 0}", floor},
      {"floor", "{height: low}", "a number of metres", "low", "floor/height"},
      {"floor", "{height: 0, touch_links: a}", names, "a", "floor/touch_links"},
      {"max_hull_vertices", "3", hull},
      {"max_hull_vertices", "-4", hull},
      {"max_hull_vertices", "4.5", hull},
      {"max_hull_vertices", "1000001", hull},
      {"max_hull_vertices", "[4]", hull},
      {"narrow_phase", "bullet", "native or fcl"},
      {"narrow_phase", "[fcl]", "native or fcl"},
      {"allow_empty_scene", "often", "true or false"},
  };
  for (const Case& wrong : cases) {
    EXPECT_EQ(refusal(wrong.key + ": " + wrong.value),
              (wrong.place.empty() ? wrong.key : wrong.place) + " is " +
                  (wrong.shown.empty() ? wrong.value : wrong.shown) + ", but must be " +
                  wrong.rule);
  }
}

std::string refusalOfText(const std::string& text) {
  return collision_pairs::refusal([&] { loadYaml(text); });
}

// rosparam would take the last, yaml-cpp the first, and a loop over a map's entries the last.
TEST(SettingsFile, AKeyIsGivenOnceInEachMap) {
  EXPECT_EQ(refusalOfText("padding: 0.0\npair_rules: []\npadding: 0.2\n"),
            "line 3: 'padding' is given twice");
  EXPECT_EQ(refusalOfText("floor: {height: 0, height: 1}"), "line 1: 'height' is given twice");
  EXPECT_EQ(refusalOfText("clouds:\n- topic: a\n- topic: b\n  padding: 0\n  padding: 1\n"),
            "line 5: 'padding' is given twice");
  EXPECT_EQ(refusalOfText("link_padding:\n  a: {b: {c: 1, \"c\": 2}}\n"),
            "line 2: 'c' is given twice");
  EXPECT_EQ(refusalOfText("links: [a, a]\nclouds: [{topic: a}, {topic: a}]\n"), "accepted");
}

TEST(SettingsFile, HasOneDocument) {
  for (const char* end : {"---", "..."}) {
    EXPECT_EQ(refusalOfText(std::string("padding: 0\n") + end + "\npadding: 1\n"),
              "it has 2 documents (after '---' or '...'), but must have one");
  }
  EXPECT_EQ(refusalOfText("---\npadding: 0\n"), "accepted");
  EXPECT_TRUE(loadYaml("# nothing\n").IsNull());
}

TEST(SceneConfig, NumbersReachTheEndsOfTheirRanges) {
  for (const char* right :
       {"max_hull_vertices: 0", "max_hull_vertices: 4", "max_hull_vertices: 1000000", "padding: 0",
        "link_padding: {a: 0}", "pair_padding: [{pair: [a, b], padding: 0}]"}) {
    EXPECT_EQ(refusal(right), "accepted") << right;
  }
}

TEST(SceneSettingsMap, HasTheLimitsOfPosesAndSaysWhatOnlyTheNodeFollows) {
  const auto read = [](const std::string& yaml) {
    return readSceneSettings(YAML::Load(yaml), "x.yaml");
  };
  const PoseLimits defaults = read("{}").pose_limits;
  const PoseLimits given =
      read("{max_pose_age: 0.25, max_transform_age: 0.125, clock_tolerance: 0}").pose_limits;
  EXPECT_EQ(given.max_pose_age, 0.25);
  EXPECT_EQ(given.max_transform_age, 0.125);
  EXPECT_EQ(given.clock_tolerance, 0.0);
  EXPECT_EQ(defaults.max_pose_age, PoseLimits().max_pose_age);
  const auto refused = [&](const std::string& yaml) {
    return collision_pairs::refusal([&] { read(yaml); });
  };
  for (const std::string key : {"max_pose_age", "max_transform_age", "clock_tolerance"}) {
    EXPECT_EQ(refused(key + ": 0"), "accepted");
    for (const std::string wrong : {"-0.1", "old"}) {
      EXPECT_EQ(refused(key + ": " + wrong),
                "x.yaml: " + key + " is " + wrong + ", but must be a number of seconds, 0 or more");
    }
  }
  EXPECT_EQ(refused("words"), "x.yaml: must be a map of settings, such as padding: 0.01");
  EXPECT_EQ(refused("~"), "accepted");
  EXPECT_EQ(refused("rat: 1"), "x.yaml: 'rat' is not a setting; did you mean 'rate'?");
  const std::vector<std::pair<std::string, std::vector<std::string>>> cases = {
      {"robots: [a]", {"robots"}},
      {"robots: x", {"robots"}},
      {"robots: {a: b}", {"robots"}},
      {"robots: []", {}},
      {"robots: {}", {}},
      {"robots: ''", {}},
      {"robots: ~", {}},
      {"fixed_frame: map", {"fixed_frame"}},
      {"{floor: {height: 0}, fixed_frame: map}", {"fixed_frame"}},
      {"{floor: {height: 0}, fixed_frame: ''}", {}},
      {"{floor: {}, fixed_frame: map}", {"fixed_frame"}},
      {"{floor: {height: 0}, fixed_frame: map, robots: [a]}", {"robots", "fixed_frame"}}};
  for (const auto& [yaml, ignored] : cases) EXPECT_EQ(read(yaml).of_the_node_only, ignored) << yaml;
}

/// Calls visit(map) for each map in `node` whose keys are words, not names of links.
void forEachMap(YAML::Node node, const std::function<void(YAML::Node map)>& visit) {
  if (node.IsMap()) visit(node);
  for (const auto& entry : node) {
    const bool has_key = node.IsMap();
    const std::string key = has_key ? entry.first.as<std::string>() : "";
    if (key == "link_fidelity" || key == "link_padding") continue;
    forEachMap(has_key ? entry.second : entry, visit);
  }
}

// Whatever word is wrong or new, wherever it stands, its setting would not be followed.
TEST(SceneSettingsMap, NoWordThatIsNotKnownIsSkippedAnywhere) {
  const std::string whole =
      "{padding: 0.01, link_padding: {arm: 0.02}, pair_padding: [{pair: [a, b], padding: 0.01}], "
      "pair_rules: [{allow: [a, b]}, {deny: [b, c]}], floor: {height: 0, touch_links: [a]}, "
      "clouds: [{topic: points, voxel_size: 0.02, max_range: 2, box: [0, 0, 0, 1, 1, 1]}], "
      "ignored_links: [x], max_pose_age: 1, fidelity: mesh, rate: 50, group: arm, links: [a]}";
  const auto refused = [](const YAML::Node& map) {
    return collision_pairs::refusal([&] { readSceneSettings(map, "x.yaml"); });
  };
  ASSERT_EQ(refused(YAML::Load(whole)), "accepted");
  std::size_t nb_tried = 0;
  std::size_t nb_maps = 0;
  YAML::Node first = YAML::Load(whole);
  forEachMap(first, [&](const YAML::Node&) { ++nb_maps; });
  for (std::size_t m = 0; m < nb_maps; ++m) {
    // Of the map number m: with one word more, then with each of its words misspelt.
    for (std::size_t word = 0; word <= 12; ++word) {
      YAML::Node root = YAML::Load(whole);
      std::size_t number = 0;
      std::string wrong;
      forEachMap(root, [&](YAML::Node map) {
        if (number++ != m) return;
        std::vector<std::string> keys;
        for (const auto& entry : map) keys.push_back(entry.first.as<std::string>());
        if (word == 0) {
          wrong = "frobnicate";
          map[wrong] = 1;
        } else if (word <= keys.size()) {
          const std::string key = keys[word - 1];
          wrong = key.substr(0, 1) + "q" + key.substr(1);
          map[wrong] = map[key];
          map.remove(key);
        }
      });
      if (wrong.empty()) continue;
      ++nb_tried;
      EXPECT_THAT(refused(root), testing::HasSubstr(wrong)) << root;
    }
  }
  EXPECT_GT(nb_tried, 25u);
}

TEST(SceneSettingsMap, WhatIsIgnoredIsWarnedOfInOneSentence) {
  SceneConfig config = readSceneConfig(YAML::Load("clouds: [{topic: /a}, {topic: b}]"));
  const std::string warned = "ignored, so a state may be free only without them: ";
  EXPECT_EQ(warningOfIgnored(config, {}, false), warned + "cloud '/a', cloud 'b'");
  EXPECT_EQ(warningOfIgnored(config, {config.clouds[1]}, false), warned + "cloud '/a'");
  EXPECT_EQ(warningOfIgnored(config, config.clouds, false), "");
  config.of_the_node_only = {"robots"};
  EXPECT_EQ(warningOfIgnored(config, config.clouds, false), warned + "robots");
  config.of_the_node_only = {"fixed_frame"};
  EXPECT_EQ(warningOfIgnored(config, config.clouds, false), "") << "the robot alone is in it";
  EXPECT_EQ(warningOfIgnored(config, config.clouds, true), warned + "fixed_frame");
  config.floor = RigidObject();
  EXPECT_EQ(warningOfIgnored(config, config.clouds, false), warned + "fixed_frame");
}

class ConfigFile : public testing::Test {
 protected:
  std::string refusalOf(const std::string& yaml) {
    std::ofstream(path_) << yaml;
    return collision_pairs::refusal([&] { readSceneConfigFile(path_); });
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

}  // namespace collision_pairs::test_scene_config
