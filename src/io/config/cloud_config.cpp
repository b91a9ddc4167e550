#include "cloud_config.h"

#include <algorithm>
#include <limits>
#include <tuple>

#include "collision_pairs/input_error.h"
#include "yaml_values.h"

namespace collision_pairs {
namespace {

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

/// Of a larger padding no obstacle would be left: these are millimetres.
constexpr Range PADDING{0.0, 0.5};
constexpr Range ABOVE_0{0.0, std::numeric_limits<double>::max(), true};
constexpr int MOST_VOXELS = 100'000'000;

CloudConfig readCloud(const std::string& origin, const YAML::Node& value) {
  const std::string above_0 = "more than 0 metres", seconds = "0 or more seconds";
  CloudConfig c;
  readFields(
      origin, value, "a map such as {topic: camera/points, voxel_size: 0.02}",
      "a setting of a cloud",
      {{"topic", [&](auto& k, auto& v) { c.topic = topicOf(k, v); }},
       {"voxel_size", [&](auto& k, auto& v) { c.voxel_size = numberOf(k, v, above_0, ABOVE_0); }},
       {"max_range", [&](auto& k, auto& v) { c.max_range = numberOf(k, v, above_0, ABOVE_0); }},
       {"min_points", [&](auto& k, auto& v) { c.min_points = wholeNumberOf(k, v, 1, 1000); }},
       {"min_valid_points",
        [&](auto& k, auto& v) { c.min_valid_points = wholeNumberOf(k, v, 0, MOST_VOXELS); }},
       {"decay", [&](auto& k, auto& v) { c.decay = numberOf(k, v, seconds, {0.0}); }},
       {"replace", [&](auto& k, auto& v) { c.replace = flagOf(k, v); }},
       {"box", [&](auto& k, auto& v) { c.box = boxOf(k, v); }},
       {"max_voxels",
        [&](auto& k, auto& v) { c.max_voxels = wholeNumberOf(k, v, 1, MOST_VOXELS); }},
       {"source_timeout",
        [&](auto& k, auto& v) { c.source_timeout = numberOf(k, v, seconds, {0.0}); }},
       {"self_filter_padding",
        [&](auto& k, auto& v) {
          c.self_filter_padding = numberOf(k, v, "0 to 0.5 metres", PADDING);
        }},
       {"touch_links", [&](auto& k, auto& v) { c.touch_links = namesOf(k, v); }}});
  if (c.topic.empty()) throw InputError(origin + " has no topic");
  return c;
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
