#include "cloud_config.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <tuple>

#include "collision_pairs/input_error.h"
#include "user_text.h"
#include "yaml_values.h"

namespace collision_pairs {
namespace {

double above0(const std::string& key, const YAML::Node& value) {
  const double found = numberOf(key, value, "more than 0 metres");
  if (found <= 0.0) refuseValue(key, value, "more than 0 metres");
  return found;
}

double secondsOf(const std::string& key, const YAML::Node& value) {
  return numberOf(key, value, "0 or more seconds", 0.0);
}

int countOf(const std::string& key, const YAML::Node& value, int least = 1,
            int most = 100'000'000) {
  const std::string rule =
      "a whole number from " + std::to_string(least) + " to " + std::to_string(most);
  const double found = numberOf(key, value, rule, least);
  if (found > most || found != std::floor(found)) refuseValue(key, value, rule);
  return static_cast<int>(found);
}

/// Of a larger one no obstacle would be left: these are millimetres.
double paddingOf(const std::string& key, const YAML::Node& value) {
  const std::string rule = "0 to 0.5 metres";
  const double found = numberOf(key, value, rule, 0.0);
  if (found > 0.5) refuseValue(key, value, rule);
  return found;
}

std::string topicOf(const std::string& key, const YAML::Node& value) {
  const std::string rule = "the name of a topic, such as camera/points";
  const std::string topic = textOf(key, value, rule);
  if (topic.find_first_not_of('/') == std::string::npos) refuseValue(key, value, rule);
  return topic;
}

std::optional<Eigen::AlignedBox3d> boxOf(const std::string& key, const YAML::Node& value) {
  const std::string rule =
      "[min_x, min_y, min_z, max_x, max_y, max_z] in metres, or [] for everything";
  if (!value.IsSequence()) refuseValue(key, value, rule);
  if (value.size() == 0) return std::nullopt;
  if (value.size() != 6) refuseValue(key, value, rule);
  Eigen::AlignedBox3d box;
  for (int axis = 0; axis < 3; ++axis) {
    box.min()[axis] = numberOf(key, value[axis], rule);
    box.max()[axis] = numberOf(key, value[axis + 3], rule);
  }
  if (box.isEmpty()) refuseValue(key, value, rule);
  return box;
}

using CloudReader = std::function<void(const std::string& key, const YAML::Node&, CloudConfig&)>;

const std::map<std::string, CloudReader>& cloudReaders() {
  static const std::map<std::string, CloudReader> ALL = {
      {"topic", [](const auto& k, const auto& v, auto& c) { c.topic = topicOf(k, v); }},
      {"voxel_size", [](const auto& k, const auto& v, auto& c) { c.voxel_size = above0(k, v); }},
      {"max_range", [](const auto& k, const auto& v, auto& c) { c.max_range = above0(k, v); }},
      {"min_points",
       [](const auto& k, const auto& v, auto& c) { c.min_points = countOf(k, v, 1, 1000); }},
      {"min_valid_points",
       [](const auto& k, const auto& v, auto& c) { c.min_valid_points = countOf(k, v, 0); }},
      {"decay", [](const auto& k, const auto& v, auto& c) { c.decay = secondsOf(k, v); }},
      {"replace", [](const auto& k, const auto& v, auto& c) { c.replace = flagOf(k, v); }},
      {"box", [](const auto& k, const auto& v, auto& c) { c.box = boxOf(k, v); }},
      {"max_voxels", [](const auto& k, const auto& v, auto& c) { c.max_voxels = countOf(k, v); }},
      {"source_timeout",
       [](const auto& k, const auto& v, auto& c) { c.source_timeout = secondsOf(k, v); }},
      {"self_filter_padding",
       [](const auto& k, const auto& v, auto& c) { c.self_filter_padding = paddingOf(k, v); }},
      {"touch_links", [](const auto& k, const auto& v, auto& c) { c.touch_links = namesOf(k, v); }},
  };
  return ALL;
}

std::vector<std::string> knownKeys() {
  std::vector<std::string> keys;
  for (const auto& entry : cloudReaders()) keys.push_back(entry.first);
  return keys;
}

CloudConfig readCloud(const std::string& origin, const YAML::Node& value) {
  const std::string rule = "a map such as {topic: camera/points, voxel_size: 0.02}";
  CloudConfig cloud;
  forEntries(origin, value, rule, [&](const std::string& key, const YAML::Node& entry) {
    const auto reader = cloudReaders().find(key);
    if (reader == cloudReaders().end()) {
      throw InputError(origin + ": '" + key + "' is not a setting of a cloud" +
                       didYouMean(key, knownKeys()));
    }
    reader->second(origin + '/' + key, entry, cloud);
  });
  if (cloud.topic.empty()) throw InputError(origin + " has no topic");
  return cloud;
}

}  // namespace

std::string CloudConfig::name() const { return topic.substr(topic.find_first_not_of('/')); }

bool operator==(const CloudConfig& a, const CloudConfig& b) {
  const auto all = [](const CloudConfig& c) {
    return std::tie(c.topic, c.voxel_size, c.max_range, c.min_points, c.min_valid_points, c.decay,
                    c.replace, c.max_voxels, c.source_timeout, c.self_filter_padding,
                    c.touch_links);
  };
  const bool same_box = a.box.has_value() == b.box.has_value() &&
                        (!a.box || (a.box->min() == b.box->min() && a.box->max() == b.box->max()));
  return same_box && all(a) == all(b);
}

RigidObject obstacleOf(const CloudConfig& cloud) {
  RigidObject obstacle = cloudOf(cloud.name(), cloud.voxel_size, cloud.touch_links);
  obstacle.padding = cloud.padding();
  return obstacle;
}

const CloudConfig* findCloud(const std::vector<CloudConfig>& clouds, const std::string& name) {
  const auto found = std::find_if(clouds.begin(), clouds.end(),
                                  [&](const CloudConfig& cloud) { return cloud.name() == name; });
  return found == clouds.end() ? nullptr : &*found;
}

std::vector<CloudConfig> readClouds(const YAML::Node& value) {
  const std::string rule = "a list of maps such as {topic: camera/points, voxel_size: 0.02}";
  if (!value.IsSequence()) refuseValue("clouds", value, rule);
  std::vector<CloudConfig> clouds;
  for (std::size_t i = 0; i < value.size(); ++i) {
    CloudConfig cloud = readCloud("clouds[" + std::to_string(i) + "]", value[i]);
    if (findCloud(clouds, cloud.name())) {
      throw InputError("clouds: topic '" + cloud.topic + "' is listed twice");
    }
    clouds.push_back(std::move(cloud));
  }
  return clouds;
}

}  // namespace collision_pairs
