#include "bag_reader.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include <ros/serialization.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/String.h>
#include <tf2_msgs/TFMessage.h>

#include "collision_pairs/input_error.h"
#include "frame_names.h"
#include "message_walk.h"

namespace collision_pairs {
namespace {

constexpr StampNs CLOCK_WENT_BACK = 5000000000;  // 5 s: publishers differ by less

std::string lastPart(const std::string& topic) { return topic.substr(topic.rfind('/') + 1); }

template <class Message>
bool isType(const std::string& md5sum) {
  return md5sum == ros::message_traits::MD5Sum<Message>::value();
}

bool isWanted(const std::string& name, const std::string& md5sum) {
  if (name == "tf" || name == "tf_static") return isType<tf2_msgs::TFMessage>(md5sum);
  if (name == "joint_states") return isType<sensor_msgs::JointState>(md5sum);
  return isType<std_msgs::String>(md5sum) &&
         (name == "robot_description" || name == "robot_description_semantic");
}

constexpr std::uint64_t SMALLEST_TRANSFORM = 76;  // bytes: two empty names, seven doubles
constexpr int NB_ARRAYS_OF_DOUBLES = 3;           // position, velocity, effort

bool jointStateFits(const RawMessage& raw) {
  Walk walk(raw.data, raw.size);
  std::uint32_t nb_names;
  if (!walk.skipHeader() || !walk.count(nb_names, 4)) return false;
  for (std::uint32_t i = 0; i < nb_names; ++i) {
    if (!walk.skipArray(1)) return false;
  }
  for (int i = 0; i < NB_ARRAYS_OF_DOUBLES; ++i) {
    if (!walk.skipArray(sizeof(double))) return false;
  }
  return true;
}

bool tfMessageFits(const RawMessage& raw) {
  std::uint32_t nb_transforms;
  return Walk(raw.data, raw.size).count(nb_transforms, SMALLEST_TRANSFORM);
}

class Collector {
 public:
  explicit Collector(const PoseLimits& limits) : contents_(limits) {}

  void take(const RawMessage& raw) {
    const std::string name = lastPart(raw.topic);
    if (!isWanted(name, raw.md5sum)) return;
    bool fits = true;
    try {
      if (name == "joint_states") {
        fits = takeJoints(raw);
      } else if (name == "tf" || name == "tf_static") {
        fits = takeTransforms(raw, name == "tf_static");
      } else {
        takeText(raw, name == "robot_description" ? contents_.urdfs : contents_.srdfs);
      }
    } catch (const ros::Exception&) {  // its length fields point beyond its end
      fits = false;
    }
    ++(fits ? contents_.nb_messages : nb_garbled_);
  }

  BagContents finish() {
    const auto sort = [](auto& list) {
      std::stable_sort(list.begin(), list.end(),
                       [](const auto& a, const auto& b) { return a.received < b.received; });
    };
    sort(transforms_);
    for (const RecordedTransform& transform : transforms_) keep(transform);
    for (auto& [topic, positions] : contents_.joints) sort(positions);
    contents_.stamps.resize(contents_.transforms.frames().size());
    note(nb_garbled_, "messages that do not match their type");
    note(nb_unusable_, "transforms and joint positions that are not finite, or not a rotation");
    note(nb_jumps_,
         "times its clock goes back; what is then too old is not used, so split the bag there");
    if (nb_refused_ > 0) {
      note(nb_refused_, "transforms are not used, or are in doubt; the first: " + first_refusal_);
    }
    return std::move(contents_);
  }

 private:
  /// Names are those of names_, since there may be millions.
  struct RecordedTransform {
    StampNs received, stamp;
    const std::string *publisher, *parent, *child;
    bool is_static;
    Eigen::Vector3d p_PC;
    Eigen::Quaterniond R_PC;
  };
  template <class Message>
  static Message read(const RawMessage& raw) {
    Message message;
    ros::serialization::IStream stream(raw.data, raw.size);
    ros::serialization::deserialize(stream, message);
    return message;
  }

  static StampNs stampOf(const ros::Time& stamp, const RawMessage& raw) {
    return stamp.isZero() ? raw.received : static_cast<StampNs>(stamp.toNSec());
  }

  void watchClock(StampNs stamp) {
    if (stamp < newest_ - CLOCK_WENT_BACK)
      ++nb_jumps_;
    else if (stamp < newest_)
      return;
    newest_ = stamp;
  }

  const std::string* named(const std::string& name) { return &*names_.insert(name).first; }

