// Settings as text: they read back as what they were.
#include <cmath>
#include <iomanip>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "random_inputs.h"
#include "refusal.h"
#include "scene_config.h"
#include "yaml_values.h"

namespace collision_pairs::test_settings_text {

using testing::HasSubstr;

const char* const KINDS[] = {"aabb", "spheres", "obb", "convex", "mesh"};

/// Names that YAML would take for something else.
const std::vector<std::string> STRANGE_NAMES = {
    "1",  "1e5",   "0x10", "yes", "off", "true", "~",   "null", "Null", ".inf",   ".nan", "a: b",
    "#x", "x #y",  "- a",  "[a",  "a]",  "{",    "a,b", "*",    "&a",   "!t",     "%d",   "@",
    "`",  "'",     "\"",   "\\n", "?",   "|",    ">",   "=",    "<<",   " blank", "a\nb", "tab\t",
    "é",  "a/b/c", "---",  "...", "",    "x'y",  "a:",  ":a",   "0777", "1_000",  "12:30"};

std::string describedSettings(const SceneConfig& config) {
  std::ostringstream text;
  text << std::hexfloat;
  const auto names = [&](const char* key, const std::vector<std::string>& list) {
    text << '\n' << key << list.size();
    for (const std::string& name : list) text << '|' << name << '|';
  };
  const SceneSettings& s = config.settings;
  text << s.max_hull_vertices << static_cast<int>(s.narrow_phase) << s.allow_empty_scene
       << s.padding;
  for (const auto& [link, kind] : s.link_fidelity) text << '|' << link << static_cast<int>(kind);
  for (const auto& [link, size] : s.link_padding) text << '|' << link << '|' << size;
  for (const auto& entry : s.pair_padding) {
    text << "\npair" << entry.first << '|' << entry.second << '|' << entry.metres;
  }
  for (const auto& rule : s.pair_rules) {
    text << "\nrule" << static_cast<int>(rule.verdict) << rule.first << '|' << rule.second;
  }
  names("ignored", s.ignored_links);
  names("capsules", s.cylinder_as_capsule);
  names("static", config.static_joints);
  names("links", config.restriction.names);
  text << "\ngroup" << config.restriction.group;
  if (config.floor) {
    text << config.floor->X_PO.matrix();
    names("floor", config.floor->touch_links);
  }
  for (const CloudConfig& c : config.clouds) {
    text << '\n'
         << c.topic << '|' << c.voxel_size << '|' << c.max_range << '|' << c.min_points << '|'
         << c.min_valid_points << '|' << c.decay << '|' << c.replace << '|' << c.max_voxels << '|'
         << c.source_timeout << '|' << c.self_filter_padding;
    if (c.box) text << c.box->min().transpose() << '|' << c.box->max().transpose();
    names("cloud", c.touch_links);
  }
  return text.str();
}

TEST(SettingsText, ReadsBackAsTheSameWhateverItsNamesAndNumbers) {
  RandomInputs random;
  const auto name = [&] {
    return STRANGE_NAMES[static_cast<std::size_t>(
        random.integer(0, static_cast<int>(STRANGE_NAMES.size()) - 1))];
  };
  const auto number = [&] { return std::pow(10.0, random.uniform(-12, 6)); };
  const auto names = [&] {
    YAML::Node list(YAML::NodeType::Sequence);
    for (int i = random.integer(0, 3); i > 0; --i) list.push_back(name());
    return list;
  };
  const auto pair = [&] {
    YAML::Node list;
    list.push_back(name());
    list.push_back(name());
    return list;
  };
  for (int i = 0; i < 500; ++i) {
    YAML::Node map;
    for (const char* key : {"ignored_links", "static_joints", "cylinder_as_capsule", "links"}) {
      map[key] = names();
    }
    map["group"] = name();
    map["padding"] = number();
    map["allow_empty_scene"] = random.integer(0, 1) == 1;
    map["max_hull_vertices"] = random.integer(4, 1000);
    map["narrow_phase"] = random.integer(0, 1) ? "fcl" : "native";
    map["link_padding"][name()] = number();
    map["link_padding"]["a"]["b"] = number();  // as the parameter server has a/b
    map["link_fidelity"][name()] = KINDS[random.integer(0, 4)];
    YAML::Node padding;
    padding["pair"] = pair();
    padding["padding"] = number();
    map["pair_padding"].push_back(padding);
    YAML::Node rule;
    rule[random.integer(0, 1) ? "allow" : "deny"] = pair();
    map["pair_rules"].push_back(rule);
    map["floor"]["height"] = -number();
    map["floor"]["touch_links"] = names();
    YAML::Node cloud;
    cloud["topic"] = "t" + name();
    cloud["touch_links"] = names();
    for (const char* key : {"voxel_size", "max_range", "decay", "source_timeout"}) {
      cloud[key] = number();
    }
    cloud["self_filter_padding"] = random.uniform(0.0, 0.5);
    cloud["min_points"] = random.integer(1, 9);
    cloud["replace"] = random.integer(0, 1) == 1;
    for (int k = 0; k < 6; ++k) cloud["box"].push_back(k < 3 ? -number() : number());
    map["clouds"].push_back(cloud);
    for (const std::string& key : sceneConfigKeys()) EXPECT_TRUE(map[key]) << key;
    const PoseLimits limits{number(), number(), number()};
    const std::string text = settingsText(map, limits);
    const SceneConfig back = readSceneSettings({"the settings", text});
    ASSERT_EQ(describedSettings(back), describedSettings(readSceneConfig(map))) << text;
    EXPECT_EQ(back.pose_limits.max_pose_age, limits.max_pose_age);
    EXPECT_EQ(back.pose_limits.max_transform_age, limits.max_transform_age);
    EXPECT_EQ(back.pose_limits.clock_tolerance, limits.clock_tolerance);
  }
}

TEST(SettingsText, WithANumberThatIsNotFiniteIsRefused) {
  for (const double value : {HUGE_VAL, std::nan("")}) {
    YAML::Node map;
    map["padding"] = value;
    EXPECT_THAT(refusal([&] {
                  readSceneSettings({"it", settingsText(map, {})});
                }),
                HasSubstr("it: padding is"));
  }
}

// Aliases make a document of a few lines endless, or larger than any memory.
TEST(SettingsText, AliasesMakeItNeitherEndlessNorHuge) {
  const auto refused = [](const std::string& text) { return refusal([&] { loadYaml(text); }); };
  const std::string deep = "more than 100 values are nested in each other";
  EXPECT_EQ(refused("pair_rules: &a [*a]\n"), deep);
  EXPECT_EQ(refused("link_padding: &a {tip: 0.1, x: *a}\n"), deep);
  EXPECT_EQ(refused("a: " + std::string(101, '[') + std::string(101, ']')), deep);
  EXPECT_EQ(refused("a: " + std::string(98, '[') + std::string(98, ']')), "accepted");
  std::string bomb = "a0: &a0 [1]\n";
  for (int i = 1; i < 12; ++i) {
    const std::string before = "*a" + std::to_string(i - 1);
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + before;
    for (int k = 0; k < 9; ++k) bomb += ", " + before;
    bomb += "]\n";
  }
  EXPECT_EQ(refused(bomb), "it has more than a million values");
  EXPECT_EQ(refused("padding: &a 0.5\nlink_padding: {x: *a, y: *a}\n"), "accepted");
}

TEST(SettingsText, AKeyIsOneWord) {
  for (const char* key : {"? [a, b]", "? {a: b}", "? &a [*a]", "? ~"}) {
    EXPECT_EQ(refusal([&] { loadYaml("a: 1\n" + std::string(key) + "\n: 1\n"); }),
              "line 2: a key must be a name")
        << key;
  }
}

}  // namespace collision_pairs::test_settings_text
