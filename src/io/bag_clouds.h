// Index of the point clouds in a bag, before any of them is read.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "bag_records.h"
#include "tracks.h"

namespace collision_pairs {

/// A recorded cloud.
struct CloudEntry {
  int source;     ///< number of its topic
  StampNs since;  ///< it counts from then on; within a source never earlier than the one before
  std::string problem;  ///< why it cannot be used, as far as its header tells; empty: it may be
};

/// The clouds of some topics, in the order of the file; some 50 bytes a cloud.
class BagCloudIndex {
 public:
  /// Leading slashes of topics do not count.
  explicit BagCloudIndex(std::vector<std::string> topics);

  /// Sees a message of the bag. One without a stamp, ahead of its recording by more than half a
  /// second, or not later than the one before has a problem, and counts from the one before on.
  void take(const RawMessage& raw);
  /// Throws InputError if one of the topics has no message, or one that is no cloud.
  void requireAllSources() const;

  const std::vector<CloudEntry>& entries() const { return entries_; }
  /// -1: of none.
  int sourceOf(const RawMessage& raw) const;

 private:
  std::vector<std::string> topics_;
  std::vector<CloudEntry> entries_;
  std::vector<StampNs> newest_;  ///< by source
  std::vector<char> is_other_type_, has_cloud_;
  std::set<std::string> cloud_topics_;  ///< of all clouds in the bag
};

/// Whether a sensor_msgs/PointCloud2 is as long as it says, so that it can be read.
bool pointCloudFits(const RawMessage& raw);

}  // namespace collision_pairs