  bool takeTransforms(const RawMessage& raw, bool is_static) {
    if (!tfMessageFits(raw)) return false;
    for (const auto& transform : read<tf2_msgs::TFMessage>(raw).transforms) {
      if (!is_static) watchClock(stampOf(transform.header.stamp, raw));
      const auto& p = transform.transform.translation;
      const auto& q = transform.transform.rotation;
      const Eigen::Vector3d p_PC(p.x, p.y, p.z);
      const Eigen::Quaterniond R_PC(q.w, q.x, q.y, q.z);
      if (isPose(p_PC, R_PC)) {
        transforms_.push_back({raw.received, static_cast<StampNs>(transform.header.stamp.toNSec()),
                               named(raw.publisher), named(transform.header.frame_id),
                               named(transform.child_frame_id), is_static, p_PC, R_PC});
      } else {
        ++nb_unusable_;
      }
    }
    return true;
  }

  bool takeJoints(const RawMessage& raw) {
    if (!jointStateFits(raw)) return false;
    const auto message = read<sensor_msgs::JointState>(raw);
    const StampNs stamp = stampOf(message.header.stamp, raw);
    watchClock(stamp);
    std::vector<RecordedPosition>& positions = contents_.joints[raw.topic];
    const std::size_t count = std::min(message.name.size(), message.position.size());
    for (std::size_t i = 0; i < count; ++i) {
      if (std::isfinite(message.position[i])) {
        const int by = contents_.names.add(raw.publisher);
        const int joint = contents_.names.add(withoutLeadingSlash(message.name[i]));
        if (std::min(by, joint) < 0) continue;
        positions.push_back({raw.received, stamp, by, joint, message.position[i]});
      } else {
        ++nb_unusable_;
      }
    }
    return true;
  }

  void keep(const RecordedTransform& recorded) {
    const std::string why = contents_.take(
        {*recorded.parent, *recorded.child, recorded.stamp, recorded.p_PC, recorded.R_PC},
        recorded.is_static, *recorded.publisher, recorded.received);
    if (!why.empty() && nb_refused_++ == 0) {
      first_refusal_ = "transform of '" + *recorded.child + "': " + why;
    }
  }

  static void takeText(const RawMessage& raw, std::map<std::string, std::string>& texts) {
    texts[raw.topic] = read<std_msgs::String>(raw).data;
  }

  void note(std::size_t count, const std::string& what) {
    if (count > 0) contents_.losses.push_back(std::to_string(count) + " " + what);
  }

  BagContents contents_;
  std::set<std::string> names_;
  std::vector<RecordedTransform> transforms_;
  StampNs newest_ = 0;
  std::size_t nb_garbled_ = 0, nb_unusable_ = 0, nb_jumps_ = 0, nb_refused_ = 0;
  std::string first_refusal_;
};

void checkIsFile(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw InputError(path + ": there is no such file");
  if (!std::filesystem::is_regular_file(path, error)) throw InputError(path + ": is not a file");
}

}  // namespace

std::string BagContents::take(const ReceivedTransform& transform, bool is_static,
                              const std::string& publisher, StampNs received) {
  const std::string why = transforms.take(transform, is_static, publisher, received);
  const int frame = transforms.findFrame(withoutLeadingSlash(transform.child));
  if (frame >= 0 && !is_static) {
    stamps.resize(transforms.frames().size());
    stamps[frame].push_back(transform.stamp == 0 ? received : transform.stamp);
  }
  const int parent = names.add(transform.parent), child = names.add(transform.child),
            by = names.add(publisher);
  if (std::min({parent, child, by}) >= 0) {
    recorded_.push_back(
        {received, transform.stamp, parent, child, by, is_static, transform.p_PC, transform.R_PC});
  }
  return why;
}

BagContents readBag(const std::string& path, const PoseLimits& limits,
                    const RawMessageVisitor& also) {
  checkIsFile(path);
  Collector collector(limits);
  const std::vector<std::string> losses = readBagRecords(path, [&](const RawMessage& message) {
    collector.take(message);
    if (also) also(message);
  });
  BagContents contents = collector.finish();
  contents.losses.insert(contents.losses.begin(), losses.begin(), losses.end());
  if (contents.nb_messages == 0) {
    throw InputError(path + ": no transforms and no joint states in " +
                     (losses.empty() ? "it" : "what could be read: " + contents.losses.back()));
  }
  return contents;
}

}  // namespace collision_pairs
