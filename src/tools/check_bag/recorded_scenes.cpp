#include "recorded_scenes.h"

#include <iterator>

#include "collision_pairs/input_error.h"
#include "message_layout.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

StampNs sinceOf(const Scene& scene) { return static_cast<StampNs>(scene.header.stamp.toNSec()); }

}  // namespace

bool RecordedScenes::isScene(const RawMessage& raw) {
  if (raw.type != ros::message_traits::DataType<Scene>::value()) return false;
  if (raw.md5sum == ros::message_traits::MD5Sum<Scene>::value()) return true;
  throw InputError(
      "the scenes on topic '" + raw.topic +
      "' are of another version of collision_pairs: check it with that one, or copy it "
      "without them (rosbag filter) and pass the robot and what else was there");
}

void RecordedScenes::take(const RawMessage& raw) {
  if (!isScene(raw)) return;
  auto scene = readMessage<Scene>(raw.data, raw.size);
  Track& track = tracks_[raw.topic];
  auto& revision = track.revisions[raw.received];
  if (!scene) return;
  if (!revision || revision->number <= scene->revision) {
    revision = {scene->revision, sinceOf(*scene)};
  }
  if (raw.received >= track.first_arrival) return;
  track.first_arrival = raw.received;
  track.first = std::move(*scene);
}

void RecordedScenes::finish(const BagRecords& records) {
  losses_ = records.losses;
  for (const BagConnection& connection : records.connections) {
    const bool is_of_scenes = connection.type == ros::message_traits::DataType<Scene>::value();
    if (is_of_scenes) tracks_.try_emplace(connection.topic);
  }
}

const Scene& RecordedScenes::first() const {
  const Track& track = tracks_.at(topic_);
  if (track.first_arrival != NEVER) return track.first;
  throw InputError("none of the scenes on " + topic_ +
                   " can be read; what was checked then is not known: --urdf gives a robot");
}

bool RecordedScenes::choose(const std::string& topic) {
  std::vector<std::string> topics;
  for (const auto& entry : tracks_) topics.push_back(entry.first);
  if (topic.empty() && topics.size() > 1) {
    throw InputError("several scenes in it (" + topics[0] + ", " + topics[1] +
                     "); choose one with --scene");
  }
  topic_ = topic.empty() && !topics.empty() ? topics.front() : topic;
  if (topic_.empty()) return false;
  if (tracks_.count(topic_) == 0) {
    throw InputError("--scene: it has no scenes on topic '" + topic_ +
                     "'; topics with scenes: " + (topics.empty() ? "none" : joined(topics)));
  }
  return true;
}

std::string RecordedScenes::whySuspectAt(StampNs now) const {
  const Track& track = tracks_.at(topic_);
  const auto next = track.revisions.upper_bound(now);
  const bool is_before = next == track.revisions.begin();
  const StampNs arrival = is_before ? EVER_SINCE : std::prev(next)->first;
  for (const BagLoss& loss : losses_) {
    if (arrival < loss.before && loss.after < now) {
      return "parts of the bag could not be read, and there may have been scenes on " + topic_;
    }
  }
  if (now < track.first_arrival) {
    return sinceOf(track.first) <= now ? ""
                                       : "the first scene on " + topic_ + " is of a later time";
  }
  const auto& last = std::prev(next)->second;
  if (!last) return "the last scene on " + topic_ + " cannot be read";
  if (next == track.revisions.end() || !next->second) return "";
  const auto& [number, since] = *next->second;
  const bool is_new_node =  // which counts from 1
      number < last->number || (number == last->number && since != last->since);
  const std::uint64_t known = is_new_node ? 0 : last->number;
  if (number <= known + 1) return "";
  return std::to_string(number - known - 1) + " scenes " +
         (is_new_node ? "before revision " + std::to_string(number)
                      : "after revision " + std::to_string(last->number)) +
         " on " + topic_ + " are not in the bag";
}

}  // namespace collision_pairs
