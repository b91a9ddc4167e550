#include "bag_clouds.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <sensor_msgs/PointCloud2.h>

#include "collision_pairs/input_error.h"
#include "message_walk.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

bool isCloud(const RawMessage& raw) {
  return raw.md5sum == ros::message_traits::MD5Sum<sensor_msgs::PointCloud2>::value();
}

/// As CloudConfig::name().
std::string_view nameOf(std::string_view topic) {
  topic.remove_prefix(std::min(topic.find_first_not_of('/'), topic.size()));
  return topic;
}

/// 0 if the message is too short.
StampNs stampOf(const RawMessage& raw) {
  std::uint32_t number_and_stamp[3];
  if (raw.size < sizeof number_and_stamp) return 0;
  std::memcpy(number_and_stamp, raw.data, sizeof number_and_stamp);
  return StampNs{number_and_stamp[1]} * 1000000000 + number_and_stamp[2];
}

std::string problemOf(StampNs stamp, StampNs received, StampNs newest, StampNs tolerance) {
  if (stamp == 0) return "its stamp is zero";
  if (stamp - received > tolerance) {
    return "its stamp is " + inWords(inSeconds(stamp - received)) +
           " ahead of the time at which it was recorded";
  }
  if (stamp <= newest) {
    return "its stamp is not later than that of the previous cloud: are there two publishers, or "
           "did the clock go back?";
  }
  return "";
}

}  // namespace

BagCloudIndex::BagCloudIndex(const std::vector<std::string>& topics, double clock_tolerance)
    : clock_tolerance_(std::llround(1e9 * clock_tolerance)) {
  for (const std::string& topic : topics) sources_.push_back({topic});
}

int BagCloudIndex::sourceOf(const RawMessage& raw) const {
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    if (nameOf(raw.topic) == nameOf(sources_[i].topic)) return static_cast<int>(i);
  }
  return -1;
}

void BagCloudIndex::take(const RawMessage& raw) {
  if (sources_.empty()) return;
  const int number = sourceOf(raw);
  const bool is_cloud = isCloud(raw);
  if (is_cloud) cloud_topics_.insert(raw.topic);
  if (number < 0) return;
  Source& source = sources_[number];
  (is_cloud ? source.has_cloud : source.is_other_type) = true;
  if (!is_cloud) return;
  const StampNs stamp = stampOf(raw);
  std::string problem = problemOf(stamp, raw.received, source.newest, clock_tolerance_);
  if (problem.empty()) source.newest = stamp;
  source.arrival = std::max(source.arrival, raw.received);
  entries_.push_back({number, stamp, source.arrival, std::move(problem)});
}

void BagCloudIndex::requireAllSources() const {
  for (const Source& source : sources_) {
    if (source.is_other_type) {
      throw InputError("--clouds: topic '" + source.topic +
                       "' is not of type sensor_msgs/PointCloud2");
    }
    if (source.has_cloud) continue;
    const std::string found = joined({cloud_topics_.begin(), cloud_topics_.end()});
    throw InputError("--clouds: the bag has no messages on topic '" + source.topic +
                     "'; topics with clouds: " + (found.empty() ? "none" : found));
  }
}

bool pointCloudFits(const RawMessage& raw) {
  constexpr std::uint64_t HEIGHT_AND_WIDTH = 8, OF_FIELD = 9, STEPS = 9;  // bytes
  Walk walk(raw.data, raw.size);
  std::uint32_t nb_fields;
  if (!walk.skipHeader() || !walk.skip(HEIGHT_AND_WIDTH) || !walk.count(nb_fields, 4 + OF_FIELD)) {
    return false;
  }
  for (std::uint32_t i = 0; i < nb_fields; ++i) {
    if (!walk.skipArray(1) || !walk.skip(OF_FIELD)) return false;
  }
  return walk.skip(STEPS) && walk.skipArray(1) && walk.skip(1);
}

}  // namespace collision_pairs
