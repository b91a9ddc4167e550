// What a bag contains, and its messages in the order in which they were recorded.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "bag_records.h"
#include "stamps.h"

namespace collision_pairs {

enum class BagTopic {
  TRANSFORMS,
  STATIC_TRANSFORMS,
  JOINT_STATES,
  DESCRIPTION,  ///< of the robot
  SEMANTICS,    ///< its SRDF
  CLOUDS,
  OTHER
};

/// By the last part of the topic's name (clouds have any) and the type: tf2_msgs/TFMessage and the
/// older tf/tfMessage (the same on the wire), sensor_msgs/JointState, std_msgs/String,
/// sensor_msgs/PointCloud2.
BagTopic kindOf(const RawMessage& raw);

/// True: the message will be replayed.
using RawMessageFilter = std::function<bool(const RawMessage&)>;

/// About the whole bag. Names are without a leading slash, but for those of topics.
struct BagIndex {
  struct Edge {
    std::string parent, child;
    bool is_static;
    bool operator<(const Edge& other) const {
      return std::tie(parent, child, is_static) <
             std::tie(other.parent, other.child, other.is_static);
    }
  };

  /// Chooses the topics of transforms: /tf and /tf_static, as a node hears them; else the only ones
  /// of another namespace, unless `only_as_node`. Returns the others. Throws InputError if there
  /// are several to choose from.
  std::vector<std::string> chooseTransforms(bool only_as_node);
  bool isChosen(const RawMessage& raw) const;

  std::map<std::string, std::set<Edge>> by_topic;       ///< transforms; topics without the slash
  std::string tf, tf_static;                            ///< the topics that were chosen
  std::set<Edge> transforms;                            ///< on these
  std::map<std::string, std::set<std::string>> joints;  ///< names, by topic of joint states
  std::map<std::string, std::string> urdfs, srdfs;      ///< the first, by topic
  std::set<std::string> changing;                       ///< topics of these with several texts
  std::set<std::string> topics, cloud_topics;
  std::vector<StampNs> times;  ///< of recording: those of the messages that will be replayed
  BagRecords records;          ///< what could not be read, and the connections
};

/// Throws InputError unless there is a file of that name.
void requireFile(const std::string& path);

/// A bag without an index, truncated or with damaged chunks is read as far as possible
/// (readBagRecords), and `losses` says what is missing. Throws InputError if it is not a bag, or
/// contains no transforms and no joint states.
BagIndex indexBag(const std::string& path, const RawMessageFilter& wants);

/// Visits the messages sorted by the time of their recording, as rosbag play does; of one time in
/// the order of the file. Memory: those that are recorded before others of earlier times. Throws
/// InputError if it is no longer the bag of the index, or these take more than 1 GB.
void replayBag(const std::string& path, const BagIndex& index, const RawMessageFilter& wants,
               const RawMessageVisitor& visit);

}  // namespace collision_pairs
