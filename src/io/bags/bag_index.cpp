#include "bag_index.h"

#include <algorithm>
#include <filesystem>

#include <sensor_msgs/JointState.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/String.h>
#include <tf2_msgs/TFMessage.h>

#include "collision_pairs/input_error.h"
#include "joint_state_positions.h"
#include "message_layout.h"
#include "transform_buffer.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

constexpr StampNs CLOCK_WENT_BACK = 5000000000;  // 5 s: publishers differ by less
constexpr std::size_t MOST_WAITING = 1 << 30;    // bytes

/// The last part of a topic's name.
std::string nameIn(const std::string& topic) { return topic.substr(topic.rfind('/') + 1); }

template <class Message>
bool isType(const RawMessage& raw) {
  return raw.md5sum == ros::message_traits::MD5Sum<Message>::value();
}

class Indexer {
 public:
  explicit Indexer(const RawMessageFilter& wants) : wants_(wants) {}

  void take(const RawMessage& raw) {
    index_.topics.insert(raw.topic);
    if (wants_(raw)) index_.times.push_back(raw.received);
    switch (kindOf(raw)) {
      case BagTopic::TRANSFORMS:
        return count(takeTransforms(raw, false));
      case BagTopic::STATIC_TRANSFORMS:
        return count(takeTransforms(raw, true));
      case BagTopic::JOINT_STATES:
        return count(takeJoints(raw));
      case BagTopic::DESCRIPTION:
        return count(takeText(raw, index_.urdfs));
      case BagTopic::SEMANTICS:
        return count(takeText(raw, index_.srdfs));
      case BagTopic::CLOUDS:
        index_.cloud_topics.insert(raw.topic);
        return;
      case BagTopic::OTHER:
        return;
    }
  }

  BagIndex finish(const std::string& path, BagRecords records) {
    std::vector<BagLoss>& losses = records.losses;
    const auto note = [&](std::size_t count, const std::string& what) {
      if (count > 0) losses.push_back({std::to_string(count) + " " + what, NEVER});
    };
    note(nb_garbled_, "messages that do not match their type");
    note(nb_unusable_,
         "transforms and joint positions that are not finite, not a rotation, or not one for each "
         "name");
    note(nb_jumps_,
         "times its clock goes back; what is then too old is not used, so split the bag there");
    if (nb_messages_ == 0) {
      throw InputError(path + ": no transforms and no joint states in " +
                       (losses.empty() ? "it" : "what could be read: " + losses.back().what));
    }
    index_.records = std::move(records);
    return std::move(index_);
  }

 private:
  void count(bool fits) { ++(fits ? nb_messages_ : nb_garbled_); }

  void watchClock(const ros::Time& given, const RawMessage& raw) {
    const StampNs stamp = given.isZero() ? raw.received : static_cast<StampNs>(given.toNSec());
    if (stamp < newest_ - CLOCK_WENT_BACK)
      ++nb_jumps_;
    else if (stamp < newest_)
      return;
    newest_ = stamp;
  }

  bool takeTransforms(const RawMessage& raw, bool is_static) {
    const auto message = readMessage<tf2_msgs::TFMessage>(raw.data, raw.size);
    if (!message) return false;
    for (const auto& transform : message->transforms) {
      if (!is_static) watchClock(transform.header.stamp, raw);
      const auto& p = transform.transform.translation;
      const auto& q = transform.transform.rotation;
      if (isPose({p.x, p.y, p.z}, {q.w, q.x, q.y, q.z})) {
        index_.by_topic[withoutLeadingSlash(raw.topic)].insert(
            {withoutLeadingSlash(transform.header.frame_id),
             withoutLeadingSlash(transform.child_frame_id), is_static});
      } else {
        ++nb_unusable_;
      }
    }
    return true;
  }

  bool takeJoints(const RawMessage& raw) {
    const auto message = readMessage<sensor_msgs::JointState>(raw.data, raw.size);
    if (!message) return false;
    watchClock(message->header.stamp, raw);
    std::set<std::string>& names = index_.joints[raw.topic];
    const auto positions = finitePositionsIn(*message);
    for (const auto& entry : positions) names.insert(entry.first);
    nb_unusable_ += message->position.size() - positions.size();
    return true;
  }

  bool takeText(const RawMessage& raw, std::map<std::string, std::string>& texts) {
    auto message = readMessage<std_msgs::String>(raw.data, raw.size);
    if (!message) return false;
    const auto [known, is_new] = texts.emplace(raw.topic, message->data);
    if (!is_new && known->second != message->data) index_.changing.insert(raw.topic);
    return true;
  }

  const RawMessageFilter& wants_;
  BagIndex index_;
  StampNs newest_ = 0;
  std::size_t nb_messages_ = 0, nb_garbled_ = 0, nb_unusable_ = 0, nb_jumps_ = 0;
};

/// A message that others of earlier times follow in the file.
struct Waiting {
  std::string topic, type, md5sum, publisher;
  std::vector<std::uint8_t> data;
};

