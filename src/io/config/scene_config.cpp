#include "scene_config.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "collision_pairs/input_error.h"
#include "user_text.h"
#include "yaml_values.h"

namespace collision_pairs {
namespace {

std::pair<std::string, std::string> twoNames(const std::string& key, const YAML::Node& value) {
  const auto found = namesOf(key, value);
  if (found.size() != 2)
    refuseValue(key, value, "two names or patterns, such as [\"left_*\", base]");
  return {found[0], found[1]};
}

/// forEntries() of a map by link. The parameter server stores a/b as b in a map a. In a file, such
/// a map may contain itself by an alias, or expand to more links than fit into memory.
void forLinks(const std::string& key, const YAML::Node& value, const std::string& rule,
              const std::function<void(const std::string&, const YAML::Node&)>& read) {
  constexpr std::size_t DEEPEST = 100, MOST = 100'000;  // parts of a name; links
  std::size_t nb_links = 0;
  const std::function<void(const YAML::Node&, const std::string&, std::size_t)> visit =
      [&](const YAML::Node& map, const std::string& prefix, std::size_t depth) {
        forEntries(key, map, rule, [&](const std::string& name, const YAML::Node& entry) {
          if (depth > DEEPEST || nb_links > MOST) {
            throw InputError(key + " names more than " + std::to_string(MOST) +
                             " links, or contains itself through an alias");
          }
          if (entry.IsMap() && entry.size() > 0)
            return visit(entry, prefix + name + "/", depth + 1);
          ++nb_links;
          read(prefix + name, entry);
        });
      };
  visit(value, "", 0);
}

void readLinkFidelity(const YAML::Node& value, SceneConfig& config) {
  forLinks("link_fidelity", value, "a map from links to aabb, spheres, obb, convex or mesh",
           [&](const std::string& link, const YAML::Node& word) {
             const std::string key = "link_fidelity/" + link;
             const std::string rule = "aabb, spheres, obb, convex or mesh";
             const std::string given = textOf(key, word, rule);
             const std::vector<std::string> known = {"aabb", "spheres", "obb", "convex", "mesh"};
             if (!contains(known, given)) refuseValue(key, word, rule + didYouMean(given, known));
             config.settings.link_fidelity[link] = parseFidelity(given);
           });
}

void readLinkPadding(const YAML::Node& value, SceneConfig& config) {
  forLinks("link_padding", value, "a map from links to metres",
           [&](const std::string& link, const YAML::Node& size) {
             config.settings.link_padding[link] = metresOf("link_padding/" + link, size);
           });
}

void readPairPadding(const YAML::Node& value, SceneConfig& config) {
  const std::string rule = "a list of {pair: [first, second], padding: metres}";
  if (!value.IsSequence()) refuseValue("pair_padding", value, rule);
  for (const YAML::Node& entry : value) {
    if (!entry.IsMap() || entry.size() != 2 || !entry["pair"] || !entry["padding"]) {
      refuseValue("pair_padding", entry, rule);
    }
    const auto [first, second] = twoNames("pair_padding", entry["pair"]);
    const double size = metresOf("pair_padding", entry["padding"]);
    config.settings.pair_padding.push_back({first, second, size});
  }
}

void readPairRules(const YAML::Node& value, SceneConfig& config) {
  const std::string rule = "a list of {allow: [first, second]} and {deny: [first, second]}";
  if (!value.IsSequence()) refuseValue("pair_rules", value, rule);
  for (const YAML::Node& entry : value) {
    if (!entry.IsMap() || entry.size() != 1) refuseValue("pair_rules", entry, rule);
    const std::string word = entry.begin()->first.Scalar();
    if (word != "allow" && word != "deny") refuseValue("pair_rules", entry, rule);
    const auto [first, second] = twoNames("pair_rules", entry.begin()->second);
    config.settings.pair_rules.push_back(
        {word == "allow" ? PairRule::Verdict::ALLOW : PairRule::Verdict::DENY, first, second});
  }
}

void readFloor(const YAML::Node& value, SceneConfig& config) {
  const std::string rule = "{height: metres, touch_links: [names]}, or {} for none";
  double height = NAN;
  std::vector<std::string> touch_links;
  forEntries("floor", value, rule, [&](const std::string& key, const YAML::Node& entry) {
    if (key == "height") {
      height = numberOf("floor/height", entry, "a number of metres");
    } else if (key == "touch_links") {
      touch_links = namesOf("floor/touch_links", entry);
    } else {
      refuseValue("floor", value, rule);
    }
  });
  if (value.size() == 0) return;
  if (std::isnan(height)) refuseValue("floor", value, rule);
  config.floor = floorAt(height, touch_links);
}

void readNarrowPhase(const YAML::Node& value, SceneConfig& config) {
  const std::string rule = "native or fcl";
  try {
    config.settings.narrow_phase = parseNarrowPhase(textOf("narrow_phase", value, rule));
  } catch (const InputError&) {
    refuseValue("narrow_phase", value, rule);
  }
}

void readMaxHullVertices(const YAML::Node& value, SceneConfig& config) {
  const std::string rule = "4 or more, or 0 for exact hulls";
  const double count = numberOf("max_hull_vertices", value, rule);
  const bool fits = count == 0.0 || (count >= 4.0 && count <= 1e6);
  if (!fits || count != std::floor(count)) refuseValue("max_hull_vertices", value, rule);
  config.settings.max_hull_vertices = static_cast<int>(count);
}

void readPoseLimits(const YAML::Node& map, PoseLimits& limits) {
  const auto read = [&](const char* key, double& value) {
    const YAML::Node given = map[key];
    if (given) value = numberOf(key, given, "a number of seconds, 0 or more", {0.0});
  };
  read("max_pose_age", limits.max_pose_age);
  read("max_transform_age", limits.max_transform_age);
  read("clock_tolerance", limits.clock_tolerance);
}

using SceneReader = std::function<void(const YAML::Node&, SceneConfig&)>;

const std::map<std::string, SceneReader>& sceneReaders() {
  static const std::map<std::string, SceneReader> ALL = {
      {"max_hull_vertices", readMaxHullVertices},
      {"narrow_phase", readNarrowPhase},
      {"link_fidelity", readLinkFidelity},
      {"link_padding", readLinkPadding},
      {"pair_padding", readPairPadding},
      {"pair_rules", readPairRules},
      {"floor", readFloor},
      {"clouds", [](const auto& v, auto& c) { c.clouds = readClouds(v); }},
      {"allow_empty_scene",
       [](const auto& v, auto& c) {
         c.settings.allow_empty_scene = flagOf("allow_empty_scene", v);
       }},
      {"padding", [](const auto& v, auto& c) { c.settings.padding = metresOf("padding", v); }},
      {"ignored_links",
       [](const auto& v, auto& c) { c.settings.ignored_links = namesOf("ignored_links", v); }},
      {"static_joints",
       [](const auto& v, auto& c) { c.static_joints = namesOf("static_joints", v); }},
      {"cylinder_as_capsule",
       [](const auto& v, auto& c) {
         c.settings.cylinder_as_capsule = namesOf("cylinder_as_capsule", v);
       }},
      {"group",
       [](const auto& v, auto& c) { c.restriction.group = textOf("group", v, "a group's name"); }},
      {"links", [](const auto& v, auto& c) { c.restriction.names = namesOf("links", v); }},
  };
  return ALL;
}

}  // namespace

const std::vector<std::string>& sceneConfigKeys() {
  static const std::vector<std::string> KEYS = [] {
    std::vector<std::string> keys;
    for (const auto& entry : sceneReaders()) keys.push_back(entry.first);
    return keys;
  }();
  return KEYS;
}

const std::vector<std::string>& nodeParameterKeys() {
  static const std::vector<std::string> KEYS = [] {
    std::vector<std::string> keys = sceneConfigKeys();
    for (const char* key :
         {"alarm_distance",  "broad_phase",  "fidelity",     "tolerance",
          "time_budget",     "rate",         "robots",       "show_only_investigated_boxes",
          "verdict_only",    "min_distance", "max_pose_age", "max_transform_age",
          "clock_tolerance", "allow_paused", "fixed_frame",  "velocity_limiter",
          "reload",          "trigger",      "has_objects",  "configured"}) {
      keys.push_back(key);
    }
    return keys;
  }();
  return KEYS;
}

SceneConfig readSceneConfig(const YAML::Node& map) {
  SceneConfig config;
  for (const auto& [key, read] : sceneReaders()) {
    if (const YAML::Node value = map[key]) read(value, config);
  }
  return config;
}

std::string warningOfIgnored(const SceneConfig& config, const std::vector<CloudConfig>& used,
                             bool has_world) {
  std::vector<std::string> ignored;
  for (const std::string& key : config.of_the_node_only) {
    if (key != "fixed_frame" || config.floor || has_world) ignored.push_back(key);
  }
  for (const CloudConfig& cloud : config.clouds) {
    if (!findCloud(used, cloud.name())) ignored.push_back("cloud '" + cloud.topic + "'");
  }
  if (ignored.empty()) return "";
  return "ignored, so a state may be free only without them: " + joined(ignored);
}

SceneConfig readSceneSettings(const YAML::Node& map, const std::string& origin) {
  if (map.IsNull()) return {};
  if (!map.IsMap()) throw InputError(origin + ": must be a map of settings, such as padding: 0.01");
  const std::vector<std::string>& known = nodeParameterKeys();
  for (const auto& entry : map) {
    const std::string key = entry.first.Scalar();
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    throw InputError(origin + ": '" + key + "' is not a setting" + didYouMean(key, known));
  }
  return naming(origin, [&] {
    SceneConfig config = readSceneConfig(map);
    readPoseLimits(map, config.pose_limits);
    const auto isGiven = [&](const char* key) {
      const YAML::Node value = map[key];
      return value && (value.IsScalar() ? !value.Scalar().empty() : value.size() > 0);
    };
    if (isGiven("robots")) config.of_the_node_only.push_back("robots");
    if (isGiven("fixed_frame")) config.of_the_node_only.push_back("fixed_frame");
    return config;
  });
}

SceneConfig readSceneSettings(const TextFrom& yaml) {
  return readSceneSettings(naming(yaml.origin, [&] { return loadYaml(yaml.content); }),
                           yaml.origin);
}

SceneConfig readSceneConfigFile(const std::string& path) {
  return readSceneSettings(textFromFile(path));
}

std::string settingsText(const YAML::Node& map, const PoseLimits& limits) {
  YAML::Node all(YAML::NodeType::Map);
  for (const std::string& key : sceneConfigKeys()) {
    if (!map[key]) continue;
    all[key] = YAML::Clone(map[key]);
    all[key].SetStyle(YAML::EmitterStyle::Flow);  // a line each, as errors quote them
  }
  all["max_pose_age"] = limits.max_pose_age;
  all["max_transform_age"] = limits.max_transform_age;
  all["clock_tolerance"] = limits.clock_tolerance;
  YAML::Emitter text;
  text << all;
  return text.c_str();
}

}  // namespace collision_pairs
