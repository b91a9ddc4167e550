// Index of the point clouds in a bag, before any of them is read.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "bag_records.h"
#include "stamps.h"

namespace collision_pairs {

/// A recorded cloud.
struct CloudEntry {
  int source;  ///< number of its topic
  StampNs stamp;
  StampNs since;  ///< its arrival, from which on it applies; never earlier than the previous one
  std::string problem;  ///< why it cannot be used, judged by its header; empty if it may be usable
};

/// The clouds of some topics, in the order of the file; about 50 bytes per cloud.
class BagCloudIndex {
 public:
  /// Leading slashes of topics are ignored.
  explicit BagCloudIndex(const std::vector<std::string>& topics, double clock_tolerance = 0.5);

  /// Adds a message of the bag. A cloud without a stamp, with a stamp more than clock_tolerance [s]
  /// after its recording, or not later than the previous one has a problem.
  void take(const RawMessage& raw);
  /// Throws InputError if one of the topics has no message, or messages of another type.
  void requireAllSources() const;

  const std::vector<CloudEntry>& entries() const { return entries_; }
  /// -1: none.
  int sourceOf(const RawMessage& raw) const;

 private:
  struct Source {
    std::string topic;
    StampNs newest = EVER_SINCE, arrival = EVER_SINCE;
    bool is_other_type = false, has_cloud = false;
  };
  std::vector<Source> sources_;
  std::vector<CloudEntry> entries_;
  const StampNs clock_tolerance_;
  std::set<std::string> cloud_topics_;  ///< of all clouds in the bag
};

/// True if a serialized sensor_msgs/PointCloud2 is as long as its size fields require.
bool pointCloudFits(const RawMessage& raw);

}  // namespace collision_pairs