/// Passes messages on as soon as none of an earlier time can follow.
class Sorter {
 public:
  Sorter(const std::vector<StampNs>& times, const RawMessageVisitor& visit)
      : earliest_(times.size() + 1, NEVER), visit_(visit) {
    for (std::size_t i = times.size(); i-- > 0;)
      earliest_[i] = std::min(earliest_[i + 1], times[i]);
  }

  void take(const RawMessage& raw) {
    if (++nb_taken_ == earliest_.size()) throw InputError(BAG_CHANGED);
    const StampNs earliest_later = earliest_[nb_taken_];
    const bool is_next = waiting_.empty() || raw.received < waiting_.begin()->first;
    if (is_next && raw.received <= earliest_later) {
      visit_(raw);
    } else {
      nb_bytes_ += raw.size;
      if (nb_bytes_ > MOST_WAITING) {
        throw InputError("more than 1 GB is recorded before messages of earlier times; sort it");
      }
      waiting_.insert(
          {raw.received,
           {raw.topic, raw.type, raw.md5sum, raw.publisher, {raw.data, raw.data + raw.size}}});
    }
    while (!waiting_.empty() && waiting_.begin()->first <= earliest_later) {
      auto node = waiting_.extract(waiting_.begin());
      Waiting& next = node.mapped();
      const auto size = static_cast<std::uint32_t>(next.data.size());
      nb_bytes_ -= size;
      visit_(
          {next.topic, next.type, next.md5sum, next.publisher, node.key(), next.data.data(), size});
    }
  }

  void finish() const {
    if (nb_taken_ + 1 != earliest_.size()) throw InputError(BAG_CHANGED);
  }

 private:
  static constexpr const char* BAG_CHANGED = "it changed while it was read";

  std::vector<StampNs> earliest_;  ///< by number: of this message and all later ones
  const RawMessageVisitor& visit_;
  std::size_t nb_taken_ = 0, nb_bytes_ = 0;
  std::multimap<StampNs, Waiting> waiting_;  ///< by time; of one time in the order of the file
};

}  // namespace

void requireFile(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw InputError(path + ": there is no such file");
  if (!std::filesystem::is_regular_file(path, error)) throw InputError(path + ": is not a file");
}

BagTopic kindOf(const RawMessage& raw) {
  const std::string name = nameIn(raw.topic);
  if (isType<sensor_msgs::PointCloud2>(raw)) return BagTopic::CLOUDS;
  if (name == "tf" || name == "tf_static") {
    if (!isType<tf2_msgs::TFMessage>(raw)) return BagTopic::OTHER;
    return name == "tf" ? BagTopic::TRANSFORMS : BagTopic::STATIC_TRANSFORMS;
  }
  if (name == "joint_states" && isType<sensor_msgs::JointState>(raw)) return BagTopic::JOINT_STATES;
  if (!isType<std_msgs::String>(raw)) return BagTopic::OTHER;
  if (name == "robot_description") return BagTopic::DESCRIPTION;
  return name == "robot_description_semantic" ? BagTopic::SEMANTICS : BagTopic::OTHER;
}

bool BagIndex::isChosen(const RawMessage& raw) const {
  const std::string topic = withoutLeadingSlash(raw.topic);
  return topic == tf || topic == tf_static;
}

std::vector<std::string> BagIndex::chooseTransforms(bool only_as_node) {
  std::vector<std::string> moving, fixed, others;
  for (const auto& [topic, edges] : by_topic) {
    (nameIn(topic) == "tf" ? moving : fixed).push_back(topic);
  }
  tf = "tf";
  tf_static = "tf_static";
  if (by_topic.count(tf) == 0 && !only_as_node) {
    if (moving.size() > 1) {
      throw InputError("transforms on several topics (/" + joined(moving, ", /") +
                       "), and none on /tf: leave one of them (rosbag filter)");
    }
    if (!moving.empty()) tf = moving.front();
    const std::string beside = namespaceOf(tf) + "tf_static";
    if (by_topic.count(beside) > 0) tf_static = beside;
    if (moving.empty() && fixed.size() == 1) tf_static = fixed.front();
  }
  transforms.clear();
  for (const auto& [topic, edges] : by_topic) {
    if (topic == tf || topic == tf_static) {
      transforms.insert(edges.begin(), edges.end());
    } else {
      others.push_back("/" + topic);
    }
  }
  return others;
}

BagIndex indexBag(const std::string& path, const RawMessageFilter& wants) {
  requireFile(path);
  Indexer indexer(wants);
  BagRecords records = readBagRecords(path, [&](const RawMessage& raw) { indexer.take(raw); });
  return indexer.finish(path, std::move(records));
}

void replayBag(const std::string& path, const BagIndex& index, const RawMessageFilter& wants,
               const RawMessageVisitor& visit) {
  Sorter sorter(index.times, visit);
  readBagRecords(path, [&](const RawMessage& raw) {
    if (wants(raw)) sorter.take(raw);
  });
  sorter.finish();
}

}  // namespace collision_pairs
